//! `surfine render`.

use crate::args::{ColorChoice, RenderArgs};
use crate::painter::{Painter, Ready};
use crate::watch::Watch;
use crate::{Failure, backend, files, print};
use std::path::{Path, PathBuf};
use std::time::Instant;
use surfine::Vec3;
use surfine_points::{DVec3, Model, PointSet, Values, ply};
use surfine_render::{
    Camera, Caption, Coloring, Picture, Space, Splats, Style, ramp, write_animation,
};

pub(crate) fn run(args: &RenderArgs) -> Result<(), Failure> {
    let frames = frame_paths(args)?;
    check_captions(args)?;
    backend::start_threads(args.threads)?;
    let watch = Watch::new(args.quiet);
    let begin = Instant::now();
    let clouds = args.inputs.iter().map(|path| Cloud::read(path, &watch));
    let clouds: Vec<Cloud> = clouds.collect::<Result<_, _>>()?;
    let scene = Scene::new(args, clouds, &watch)?;
    let painter = Painter::new(args.backend, args.adapter.as_deref(), &watch)?;
    let drawn = scene.draw(args, &painter, &watch)?;
    watch.step(format!("writing {}", args.output.display()));
    match &frames[..] {
        [path] => write_animation(path, &drawn, args.fps)?,
        paths => paths.iter().zip(&drawn).try_for_each(|(path, frame)| frame.write_png(path))?,
    }
    drop(watch);
    if args.quiet {
        return Ok(());
    }
    let (splats, size) = (scene.splats(), drawn[0].size);
    print(&format!(
        "{}: {} x {} pixels, {} frame{}, {splats} splats, {:.1} s on {}\n",
        args.output.display(),
        size.width,
        size.height,
        drawn.len(),
        if drawn.len() == 1 { "" } else { "s" },
        begin.elapsed().as_secs_f64(),
        painter.name(),
    ))
}

/// The files to write: one, or one a frame where the name has a row of `#`.
fn frame_paths(args: &RenderArgs) -> Result<Vec<PathBuf>, Failure> {
    let name = args.output.to_string_lossy().into_owned();
    let (Some(first), Some(frames)) = (name.rfind('#'), args.turntable) else {
        files::check_picture(&args.output, &args.inputs)?;
        return Ok(vec![args.output.clone()]);
    };
    let head = name[..=first].trim_end_matches('#');
    let digits = first + 1 - head.len();
    let path = |i| PathBuf::from(format!("{head}{i:0digits$}{}", &name[first + 1..]));
    let paths: Vec<PathBuf> = (0..frames).map(path).collect();
    paths.iter().try_for_each(|path| files::check_picture(path, &args.inputs))?;
    Ok(paths)
}

fn check_captions(args: &RenderArgs) -> Result<(), Failure> {
    let (given, inputs) = (args.caption.len(), args.inputs.len());
    if given == 0 || given == inputs {
        return Ok(());
    }
    Err(Failure(format!("{given} captions for {inputs} inputs: give one --caption for each input")))
}

/// An input.
struct Cloud {
    path: PathBuf,
    model: Model,
    points: PointSet,
}

impl Cloud {
    fn read(path: &Path, watch: &Watch) -> Result<Self, Failure> {
        watch.step(format!("reading {}", path.display()));
        let (model, notes) = ply::read_model(path)?;
        notes.iter().for_each(|note| watch.warn(&format!("{}: {note}", path.display())));
        let (points, _) = model.to_points();
        Ok(Self { path: path.into(), model, points })
    }

    fn colors(&self) -> Result<Vec<[u8; 3]>, Failure> {
        let missing =
            "there are no properties red, green and blue of type uchar: use another --color";
        self.model.colors().ok_or_else(|| Failure(format!("{}: {missing}", self.path.display())))
    }

    fn highest_level(&self) -> Result<u8, Failure> {
        match self.points.attribute("level").map(|a| &a.values) {
            Some(Values::U8(levels)) => Ok(levels.iter().copied().max().unwrap_or(0)),
            _ => Err(Failure(format!(
                "{}: there is no property level of type uchar: write it with `surfine refine --provenance`",
                self.path.display()
            ))),
        }
    }
}

/// What is drawn, and from where.
struct Scene {
    /// Each input's points and what stands under them.
    panels: Vec<(Splats, Option<Caption>)>,
    cameras: Vec<Camera>,
    style: Style,
}

impl Scene {
    fn new(args: &RenderArgs, clouds: Vec<Cloud>, watch: &Watch) -> Result<Self, Failure> {
        let space = Space::around(clouds.iter().map(|cloud| &cloud.points));
        let paint = Paint::new(args, &clouds, watch)?;
        let captions = clouds.iter().enumerate().map(|(i, cloud)| paint.caption(args, i, cloud));
        let captions: Vec<Option<Caption>> = captions.collect();
        let splats = clouds.iter().enumerate().map(|(i, cloud)| {
            let colors = paint.colors.get(i).map(Vec::as_slice);
            Splats::new(&cloud.points, space, colors)
        });
        let splats: Vec<Splats> = splats.collect();
        let cameras = cameras(args, space, &splats)?;
        let coloring = match paint.coloring {
            Coloring::Radius { low, high } => {
                Coloring::Radius { low: space.length(low), high: space.length(high) }
            }
            other => other,
        };
        let style = Style {
            coloring,
            splat_scale: args.splat_scale,
            dots: args.points.then_some(args.point_size),
            background: args.background,
            supersampling: args.supersampling,
        };
        Ok(Self { panels: splats.into_iter().zip(captions).collect(), cameras, style })
    }

    fn splats(&self) -> usize {
        self.panels.iter().map(|(splats, _)| splats.len()).sum()
    }

    /// The frames.
    fn draw(
        &self,
        args: &RenderArgs,
        painter: &Painter,
        watch: &Watch,
    ) -> Result<Vec<Picture>, Failure> {
        let panels: Vec<_> =
            self.panels.iter().map(|(s, _)| painter.upload(s)).collect::<Result<_, _>>()?;
        let frames = self.cameras.len();
        let frame = |(i, camera)| {
            watch.step(format!("drawing frame {} of {frames}", i + 1));
            let panel = |(splats, (_, caption)): (&Ready<'_>, &(_, Option<Caption>))| {
                let picture = painter.draw(splats, camera, &self.style, args.size)?;
                Ok(match caption {
                    Some(caption) => picture.with_caption(caption),
                    None => picture,
                })
            };
            let pictures: Result<Vec<Picture>, Failure> =
                panels.iter().zip(&self.panels).map(panel).collect();
            Ok(Picture::side_by_side(&pictures?))
        };
        self.cameras.iter().enumerate().map(frame).collect()
    }
}

/// The colour of each distance from 0 to `high`, farther ones like that.
pub(crate) fn heat(errors: &[f64], high: f64) -> Vec<[u8; 3]> {
    errors.iter().map(|error| ramp(if high > 0.0 { error / high } else { 0.0 })).collect()
}

/// The ends of the scale of [`heat`].
pub(crate) fn heat_scale(high: f64) -> [String; 2] {
    ["distance 0".into(), format!("{high:.3e}")]
}

/// The camera of each frame.
fn cameras(args: &RenderArgs, space: Space, splats: &[Splats]) -> Result<Vec<Camera>, Failure> {
    let aspect = args.size.aspect();
    let scale = if args.points { 0.0 } else { args.splat_scale };
    let seen = splats.iter().flat_map(|s| s.outline(scale));
    let camera = first_camera(args, space, seen.clone())?;
    let Some(frames) = args.turntable else { return Ok(vec![camera]) };
    let axis = if args.z_up { Vec3::Z } else { args.up.map_or(Vec3::Y, unit) };
    let turn = |i| camera.orbit(axis, std::f32::consts::TAU * i as f32 / frames as f32);
    let around: Vec<Camera> = (0..frames).map(turn).collect();
    if args.eye.is_some() && !args.fit {
        return Ok(around);
    }
    // One distance for all frames: the cloud must not breathe.
    let needed = around.iter().map(|c| c.fit(seen.clone(), aspect).distance());
    let distance = needed.fold(0.0, f32::max);
    Ok(around.into_iter().map(|c| c.with_distance(camera.target, distance)).collect())
}

/// The camera that the arguments ask for.
fn first_camera(
    args: &RenderArgs,
    space: Space,
    seen: impl Iterator<Item = Vec3> + Clone,
) -> Result<Camera, Failure> {
    let aspect = args.size.aspect();
    let turned = |v: Vec3| if args.z_up { Vec3::new(v.x, -v.z, v.y) } else { v };
    let up = args.up.map_or(turned(args.view.up()), unit);
    let looked = Camera::look(seen.clone(), turned(args.view.direction()), up, aspect);
    let camera = match args.eye.map(|eye| space.place(eye)) {
        None => looked,
        Some(eye) => {
            let target = args.target.map_or(looked.target, |target| space.place(target));
            if eye == target {
                let remedy = "--eye is the place that the camera looks at: move it, or give another --target";
                return Err(Failure(remedy.into()));
            }
            let camera = Camera { eye, target, ..looked };
            if args.fit { camera.fit(seen, aspect) } else { camera }
        }
    };
    if camera.is_upright() {
        return Ok(camera);
    }
    let remedy = "what is upright in the picture lies along the line of sight: give another direction with --up";
    Err(Failure(remedy.into()))
}

/// A direction of any length.
fn unit(direction: DVec3) -> Vec3 {
    direction.normalize_or_zero().as_vec3()
}

/// What the colours show.
struct Paint {
    coloring: Coloring,
    /// A colour for each point of each input, where the points do not tell themselves.
    colors: Vec<Vec<[u8; 3]>>,
    /// Ends of the scale.
    scale: Option<[String; 2]>,
}

impl Paint {
    fn new(args: &RenderArgs, clouds: &[Cloud], watch: &Watch) -> Result<Self, Failure> {
        let plain = |coloring| Self { coloring, colors: Vec::new(), scale: None };
        Ok(match args.color {
            ColorChoice::Shaded => plain(Coloring::Shaded),
            ColorChoice::Normal => plain(Coloring::Normal),
            ColorChoice::Rgb => {
                let colors: Result<_, _> = clouds.iter().map(Cloud::colors).collect();
                Self { colors: colors?, ..plain(Coloring::Paint) }
            }
            ColorChoice::Radius => {
                let radii = || clouds.iter().flat_map(|c| &c.points.radii).copied();
                let low = radii().reduce(f32::min).unwrap_or(0.0);
                let high = args.max.unwrap_or(radii().fold(low, f32::max));
                let scale = Some([format!("radius {low:.3e}"), format!("{high:.3e}")]);
                Self { scale, ..plain(Coloring::Radius { low, high }) }
            }
            ColorChoice::Level => {
                let levels: Result<Vec<u8>, _> = clouds.iter().map(Cloud::highest_level).collect();
                let highest = levels?.into_iter().max().unwrap_or(0).into();
                let high = args.max.unwrap_or(highest);
                let scale = Some(["level 0".into(), high.to_string()]);
                Self { scale, ..plain(Coloring::Level { high }) }
            }
            ColorChoice::Error => Self::errors(args, clouds, watch)?,
        })
    }

    fn errors(args: &RenderArgs, clouds: &[Cloud], watch: &Watch) -> Result<Self, Failure> {
        let Some(path) = &args.truth else {
            return Err(Failure("--color error: name the true surface with --truth".into()));
        };
        let truth = crate::evaluate::read_truth(path, None, watch)?;
        watch.step("measuring distances".into());
        let errors = clouds.iter().map(|cloud| {
            let named = |e| Failure(format!("{}: {e}", cloud.path.display()));
            surfine_evaluate::errors(&cloud.model, &truth).map_err(named)
        });
        let errors: Vec<Vec<f64>> = errors.collect::<Result<_, _>>()?;
        let largest = errors.iter().flatten().copied().fold(0.0, f64::max);
        let high = args.max.map_or(largest, f64::from);
        let (colors, scale) = (errors.iter().map(|e| heat(e, high)).collect(), heat_scale(high));
        Ok(Self { coloring: Coloring::Data, colors, scale: Some(scale) })
    }

    fn caption(&self, args: &RenderArgs, i: usize, cloud: &Cloud) -> Option<Caption> {
        if args.no_captions
            || (args.inputs.len() == 1 && args.caption.is_empty() && self.scale.is_none())
        {
            return None;
        }
        let name = cloud.path.file_name().unwrap_or_default().to_string_lossy();
        let text = match args.caption.get(i) {
            Some(text) => text.clone(),
            None => format!("{name}: {} points", cloud.points.len()),
        };
        Some(Caption { text, ramp: self.scale.clone() })
    }
}
