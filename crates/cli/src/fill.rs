//! `surfine fill`, and the filling before a refinement.

use crate::args::{FillArgs, FillChoice};
use crate::summary::{self, name};
use crate::watch::Watch;
use crate::{Failure, files};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::path::Path;
use surfine_holes::{Fill, Filled, fill_holes};
use surfine_points::PointSet;
use surfine_points::ply::{self, Source};

pub(crate) fn run(args: &FillArgs) -> Result<(), Failure> {
    files::check_cloud(&args.output, &args.input)?;
    args.threads.start()?;
    let watch = args.summary.watch();
    watch.step(format!("reading {}", args.input.display()));
    let (points, source) = ply::read(&args.input)?;
    let filled = filled(&args.input, &points, &args.fill_holes, &watch)?;
    watch.step(format!("writing {}", args.output.display()));
    ply::write(&args.output, &filled.points, None, &source, files::encoding(args.ascii))?;
    drop(watch);
    args.summary.print(&Report::new(args, &points, &source, &filled))
}

/// Fills the chosen holes of an input.
pub(crate) fn filled(
    input: &Path,
    points: &PointSet,
    choice: &FillChoice,
    watch: &Watch,
) -> Result<Filled, Failure> {
    watch.step("looking for holes".into());
    fill_holes(points, choice).map_err(|e| Failure(format!("{}: {e}", input.display())))
}

/// The summary of `fill`. Its names are the keys of the JSON object.
#[derive(Serialize)]
struct Report {
    input: String,
    output: String,
    points_in: usize,
    points_out: usize,
    holes: Vec<Hole>,
    notes: Vec<String>,
}

/// What happened at a loop. Its names are the keys of the JSON object.
#[derive(Serialize)]
pub(crate) struct Hole {
    id: u32,
    /// Different points on the loop.
    rim: usize,
    /// Fill points.
    points: usize,
    rounds: u32,
    /// Points of the rim and the fill that see a corner of more than 150° open.
    open: usize,
    seconds: f64,
}

impl Hole {
    pub(crate) fn new(fill: &Fill) -> Self {
        let &Fill { id, rim, points, rounds, open, duration } = fill;
        Self { id, rim, points, rounds, open, seconds: duration.as_secs_f64() }
    }

    /// Number of fill points.
    pub(crate) fn points(&self) -> usize {
        self.points
    }
}

impl Report {
    fn new(args: &FillArgs, points: &PointSet, source: &Source, filled: &Filled) -> Self {
        let mut notes = source.notes.clone();
        notes.extend(fill_notes(&args.fill_holes, filled));
        Self {
            input: name(&args.input),
            output: name(&args.output),
            points_in: points.len(),
            points_out: filled.points.len(),
            holes: filled.fills.iter().map(Hole::new).collect(),
            notes,
        }
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { input, output, points_in, points_out, holes, notes } = self;
        writeln!(f, "input    {input}: {}", summary::points(*points_in))?;
        writeln!(f, "output   {output}: {}", summary::points(*points_out))?;
        f.write_str(&fill_summary(holes))?;
        notes.iter().try_for_each(|note| writeln!(f, "note     {note}"))
    }
}

/// One line, or none where no loop was chosen.
pub(crate) fn fill_summary(holes: &[Hole]) -> String {
    let filled: Vec<&Hole> = holes.iter().filter(|hole| hole.points > 0).collect();
    let points: usize = filled.iter().map(|hole| hole.points).sum();
    let seconds: f64 = holes.iter().map(|hole| hole.seconds).sum();
    match filled.len() {
        0 => String::new(),
        count => {
            let points = summary::points(points);
            format!("holes    {count} filled with {points} in {seconds:.3} s\n")
        }
    }
}

/// What the user might not expect.
pub(crate) fn fill_notes(choice: &FillChoice, filled: &Filled) -> Vec<String> {
    let Filled { fills, restored, kept_raised, .. } = filled;
    let mut notes = Vec::new();
    let asked = !matches!(choice, FillChoice::None | FillChoice::Raised);
    if fills.is_empty() && asked {
        notes.push("there is nothing to fill: `surfine holes` lists all loops".into());
    }
    if *restored > 0 {
        notes.push(format!(
            "{restored} radii, raised by hand to close holes, are natural again: the holes were filled instead"
        ));
    }
    if *kept_raised > 0 {
        notes.push(format!(
            "{kept_raised} radii are far above the natural ones, but no loop that was filled has them: kept"
        ));
    }
    for fill in fills.iter().filter(|fill| fill.points == 0) {
        notes.push(format!("loop {} could not be closed: left as it was", fill.id));
    }
    for fill in fills.iter().filter(|fill| fill.points > 0 && 10 * fill.open > fill.points) {
        notes.push(format!("loop {}: {} of its points still see a place open", fill.id, fill.open));
    }
    notes
}
