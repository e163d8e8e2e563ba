//! How evenly the output is spread.

use serde::Serialize;

use crate::cloud::Cloud;
use crate::discs::{self, Disc};
use crate::spread::mean;
use crate::truth::{Closest, Truth};

/// How evenly the positions of the output are spread. Positions that several points share count once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Uniformity {
    /// Coefficient of variation of the distance to the nearest other position, "nnCV": standard deviation by mean. 0 for
    /// a lattice, about 0.52 for points thrown at random into a plane.
    pub nn_cv: f64,
    /// The uniform measure of PU-GAN, one entry a disc size; it needs the area of a mesh.
    pub discs: Option<Vec<Disc>>,
}

pub(crate) fn measure(
    output: &Cloud<'_>,
    truth: &Truth,
    closest: &[Closest],
    seed: u64,
) -> Uniformity {
    Uniformity { nn_cv: nn_cv(output), discs: discs::measure(output, truth, closest, seed) }
}

fn nn_cv(output: &Cloud<'_>) -> f64 {
    let distance = |place| output.neighbor_distance(place, 0);
    let center = mean((0..output.places.len()).map(distance));
    let variance = mean((0..output.places.len()).map(|place| (distance(place) - center).powi(2)));
    variance.sqrt() / center
}
