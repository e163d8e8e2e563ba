//! What the summaries of several commands have in common.

use serde::{Serialize, Serializer};
use std::fmt::{self, Display, Formatter};
use std::path::Path;
use std::time::Duration;
use surfine::{Boundary, Neighborhood, RefineParams};

/// The parameters of a refinement. Its names are the keys of the JSON object.
#[derive(Serialize)]
pub(crate) struct Params {
    levels: u32,
    /// The one that was used: `accurate` or `fuzzy`.
    neighborhood: &'static str,
    simplified: bool,
    /// Whether angles between new neighbours were straight.
    plain_angle: bool,
    theta_f_degrees: f64,
    theta_c_degrees: f64,
    lambda1: f32,
    lambda2: f32,
    /// `θ_b`, where boundaries are found by it.
    boundary_angle_degrees: Option<f64>,
    /// The property that marks the boundary.
    boundary_property: Option<String>,
    /// Rules beyond the paper that were in effect: others may be on, but mean nothing with these parameters.
    rules: Vec<&'static str>,
}

impl Params {
    pub(crate) fn new(params: &RefineParams) -> Self {
        // The fourth decimal is the last that 32-bit radians keep.
        let degrees = |angle: f32| (f64::from(angle).to_degrees() * 1e4).round() / 1e4;
        let rules = params.rules_in_effect().named();
        Self {
            levels: params.levels,
            neighborhood: match params.effective_neighborhood() {
                Neighborhood::Accurate => "accurate",
                Neighborhood::Fuzzy => "fuzzy",
            },
            simplified: params.simplified,
            plain_angle: params.effective_plain_angle(),
            theta_f_degrees: degrees(params.theta_f),
            theta_c_degrees: degrees(params.theta_c),
            lambda1: params.lambda1,
            lambda2: params.lambda2,
            boundary_angle_degrees: match params.boundary {
                Boundary::Angle(theta_b) => Some(degrees(theta_b)),
                Boundary::None | Boundary::Marked(_) => None,
            },
            boundary_property: params.boundary.property().map(str::to_owned),
            rules: rules.into_iter().filter(|r| r.1).map(|r| r.0).collect(),
        }
    }
}

impl Display for Params {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let levels = counted(self.levels as usize, "level", "levels");
        let simplified = if self.simplified { "simplified, " } else { "" };
        let rules = counted(self.rules.len(), "rule", "rules");
        write!(
            f,
            "{levels}, {simplified}{} neighborhoods, {rules} beyond the paper",
            self.neighborhood
        )
    }
}

/// A path, for people.
pub(crate) fn name(path: &Path) -> String {
    path.display().to_string()
}

pub(crate) fn per_second(count: usize, time: Duration) -> f64 {
    // A refinement of nothing may take no time that the clock shows.
    count as f64 / time.as_secs_f64().max(1e-9)
}

/// `1 point`, `3 points`.
pub(crate) fn points(count: usize) -> String {
    counted(count, "point", "points")
}

pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// A JSON object that keeps the order of its keys.
pub(crate) fn in_order<S: Serializer>(
    entries: &[(&'static str, f64)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(entries.iter().copied())
}
