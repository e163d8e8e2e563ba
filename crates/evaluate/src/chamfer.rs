//! Distances between two clouds, both ways.

use rayon::prelude::*;
use serde::Serialize;
use surfine_points::DVec3;

use crate::cloud::Cloud;
use crate::spread::mean;
use crate::tree::Tree;
use crate::truth::Truth;

/// Chamfer and Hausdorff distances between the output P and a cloud G of the truth.
///
/// G is the truth's points, or an even sample of a mesh with as many points as the output. The values depend on that
/// cloud: even a perfect output has a floor of about its spacing, lower for blue noise than for other samples. Compare
/// them only with values against the same G. A fixed one can be given as a truth of points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Chamfer {
    /// Points of G.
    pub truth_points: usize,
    /// In units of the file.
    pub plain: Plain,
    /// As programs of the up-sampling literature compute them.
    pub pu: Pu,
}

/// Distances as they are, in units of the file. d is the distance to the nearest point of the other cloud.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Plain {
    /// mean over P of d + mean over G of d.
    pub chamfer: f64,
    /// The larger of max over P of d and max over G of d: the Hausdorff distance of the two clouds.
    pub hausdorff: f64,
}

/// The convention of the programs that came with PU-GAN and PU-GCN, and of those that followed them.
///
/// Each cloud is first moved by its own centroid and scaled by the distance of its own farthest point from that, so the
/// values have no unit. d² is the square of the distance to the nearest point of the other cloud. Tables often show
/// the values times 1000; PUDM reports half of both.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pu {
    /// mean over P of d² + mean over G of d².
    pub chamfer: f64,
    /// max over P of d² + max over G of d²: a sum of squares, not the Hausdorff distance.
    pub hausdorff: f64,
}

pub(crate) fn measure(output: &Cloud<'_>, truth: &Truth, seed: u64) -> Chamfer {
    let ours = &output.model.positions;
    let samples = truth.samples(ours.len(), seed);
    let theirs: Vec<DVec3> = samples.into_iter().map(|sample| sample.position).collect();
    let there = squares(ours, &Tree::new(&theirs));
    let back = squares(&theirs, &output.tree);
    let plain = Plain {
        chamfer: mean(there.iter().map(|d| d.sqrt())) + mean(back.iter().map(|d| d.sqrt())),
        hausdorff: largest(&there).max(largest(&back)).sqrt(),
    };
    Chamfer { truth_points: theirs.len(), plain, pu: pu(ours, &theirs) }
}

fn pu(ours: &[DVec3], theirs: &[DVec3]) -> Pu {
    let (ours, theirs) = (normalized(ours), normalized(theirs));
    let there = squares(&ours, &Tree::new(&theirs));
    let back = squares(&theirs, &Tree::new(&ours));
    let average = |squares: &[f64]| mean(squares.iter().copied());
    Pu { chamfer: average(&there) + average(&back), hausdorff: largest(&there) + largest(&back) }
}

/// The cloud with its centroid at the origin and its farthest point at distance 1.
fn normalized(positions: &[DVec3]) -> Vec<DVec3> {
    // Relative to one of the points, so that a cloud far from the origin loses no digits.
    let first = positions[0];
    let sum: DVec3 = positions.iter().map(|&p| p - first).sum();
    let centroid = first + sum / positions.len() as f64;
    let farthest = positions.iter().map(|p| p.distance(centroid)).fold(0.0, f64::max);
    positions.iter().map(|&p| (p - centroid) / farthest).collect()
}

/// Squared distance from each position to the nearest of the tree's.
fn squares(positions: &[DVec3], tree: &Tree) -> Vec<f64> {
    positions.par_iter().map(|&x| tree.nearest(x).1).collect()
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}
