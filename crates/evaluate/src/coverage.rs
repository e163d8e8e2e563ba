//! How much of the truth the output leaves bare.

use rayon::prelude::*;
use serde::Serialize;

use crate::cloud::Cloud;
use crate::spread::{percentile, share, sorted};
use crate::truth::Truth;

/// Distances from a dense sample of the truth to the nearest point of the output: the measure of holes.
///
/// The unit is the local spacing of that nearest point: the mean distance to its six nearest other positions. A regular
/// lattice of triangles reaches 0.58 at most, an even irregular cloud about 0.8.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coverage {
    /// Points of the truth that were looked at.
    pub samples: usize,
    /// Largest, in local spacings.
    pub max: f64,
    /// 99.9th [`percentile`], in local spacings.
    pub p999: f64,
    /// Share of the truth farther than one local spacing, 0 to 1.
    pub over_1: f64,
    /// Share of the truth farther than two local spacings, 0 to 1.
    pub over_2: f64,
    /// Largest distance in units of the file.
    pub max_distance: f64,
}

pub(crate) fn measure(output: &Cloud<'_>, truth: &Truth, samples: usize, seed: u64) -> Coverage {
    let samples = truth.samples(samples, seed);
    let gap = |x| {
        let (place, squared) = output.tree.nearest(x);
        (squared.sqrt(), squared.sqrt() / output.spacings[place])
    };
    let (distances, ratios): (Vec<f64>, Vec<f64>) =
        samples.par_iter().map(|sample| gap(sample.position)).unzip();
    let ratios = sorted(ratios);
    Coverage {
        samples: samples.len(),
        max: percentile(&ratios, 1.0),
        p999: percentile(&ratios, 0.999),
        over_1: share(&ratios, |r| r > 1.0),
        over_2: share(&ratios, |r| r > 2.0),
        max_distance: distances.into_iter().fold(0.0, f64::max),
    }
}
