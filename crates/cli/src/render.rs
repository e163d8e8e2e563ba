//! `surfine render`.

use crate::args::RenderArgs;
use crate::cloud::Cloud;
use crate::painter::Painter;
use crate::scene::Scene;
use crate::watch::Watch;
use crate::{Failure, files, print};
use std::path::PathBuf;
use std::time::Instant;
use surfine_render::{Animation, Size};

pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let output = Output::new(args)?;
    check_captions(args)?;
    args.threads.start()?;
    let watch = Watch::new(args.quiet);
    let begin = Instant::now();
    let mut painter = Painter::new(args.backend, args.adapter.as_deref(), &watch)?;
    painter.check(args.inputs.len(), args.size, args.supersampling, &watch)?;
    let clouds = args.inputs.iter().map(|path| Cloud::read(path, &watch));
    let clouds: Vec<Cloud> = clouds.collect::<Result<_, _>>()?;
    let scene = Scene::new(args, &clouds, &watch)?;
    drop(clouds);
    let size = output.write(args, &scene, &mut painter, &watch)?;
    drop(watch);
    if args.quiet {
        return Ok(());
    }
    let (splats, frames) = (scene.splats(), scene.frames());
    print(&format!(
        "{}: {} x {} pixels, {frames} frame{}, {splats} splats, {:.1} s on {}\n",
        args.output.display(),
        size.width,
        size.height,
        if frames == 1 { "" } else { "s" },
        begin.elapsed().as_secs_f64(),
        painter.name(),
    ))
}

/// The files to write.
enum Output {
    /// One a frame.
    Files(Vec<PathBuf>),
    /// One for all.
    Animation(PathBuf),
}

impl Output {
    /// Refuses files that could not be written, or would take the place of an input.
    fn new(args: &RenderArgs) -> Result<Self, Failure> {
        let output = match args.turntable {
            None => Self::Files(vec![args.output.clone()]),
            Some(frames) => match frame_paths(args, frames)? {
                Some(paths) => Self::Files(paths),
                None => Self::Animation(args.output.clone()),
            },
        };
        let paths = match &output {
            Self::Files(paths) => &paths[..],
            Self::Animation(path) => std::slice::from_ref(path),
        };
        let inputs = || args.inputs.iter().chain(&args.truth);
        paths.iter().try_for_each(|path| files::check_picture(path, inputs()))?;
        Ok(output)
    }

    /// Draws and writes frame by frame; the size of a frame.
    fn write(
        &self,
        args: &RenderArgs,
        scene: &Scene,
        painter: &mut Painter,
        watch: &Watch,
    ) -> Result<Size, Failure> {
        let mut size = args.size;
        let mut animation = None;
        scene.draw(args, painter, watch, &mut |i, frame| {
            size = frame.size;
            match self {
                Self::Files(paths) => frame.write_png(&paths[i])?,
                Self::Animation(path) => {
                    let begin = || Animation::new(path, size, scene.frames(), args.fps);
                    let file = match &mut animation {
                        Some(file) => file,
                        None => animation.insert(begin()?),
                    };
                    file.push(&frame)?;
                }
            }
            Ok(())
        })?;
        if let Some(file) = animation {
            file.finish()?;
        }
        Ok(size)
    }
}

/// A file for each frame where the name has a row of `#`.
fn frame_paths(args: &RenderArgs, frames: u32) -> Result<Option<Vec<PathBuf>>, Failure> {
    let file = args.output.file_name().unwrap_or_default();
    let Some(first) = file.to_string_lossy().rfind('#') else { return Ok(None) };
    let Some(name) = file.to_str() else {
        let output = args.output.display();
        return Err(Failure(format!(
            "{output}: a name with # must be UTF-8, for the number to take its place: rename it"
        )));
    };
    let head = name[..=first].trim_end_matches('#');
    let digits = first + 1 - head.len();
    let path = |i| args.output.with_file_name(format!("{head}{i:0digits$}{}", &name[first + 1..]));
    Ok(Some((0..frames).map(path).collect()))
}

fn check_captions(args: &RenderArgs) -> Result<(), Failure> {
    let (given, inputs) = (args.caption.len(), args.inputs.len());
    if given == 0 || given == inputs {
        return Ok(());
    }
    Err(Failure(format!("{given} captions for {inputs} inputs: give one --caption for each input")))
}
