//! Clouds with holes, and measures of what fills them.

use surfine_points::shapes::{Sampling, Shape, natural_radii, sample};
use surfine_points::{PointSet, Vec3};

pub(crate) fn even(shape: Shape, points: usize) -> PointSet {
    sample(shape, Sampling::BlueNoise, points, 1)
}

/// The cloud without the points within a ball, with natural radii.
pub(crate) fn without(points: &PointSet, center: Vec3, radius: f32) -> PointSet {
    let kept: Vec<usize> =
        (0..points.len()).filter(|&i| (points.positions[i] - center).length() > radius).collect();
    let positions: Vec<Vec3> = kept.iter().map(|&i| points.positions[i]).collect();
    let normals: Vec<Vec3> = kept.iter().map(|&i| points.normals[i]).collect();
    let radii = natural_radii(&positions, &normals);
    PointSet::new(positions, normals, radii)
}

/// Two holes in a sphere: a large one at +z, a smaller one at -z.
pub(crate) fn two_holes() -> PointSet {
    let sphere = even(Shape::Sphere, 2000);
    without(&without(&sphere, Vec3::Z, 0.6), Vec3::NEG_Z, 0.3)
}

/// Mean distance to the nearest point, of points from `first` on that `counts` accepts.
pub(crate) fn spacing(points: &PointSet, counts: impl Fn(usize) -> bool) -> f32 {
    let nearest = |i: usize| {
        let others = (0..points.len()).filter(|&j| j != i);
        others
            .map(|j| (points.positions[j] - points.positions[i]).length())
            .fold(f32::INFINITY, f32::min)
    };
    let all: Vec<f32> = (0..points.len()).filter(|&i| counts(i)).map(nearest).collect();
    all.iter().sum::<f32>() / all.len() as f32
}

/// Distance from a place to the nearest point.
pub(crate) fn reach(points: &PointSet, x: Vec3) -> f32 {
    points.positions.iter().map(|p| (*p - x).length()).fold(f32::INFINITY, f32::min)
}
