//! `surfine evaluate`.

use crate::args::EvaluateArgs;
use crate::painter::Painter;
use crate::render::{heat, heat_scale};
use crate::watch::Watch;
use crate::{Failure, backend, files, print};
use serde::Serialize;
use std::path::Path;
use surfine_evaluate::{Evaluation, Options, Truth, errors, evaluate};
use surfine_points::{Model, ply};
use surfine_render::{Camera, Caption, Coloring, Space, Splats, Style};

pub(crate) fn run(args: &EvaluateArgs) -> Result<(), Failure> {
    if let Some(path) = &args.heatmap {
        let inputs = [Some(&args.output), Some(&args.truth), args.input.as_ref()];
        files::check_picture(path, inputs.into_iter().flatten())?;
    }
    backend::start_threads(args.threads)?;
    let watch = Watch::new(args.quiet || args.json);
    let output = with_normals(read(&args.output, &watch)?);
    let input = args.input.as_deref().map(|path| read(path, &watch)).transpose()?;
    let truth = read_truth(&args.truth, Some(args.crease_angle), &watch)?;
    let options = Options { samples: args.samples.unwrap_or(0) as usize, seed: args.seed };
    let mut progress = |measure: &'static str| watch.step(format!("measuring {measure}"));
    let evaluation = evaluate(&output, &truth, input.as_ref(), &options, &mut progress)
        .map_err(|e| Failure(format!("{}: {e}", args.output.display())))?;
    if let Some(path) = &args.heatmap {
        draw_heatmap(args, path, &output, &truth, &watch)?;
    }
    drop(watch);
    if args.json {
        return print(&format!(
            "{}\n",
            serde_json::to_string_pretty(&Report::new(args, &evaluation))?
        ));
    }
    print(&evaluation.report())
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
        let name = |path: &Path| path.display().to_string();
        Self {
            output: name(&args.output),
            truth: name(&args.truth),
            input: args.input.as_deref().map(name),
            evaluation,
        }
    }
}

fn read(path: &Path, watch: &Watch) -> Result<Model, Failure> {
    watch.step(format!("reading {}", path.display()));
    let (model, notes) = ply::read_model(path)?;
    notes.iter().for_each(|note| watch.warn(&format!("{}: {note}", path.display())));
    Ok(model)
}

/// A mesh without normals has those of its triangles.
fn with_normals(mut model: Model) -> Model {
    if model.is_mesh() && model.normals.is_none() {
        model.normals = Some(model.vertex_normals().into_iter().map(|n| n.as_vec3()).collect());
    }
    model
}

/// Reads the true surface and gets it ready; edges sharper than `crease_angle` degrees are creases.
pub(crate) fn read_truth(
    path: &Path,
    crease_angle: Option<f64>,
    watch: &Watch,
) -> Result<Truth, Failure> {
    let model = read(path, watch)?;
    watch.step("preparing the true surface".into());
    let truth = match crease_angle {
        Some(degrees) => Truth::with_crease_angle(&model, degrees),
        None => Truth::new(&model),
    };
    truth.map_err(|e| Failure(format!("{}: {e}", path.display())))
}

fn draw_heatmap(
    args: &EvaluateArgs,
    path: &Path,
    output: &Model,
    truth: &Truth,
    watch: &Watch,
) -> Result<(), Failure> {
    watch.step("drawing the heatmap".into());
    let errors = errors(output, truth)?;
    let largest = errors.iter().copied().fold(0.0, f64::max);
    let high = args.max.map_or(largest, f64::from);
    let (points, _) = output.to_points();
    let splats = Splats::new(&points, Space::around([&points]), Some(&heat(&errors, high)));
    let seen = splats.outline(1.0);
    let camera = Camera::look(seen, args.view.direction(), args.view.up(), args.size.aspect());
    let painter = Painter::new(args.backend, None, watch)?;
    let style = Style { coloring: Coloring::Data, ..Style::default() };
    let picture = painter.draw(&painter.upload(&splats)?, &camera, &style, args.size)?;
    let name = args.output.file_name().unwrap_or_default().to_string_lossy();
    let text = format!("{name}: distance to the true surface");
    let caption = Caption { text, ramp: Some(heat_scale(high)) };
    Ok(picture.with_caption(&caption).write_png(path)?)
}
