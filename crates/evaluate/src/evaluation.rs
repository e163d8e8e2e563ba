//! All measures together.

use serde::Serialize;
use surfine_points::Model;

use crate::chamfer::{self, Chamfer};
use crate::cloud::{self, Cloud};
use crate::colors::{self, ColorError};
use crate::coverage::{self, Coverage};
use crate::distance::{self, Distance};
use crate::error::{Unfit, check};
use crate::normals::{self, NormalError};
use crate::smoothness::{self, Smoothness};
use crate::survival::{self, Survival};
use crate::truth::{Truth, TruthSummary};
use crate::uniformity::{self, Uniformity};

/// What is left to choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Points that are taken from a mesh to measure the coverage. 0 stands for twice the points of the output, no less
    /// than 100 000 and no more than 1 000 000. A truth of points is used as it is.
    pub samples: usize,
    /// Of the samples of a mesh: another seed, other samples.
    pub seed: u64,
}

impl Options {
    fn coverage_samples(&self, output: usize) -> usize {
        if self.samples > 0 { self.samples } else { (2 * output).clamp(100_000, 1_000_000) }
    }
}

/// How well an output shows the truth. Sections that can't be measured are `None`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// What was measured.
    pub output: OutputSummary,
    /// What it was measured against.
    pub truth: TruthSummary,
    /// How far the output is from the truth.
    pub distance: Distance,
    /// How much of the truth the output leaves bare.
    pub coverage: Coverage,
    /// How far its normals are turned, if both have normals.
    pub normals: Option<NormalError>,
    /// How evenly it is spread.
    pub uniformity: Uniformity,
    /// Chamfer and Hausdorff distances, both conventions.
    pub chamfer: Chamfer,
    /// How well each normal fits those around it, if the output has normals.
    pub smoothness: Option<Smoothness>,
    /// How far its colours are off, if both have colours.
    pub colors: Option<ColorError>,
    /// Whether the input is still there, if it was given.
    pub survival: Option<Survival>,
}

/// What is known of the output itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OutputSummary {
    /// Points.
    pub points: usize,
    /// Different positions among them.
    pub positions: usize,
    /// Mean spacing, units of the file: the mean over all positions of the mean distance to the six nearest others, or to
    /// all if there are fewer.
    pub spacing: f64,
    /// Points whose normal is zero or not finite, which measures of normals leave out.
    pub bad_normals: usize,
}

/// Measures an output against the truth. With the input it came from, says too whether that survived.
///
/// `progress` is called with the name of each measure as it begins. Triangles of the
/// output and of the input don't count, but a mesh without normals has those of its triangles.
///
/// # Errors
/// The first thing in the output or the input that makes it unfit, see [`Unfit`].
pub fn evaluate(
    output: &Model,
    truth: &Truth,
    input: Option<&Model>,
    options: &Options,
    progress: &mut dyn FnMut(&'static str),
) -> Result<Evaluation, Unfit> {
    if let Some(input) = input {
        check(input, "input")?;
    }
    progress("spacing");
    let cloud = Cloud::new(output)?;
    Ok(measure(&cloud, truth, input, options, progress))
}

fn measure(
    cloud: &Cloud<'_>,
    truth: &Truth,
    input: Option<&Model>,
    options: &Options,
    progress: &mut dyn FnMut(&'static str),
) -> Evaluation {
    // Each sample has a seed of its own, or the points of the smaller ones would not be independent.
    let seed = |sample: u64| options.seed.wrapping_mul(3).wrapping_add(sample);
    let samples = options.coverage_samples(cloud.model.len());
    progress("distance");
    let closest = distance::project(&cloud.model.positions, cloud.normals.as_deref(), truth);
    let distance = distance::measure(cloud, truth, &closest);
    progress("coverage");
    let coverage = coverage::measure(cloud, truth, &closest, samples, seed(0));
    progress("normals");
    let normals = normals::measure(cloud, truth, &closest);
    progress("uniformity");
    let uniformity = uniformity::measure(cloud, truth, &closest, seed(1));
    progress("chamfer");
    let chamfer = chamfer::measure(cloud, truth, seed(2));
    progress("smoothness");
    let smoothness = smoothness::measure(cloud, &closest);
    progress("colors");
    let colors = colors::measure(cloud, &closest, input);
    progress("survival");
    let survival = input.map(|input| survival::measure(cloud.model, input));
    Evaluation {
        output: summary(cloud),
        truth: truth.summary().clone(),
        distance,
        coverage,
        normals,
        uniformity,
        chamfer,
        smoothness,
        colors,
        survival,
    }
}

fn summary(cloud: &Cloud<'_>) -> OutputSummary {
    OutputSummary {
        points: cloud.model.len(),
        positions: cloud.places.len(),
        spacing: cloud.spacing,
        bad_normals: cloud.bad_normals(),
    }
}

/// Unsigned distance from each point of the output to the truth, units of the file: what [`Distance`] sums up, for heat
/// maps.
///
/// # Errors
/// The first thing in the output that makes it unfit, see [`Unfit`].
pub fn errors(output: &Model, truth: &Truth) -> Result<Vec<f64>, Unfit> {
    check(output, "output")?;
    let normals = cloud::normals(output);
    let closest = distance::project(&output.positions, normals.as_deref(), truth);
    Ok(closest.into_iter().map(|c| c.distance).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_grow_with_the_output_between_two_limits() {
        let chosen = |output| Options::default().coverage_samples(output);
        let counts = [2, 50_000, 123_456, 500_000, 9_000_000].map(chosen);
        assert_eq!(counts, [100_000, 100_000, 246_912, 1_000_000, 1_000_000]);
        let wanted = Options { samples: 7, ..Options::default() };
        assert_eq!(wanted.coverage_samples(9_000_000), 7);
    }
}
