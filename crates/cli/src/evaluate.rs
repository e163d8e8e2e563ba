//! `surfine evaluate`.

use crate::args::EvaluateArgs;
use crate::paint::heat;
use crate::painter::Painter;
use crate::scene::axes;
use crate::summary::name;
use crate::watch::Watch;
use crate::{Failure, cloud, files, print, print_json};
use serde::Serialize;
use std::path::Path;
use surfine_evaluate::{Evaluation, Options, Truth, TruthKind, errors, evaluate};
use surfine_points::Model;
use surfine_render::{Camera, Caption, Coloring, Space, Splats, Style};

pub(crate) fn run(args: &EvaluateArgs) -> Result<(), Failure> {
    if let Some(path) = &args.heatmap {
        let inputs = [Some(&args.output), Some(&args.truth), args.input.as_ref()];
        files::check_picture(path, inputs.into_iter().flatten())?;
    }
    args.threads.start()?;
    let watch = Watch::new(args.quiet || args.json);
    // A picture that can't be drawn is refused before the measures are taken.
    let heatmap = args.heatmap.as_deref().map(|path| Heatmap::new(args, path, &watch));
    let heatmap = heatmap.transpose()?;
    let output = cloud::read(&args.output, &watch)?;
    let input = args.input.as_deref().map(|path| cloud::read(path, &watch)).transpose()?;
    let truth = read_truth(&args.truth, Some(args.crease_angle), &watch)?;
    let options = Options { samples: args.samples.unwrap_or(0) as usize, seed: args.seed };
    let mut progress = |measure: &'static str| watch.step(format!("measuring {measure}"));
    let evaluation = evaluate(&output, &truth, input.as_ref(), &options, &mut progress)
        .map_err(|e| Failure(format!("{}: {e}", args.output.display())))?;
    if !args.quiet {
        missing(&output, &truth, &evaluation).iter().for_each(|note| watch.warn(note));
    }
    print_measures(args, &evaluation, &watch)?;
    // Drawn last: the measures are out if it fails.
    heatmap.map_or(Ok(()), |heatmap| heatmap.draw(args, &output, &truth, &watch))
}

fn print_measures(
    args: &EvaluateArgs,
    evaluation: &Evaluation,
    watch: &Watch,
) -> Result<(), Failure> {
    if args.json {
        watch.suspend(|| print_json(&Report::new(args, evaluation)))
    } else {
        watch.suspend(|| print(&evaluation.report()))
    }
}

/// One line for each section that could not be measured.
fn missing(output: &Model, truth: &Truth, evaluation: &Evaluation) -> Vec<String> {
    let has_normals = output.normals.is_some() || output.is_mesh();
    let no_normals = if has_normals { "OUT has no usable normals" } else { "OUT has no normals" };
    let no_true_normals = match evaluation.truth.kind {
        TruthKind::Points => "the truth has no normals",
        _ => "the truth has no usable normals where OUT has some",
    };
    let usable = evaluation.smoothness.is_some();
    let mut notes = Vec::new();
    let mut note = |is_there: bool, section: &str, why: &str| {
        if !is_there {
            notes.push(format!("{section} not measured: {why}"));
        }
    };
    note(evaluation.coverage.along.is_some(), "gaps along the surface", no_true_normals);
    let why = if usable { no_true_normals } else { no_normals };
    note(evaluation.normals.is_some(), "normal error", why);
    note(usable, "smoothness of normals", no_normals);
    let is_mesh = evaluation.uniformity.discs.is_some();
    note(is_mesh, "PU-GAN's uniformity", "it needs the area of a mesh, and the truth is points");
    // Where neither has colours, nothing is missing.
    match (output.colors(), truth.nearest(output.positions[0], None).color) {
        (Some(_), None) => note(false, "color error", "the truth has no uchar red, green and blue"),
        (None, Some(_)) => note(false, "color error", "OUT has no uchar red, green and blue"),
        _ => {}
    }
    notes
}

/// What `--json` prints.
#[derive(Serialize)]
struct Report<'a> {
    output: String,
    truth: String,
    input: Option<String>,
    evaluation: &'a Evaluation,
}

impl<'a> Report<'a> {
    fn new(args: &EvaluateArgs, evaluation: &'a Evaluation) -> Self {
        Self {
            output: name(&args.output),
            truth: name(&args.truth),
            input: args.input.as_deref().map(name),
            evaluation,
        }
    }
}

/// Reads the true surface and gets it ready; edges sharper than `crease_angle` degrees are creases.
pub(crate) fn read_truth(
    path: &Path,
    crease_angle: Option<f64>,
    watch: &Watch,
) -> Result<Truth, Failure> {
    let model = cloud::read(path, watch)?;
    watch.step("preparing the true surface".into());
    let truth = match crease_angle {
        Some(degrees) => Truth::with_crease_angle(&model, degrees),
        None => Truth::new(&model),
    };
    truth.map_err(|e| Failure(format!("{}: {e}", path.display())))
}

/// The picture of the distances.
struct Heatmap<'a> {
    path: &'a Path,
    painter: Painter,
}

impl<'a> Heatmap<'a> {
    fn new(args: &EvaluateArgs, path: &'a Path, watch: &Watch) -> Result<Self, Failure> {
        let mut painter = Painter::new(args.backend, None, watch)?;
        painter.check(1, args.size, Style::default().supersampling, watch)?;
        Ok(Self { path, painter })
    }

    fn draw(
        mut self,
        args: &EvaluateArgs,
        output: &Model,
        truth: &Truth,
        watch: &Watch,
    ) -> Result<(), Failure> {
        watch.step("drawing the heatmap".into());
        let (colors, scale) = heat(&[errors(output, truth)?], args.max);
        let points = cloud::to_points(&args.output, output, watch);
        let splats = Splats::new(&points, Space::around([&points]), Some(&colors[0]));
        let [direction, up] = axes(args.view, args.z_up);
        let camera = Camera::look(splats.outline(1.0), direction, up, args.size.aspect());
        let style = Style { coloring: Coloring::Data, ..Style::default() };
        let ready = self.painter.upload(&splats, watch)?;
        let picture = self.painter.draw(&ready, &camera, &style, args.size, watch)?;
        let name = args.output.file_name().unwrap_or_default().to_string_lossy();
        let text = format!("{name}: distance to the true surface");
        let caption = Caption { text, scale: Some(scale) };
        Ok(picture.with_caption(&caption).write_png(self.path)?)
    }
}
