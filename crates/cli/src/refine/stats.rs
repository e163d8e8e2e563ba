//! How radii and co-cone angles fall from level to level, for people and as JSON.

use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use surfine_points::Convergence;

/// One entry a level, the input first. Names are the keys of the JSON objects.
#[derive(Serialize)]
#[serde(transparent)]
pub(super) struct Stats(Vec<Level>);

#[derive(Serialize)]
struct Level {
    points: usize,
    /// In the unit of the file.
    radius: Spread,
    /// Over the same measure of the input.
    radius_ratio: Spread,
    co_cone_degrees: Spread,
    /// Points without a neighbour within their radius, which have no co-cone.
    alone: usize,
}

#[derive(Serialize)]
struct Spread {
    median: f64,
    mean: f64,
    max: f64,
}

impl Stats {
    pub(super) fn new(levels: &[Convergence]) -> Self {
        let Some(input) = levels.first().map(|l| l.radius) else { return Self(Vec::new()) };
        // A cloud without points has no radius to compare with.
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 1.0 };
        let level = |l: &Convergence| Level {
            points: l.points,
            radius: l.radius.into(),
            radius_ratio: Spread {
                median: ratio(l.radius.median, input.median),
                mean: ratio(l.radius.mean, input.mean),
                max: ratio(l.radius.max, input.max),
            },
            co_cone_degrees: l.angle.into(),
            alone: l.alone,
        };
        Self(levels.iter().map(level).collect())
    }
}

impl From<surfine_points::Spread> for Spread {
    fn from(spread: surfine_points::Spread) -> Self {
        let surfine_points::Spread { median, mean, max } = spread;
        Self { median, mean, max }
    }
}

impl Display for Stats {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let group = |title: &str, unit: &str| format!("{title:<16}{unit:>11}");
        let columns = format!("{:>9}{:>9}{:>9}", "median", "mean", "max");
        let groups = [("radius", ""), ("radius", "/ level 0"), ("co-cone angle", "degrees")];
        let titles: String =
            groups.map(|(title, unit)| format!("  {}", group(title, unit))).concat();
        writeln!(f, "stats    {:>5} {:>9}{titles}", "", "")?;
        let columns = format!("  {columns}").repeat(groups.len());
        writeln!(f, "         {:>5} {:>9}{columns}", "level", "points")?;
        for (number, level) in self.0.iter().enumerate() {
            write!(f, "         {number:>5} {:>9}  ", level.points)?;
            let Spread { median, mean, max } = level.radius;
            write!(f, "{median:>9.2e}{mean:>9.2e}{max:>9.2e}  ")?;
            let Spread { median, mean, max } = level.radius_ratio;
            write!(f, "{median:>9.4}{mean:>9.4}{max:>9.4}  ")?;
            let Spread { median, mean, max } = level.co_cone_degrees;
            write!(f, "{median:>9.3}{mean:>9.3}{max:>9.3}")?;
            match level.alone {
                0 => writeln!(f)?,
                alone => writeln!(f, "  {alone} without neighbors")?,
            }
        }
        Ok(())
    }
}
