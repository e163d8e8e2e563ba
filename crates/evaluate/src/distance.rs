//! How far the output is from the truth.

use rayon::prelude::*;
use serde::Serialize;
use surfine_points::DVec3;

use crate::cloud::Cloud;
use crate::spread::Spread;
use crate::truth::{Closest, Truth};

/// Unsigned distances from the points of the output to the truth: "point to surface", P2F in the literature.
///
/// It looks from the output only, so it sees noise and outliers but no hole. What it is measured to is said by
/// [`TruthSummary::kind`](crate::TruthSummary::kind).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Distance {
    /// In units of the file.
    pub absolute: Spread,
    /// In diagonals of the truth's bounding box.
    pub in_diagonals: Spread,
    /// In mean spacings of the output.
    pub in_spacings: Spread,
}

/// The point of the truth that belongs to each position, on the side that its normal shows.
pub(crate) fn project(
    positions: &[DVec3],
    normals: Option<&[Option<DVec3>]>,
    truth: &Truth,
) -> Vec<Closest> {
    let normal = |i: usize| normals.and_then(|normals| normals[i]);
    positions.par_iter().enumerate().map(|(i, &x)| truth.nearest(x, normal(i))).collect()
}

pub(crate) fn measure(output: &Cloud<'_>, truth: &Truth, closest: &[Closest]) -> Distance {
    let distances: Vec<f64> = closest.iter().map(|c| c.distance).collect();
    let absolute = Spread::of(&distances);
    Distance {
        absolute,
        in_diagonals: absolute.per(truth.summary().diagonal),
        in_spacings: absolute.per(output.spacing),
    }
}
