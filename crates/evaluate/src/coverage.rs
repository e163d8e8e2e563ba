//! How much of the truth the output leaves bare.

use rayon::prelude::*;
use serde::Serialize;
use surfine_points::DVec3;

use crate::cloud::Cloud;
use crate::spread::{percentile, share, sorted};
use crate::truth::{Closest, Sample, Truth};

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
    /// The same along the surface, if the truth has normals.
    pub along: Option<Along>,
}

/// Gaps along the surface: the distances of [`Coverage`] without their part along the truth's normal, and to points of
/// the same sheet only, those that lie nearest to a place of the truth that faces the same way. An output that is dense
/// but lies beside the truth has none, and one with a hole above another sheet has.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Along {
    /// Largest, in local spacings.
    pub max: f64,
    /// 99.9th [`percentile`], in local spacings.
    pub p999: f64,
    /// Share of the truth farther than one local spacing, 0 to 1.
    pub over_1: f64,
    /// Share of the truth farther than two local spacings, 0 to 1.
    pub over_2: f64,
}

/// Nearest points among which one of the same sheet is looked for; without any the nearest counts, with the whole of its
/// distance.
const SAME_SHEET_AMONG: usize = 16;

/// `closest` holds the place of the truth that is nearest to each point of the output.
pub(crate) fn measure(
    output: &Cloud<'_>,
    truth: &Truth,
    closest: &[Closest],
    samples: usize,
    seed: u64,
) -> Coverage {
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
        along: along(output, closest, &samples),
    }
}

fn along(output: &Cloud<'_>, closest: &[Closest], samples: &[Sample]) -> Option<Along> {
    let gap = |sample: &Sample| Some(gap_along(output, closest, sample.position, sample.normal?));
    // A truth has normals everywhere or nowhere, but for a few bad ones.
    let ratios: Vec<f64> = samples.par_iter().filter_map(gap).collect();
    let ratios = sorted(ratios);
    (!ratios.is_empty()).then(|| Along {
        max: percentile(&ratios, 1.0),
        p999: percentile(&ratios, 0.999),
        over_1: share(&ratios, |r| r > 1.0),
        over_2: share(&ratios, |r| r > 2.0),
    })
}

/// Distance along the surface from a point of the truth to the nearest point of its sheet, in local spacings.
fn gap_along(output: &Cloud<'_>, closest: &[Closest], x: DVec3, normal: DVec3) -> f64 {
    let near = output.tree.nearest_n(x, SAME_SHEET_AMONG);
    let is_of_sheet = |&place: &usize| {
        let points = output.places.points_at(place).iter();
        points.filter_map(|&i| closest[i as usize].normal).any(|n| n.dot(normal) > 0.0)
    };
    let offset = |place: usize| output.places.positions[place] - x;
    let (place, distance) = match near.iter().map(|&place| place as usize).find(is_of_sheet) {
        Some(place) => (place, offset(place).reject_from_normalized(normal).length()),
        None => (near[0] as usize, offset(near[0] as usize).length()),
    };
    distance / output.spacings[place]
}
