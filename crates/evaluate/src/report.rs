//! The evaluation as a table for people.

use std::fmt;

use crate::coverage::{Along, Coverage};
use crate::discs::Disc;
use crate::evaluation::Evaluation;
use crate::spread::{Angles, Spread};
use crate::survival::Survival;
use crate::truth::{TruthKind, TruthSummary};

/// Columns: the measure, its unit, what was found.
type Row = [String; 3];

impl Evaluation {
    /// A table for people: a measure a line, with its unit. Measures without a line could not be measured.
    pub fn report(&self) -> String {
        let rows = self.rows();
        let width =
            |column: usize| rows.iter().map(|r| r[column].chars().count()).max().unwrap_or(0);
        let (first, second) = (width(0), width(1));
        let line = |[name, unit, text]: &Row| format!("{name:first$}  {unit:second$}  {text}\n");
        rows.iter().map(line).collect()
    }

    fn rows(&self) -> Vec<Row> {
        let mut rows = self.subjects();
        rows.extend(self.shape_rows());
        rows.extend(self.normal_rows());
        rows.extend(self.distribution_rows());
        rows.extend(self.input_rows());
        rows
    }

    fn subjects(&self) -> Vec<Row> {
        let output = &self.output;
        let mut text = format!("{}, mean spacing {}", output.points, number(output.spacing));
        if output.positions < output.points {
            text += &format!(", {} different positions", output.positions);
        }
        if output.bad_normals > 0 {
            text += &format!(", {} without a usable normal", output.bad_normals);
        }
        vec![
            row("output", "points", text),
            row("truth", truth_unit(&self.truth), truth(&self.truth)),
        ]
    }

    fn shape_rows(&self) -> Vec<Row> {
        let (distance, coverage) = (&self.distance, &self.coverage);
        let kind = match self.truth.kind {
            TruthKind::Mesh => "distance to the mesh",
            TruthKind::TangentPlanes => "distance to tangent planes",
            TruthKind::Points => "distance to points",
        };
        let gaps = |max, p999, over_1, over_2| {
            format!(
                "max {}  p99.9 {}  over 1: {}  over 2: {}",
                number(max),
                number(p999),
                percent(over_1),
                percent(over_2)
            )
        };
        let &Coverage { max, p999, over_1, over_2, samples, max_distance, along } = coverage;
        let straight = format!("{}  of {samples} samples", gaps(max, p999, over_1, over_2));
        let mut rows = vec![
            row(kind, "file units", spread(&distance.absolute)),
            row("", "diagonals", spread(&distance.in_diagonals)),
            row("", "spacings", spread(&distance.in_spacings)),
            row("truth to output (holes)", "local spacings", straight),
            row("", "file units", format!("max {}", number(max_distance))),
        ];
        rows.extend(along.map(|along| {
            let Along { max, p999, over_1, over_2 } = along;
            row("  along the surface", "local spacings", gaps(max, p999, over_1, over_2))
        }));
        rows
    }

    fn normal_rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        if let Some(normals) = &self.normals {
            rows.push(row("normal error", "degrees", angles(&normals.all)));
            if let Some(away) = &normals.away_from_creases {
                let text = format!("{}  of {} points", angles(&away.angles), away.points);
                rows.push(row("  away from creases", "degrees", text));
            }
        }
        if let Some(smoothness) = &self.smoothness {
            rows.push(row("normals to neighbors'", "degrees", angles(&smoothness.output)));
            if let Some(truth) = &smoothness.truth {
                rows.push(row("  the same of the truth", "degrees", angles(truth)));
            }
        }
        rows
    }

    fn distribution_rows(&self) -> Vec<Row> {
        let (uniformity, chamfer) = (&self.uniformity, &self.chamfer);
        let mut rows = vec![row("nearest neighbor (nnCV)", "1", number(uniformity.nn_cv))];
        if let Some(discs) = &uniformity.discs {
            let text = discs.iter().map(disc).collect::<Vec<_>>().join("  ");
            rows.push(row("uniformity (PU-GAN)", "file units", text));
        }
        let both = |chamfer, hausdorff| {
            format!("Chamfer {}  Hausdorff {}", number(chamfer), number(hausdorff))
        };
        let points = format!("to {} points of the truth", chamfer.truth_points);
        let plain = both(chamfer.plain.chamfer, chamfer.plain.hausdorff);
        rows.push(row(&points, "file units", plain));
        let pu = both(chamfer.pu.chamfer, chamfer.pu.hausdorff);
        rows.push(row("  PU-GAN's convention", "squared radii", pu));
        rows
    }

    fn input_rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        if let Some(colors) = &self.colors {
            let [mean, rms, max] = [colors.mean, colors.rms, colors.max].map(number);
            let mut text = format!("mean {mean}  rms {rms}  max {max}");
            if let Some(nearest) = colors.nearest_input_rms {
                text += &format!("  (nearest input point: rms {})", number(nearest));
            }
            rows.push(row("color error", "of 255", text));
        }
        if let Some(found) = &self.survival {
            rows.push(row("input kept", "points", survival(found)));
        }
        rows
    }
}

impl fmt::Display for Evaluation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.report())
    }
}

fn row(name: &str, unit: &str, text: String) -> Row {
    [name.into(), unit.into(), text]
}

fn truth_unit(truth: &TruthSummary) -> &'static str {
    if truth.kind == TruthKind::Mesh { "triangles" } else { "points" }
}

fn truth(truth: &TruthSummary) -> String {
    let count = if truth.kind == TruthKind::Mesh { truth.triangles } else { truth.points };
    let mut text = format!("{count}, diagonal {}", number(truth.diagonal));
    if let Some(area) = truth.area {
        text += &format!(", area {}", number(area));
    }
    let remarks = [
        (truth.sharp_edges, "sharp edges"),
        (truth.degenerate_triangles, "triangles without area left out"),
        (truth.inconsistent_edges, "edges between triangles of opposite winding"),
        (truth.bad_normals, "points without a usable normal"),
    ];
    for (count, what) in remarks.into_iter().filter(|r| r.0 > 0) {
        text += &format!(", {count} {what}");
    }
    text
}

fn spread(spread: &Spread) -> String {
    let [mean, rms, p95, max] = [spread.mean, spread.rms, spread.p95, spread.max].map(number);
    format!("mean {mean}  rms {rms}  p95 {p95}  max {max}")
}

fn angles(angles: &Angles) -> String {
    let [mean, rms, p95, max] = [angles.mean, angles.rms, angles.p95, angles.max].map(number);
    let (over_30, over_90) = (percent(angles.over_30), percent(angles.over_90));
    format!(
        "mean {mean}  rms {rms}  p95 {p95}  max {max}  over 30°: {over_30}  over 90°: {over_90}"
    )
}

fn disc(disc: &Disc) -> String {
    let value = disc.value.map_or("-".into(), number);
    let skipped = match disc.skipped {
        0 => String::new(),
        skipped => format!(" ({skipped} discs too empty)"),
    };
    format!("{:.1} %: {value}{skipped}", 100.0 * disc.share)
}

fn survival(found: &Survival) -> String {
    let mut text = format!("{} of {}, bit for bit and in order", found.kept, found.input_points);
    if let (Some(first), Some(anywhere)) = (found.first_changed, found.found_anywhere) {
        text += &format!("; the first changed is {first}; {anywhere} positions found anywhere");
    }
    if !found.missing.is_empty() {
        text += &format!("; without {}", found.missing.join(", "));
    }
    text
}

/// Four digits, with an exponent where the number is small or large.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e5).contains(&size) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - size.log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.decimals$}")
}

fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}
