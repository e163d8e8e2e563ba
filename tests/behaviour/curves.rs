//! Clouds with creases, corners and boundaries, and questions about their refinement.

use surfine_points::shapes::{Outlined, Sampling, sample_outlined};
use surfine_points::{PointSet, Refined, Values, Vec3};

/// Even points with creases or a rim.
pub(crate) fn even(shape: Outlined, n: usize, seed: u64) -> PointSet {
    sample_outlined(shape, Sampling::BlueNoise, n, seed)
}

/// Random points between even ones on creases or a rim.
pub(crate) fn uneven(shape: Outlined, n: usize, seed: u64) -> PointSet {
    sample_outlined(shape, Sampling::Random, n, seed)
}

/// Side of the triangles of an even cloud of so many points on a surface of this area.
pub(crate) fn spacing(area: f64, points: usize) -> f64 {
    (2.0 * area / (3f64.sqrt() * points as f64)).sqrt()
}

/// A property of bytes.
pub(crate) fn bytes<'a>(points: &'a PointSet, name: &str) -> &'a [u8] {
    match points.attribute(name).map(|a| &a.values) {
        Some(Values::U8(values)) => values,
        other => panic!("{name} is {other:?}"),
    }
}

/// A property of floats.
pub(crate) fn floats<'a>(points: &'a PointSet, name: &str) -> &'a [f32] {
    match points.attribute(name).map(|a| &a.values) {
        Some(Values::F32(values)) => values,
        other => panic!("{name} is {other:?}"),
    }
}

/// Sets a property of floats at one point.
pub(crate) fn set_float(points: &mut PointSet, name: &str, i: usize, value: f32) {
    let attribute = points.attributes.iter_mut().find(|a| a.name == name);
    match attribute.map(|a| &mut a.values) {
        Some(Values::F32(values)) => values[i] = value,
        other => panic!("{name} is {other:?}"),
    }
}

/// The further normals of a point: second, third.
pub(crate) fn further_normals(points: &PointSet, i: usize) -> [Vec3; 2] {
    ["2", "3"].map(|rank| {
        Vec3::from_array(["nx", "ny", "nz"].map(|n| floats(points, &format!("{n}{rank}"))[i]))
    })
}

/// Indices of the new points.
pub(crate) fn new_points(refined: &Refined) -> std::ops::Range<usize> {
    refined.level_sizes[0]..refined.points.len()
}

/// Distance to the nearest edge of the cube.
pub(crate) fn from_cube_edges(x: Vec3) -> f64 {
    // Two of the coordinates are those of the edge.
    let mut off = x.as_dvec3().to_array().map(|c| (c.abs() - 0.5).abs());
    off.sort_by(f64::total_cmp);
    off[0].hypot(off[1])
}

/// Distance to the nearer circle of the cylinder.
pub(crate) fn from_cylinder_edges(x: Vec3) -> f64 {
    let x = x.as_dvec3();
    (x.x.hypot(x.y) - 0.5).hypot(x.z.abs() - 0.5)
}
