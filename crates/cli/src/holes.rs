//! `surfine holes`.

use crate::args::HolesArgs;
use crate::summary::{self, name};
use crate::{Failure, print, print_json};
use serde::Serialize;
use std::fmt::Write;
use surfine_holes::{Loop, loops};
use surfine_points::ply;

pub(crate) fn run(args: &HolesArgs) -> Result<(), Failure> {
    args.threads.start()?;
    let (points, _) = ply::read(&args.input)?;
    let loops: Vec<Row> = loops(&points).iter().map(Row::new).collect();
    let input = name(&args.input);
    if args.json {
        let report = Report { input, points: points.len(), loops };
        return print_json(&report);
    }
    if loops.is_empty() {
        return print(&format!("{input}: {}, no loops\n", summary::points(points.len())));
    }
    print(&table(&loops))
}

#[derive(Serialize)]
struct Report {
    input: String,
    points: usize,
    loops: Vec<Row>,
}

/// What is told of a loop. Its names are the keys of the JSON object.
#[derive(Serialize)]
struct Row {
    id: u32,
    points: usize,
    span: f32,
    span_spacings: f32,
    perimeter: f32,
    perimeter_spacings: f32,
    turning_degrees: f32,
    kind: String,
}

impl Row {
    fn new(found: &Loop) -> Self {
        let spacing = found.spacing();
        Self {
            id: found.id,
            points: found.points.len(),
            span: found.span,
            span_spacings: found.span / spacing,
            perimeter: found.perimeter,
            perimeter_spacings: found.perimeter / spacing,
            turning_degrees: found.turning.to_degrees(),
            kind: found.kind().to_string(),
        }
    }
}

fn table(loops: &[Row]) -> String {
    let mut text = String::from(
        "  id  points        span  (spacings)   perimeter  (spacings)  turning  kind\n",
    );
    for row in loops {
        let Row { id, points, span, span_spacings, perimeter, perimeter_spacings, .. } = row;
        let _ = write!(text, "{id:>4}  {points:>6}  {span:>10.4}  {span_spacings:>10.1}");
        let _ = write!(text, "  {perimeter:>10.4}  {perimeter_spacings:>10.1}");
        let _ = writeln!(text, "  {:>6.0}°  {}", row.turning_degrees, row.kind);
    }
    text
}
