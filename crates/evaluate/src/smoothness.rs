//! How well each normal fits those around it.

use rayon::prelude::*;
use serde::Serialize;
use surfine_points::DVec3;

use crate::cloud::Cloud;
use crate::normals::angle;
use crate::places::same_side;
use crate::spread::Angles;
use crate::truth::Closest;

/// Angles between the normal of each point and the mean of the normals at its eight nearest other positions.
///
/// Of several points in one position, the sides of a crease, the one whose normal agrees best counts. Curvature makes
/// such angles too: hold `output` against `truth`, which has the true normals at the same points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Smoothness {
    /// Points that were measured: those that have a normal, as one of their neighbours has.
    pub points: usize,
    /// With the normals of the output.
    pub output: Angles,
    /// With the normals of the truth at the same points with the same neighbours, if it has any.
    pub truth: Option<Angles>,
}

/// `None` if no point has a normal.
pub(crate) fn measure(output: &Cloud<'_>, closest: &[Closest]) -> Option<Smoothness> {
    output.normals.as_ref()?;
    let own = |point: usize| output.normal(point);
    let exact = |point: usize| closest[point].normal;
    let measured: Vec<(Option<f64>, Option<f64>)> = (0..closest.len())
        .into_par_iter()
        .map(|point| {
            let neighbors = neighbors(output, point);
            (turn(point, &neighbors, own), turn(point, &neighbors, exact))
        })
        .collect();
    let ours: Vec<f64> = measured.iter().filter_map(|m| m.0).collect();
    let theirs: Vec<f64> = measured.iter().filter_map(|m| m.1).collect();
    Some(Smoothness { points: ours.len(), output: Angles::of(&ours)?, truth: Angles::of(&theirs) })
}

/// One point at each of the nearest positions: that on the point's side.
fn neighbors(output: &Cloud<'_>, point: usize) -> Vec<usize> {
    let place = output.places.of_point[point] as usize;
    let nearest = output.neighbors(place).iter();
    let side = |&other: &u32| {
        let points = output.places.points_at(other as usize);
        same_side(points, output.normals.as_deref(), output.normal(point))
    };
    nearest.map(side).collect()
}

/// Angle from a normal to the mean of its neighbours', degrees; `None` if one of the two has no direction.
fn turn(point: usize, neighbors: &[usize], normal: impl Fn(usize) -> Option<DVec3>) -> Option<f64> {
    let sum: DVec3 = neighbors.iter().filter_map(|&other| normal(other)).sum();
    Some(angle(normal(point)?, sum.try_normalize()?))
}
