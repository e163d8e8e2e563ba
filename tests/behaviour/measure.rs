//! Measures of a refined cloud.

use surfine_points::shapes::{Sampling, Shape, sample};
use surfine_points::{Grid, GridShape, PointSet, Refined, Vec3};

/// Mean of numbers.
pub(crate) fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / count
}

/// The value in the middle, of an even number the upper one.
pub(crate) fn median(values: &[f32]) -> f32 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f32::total_cmp);
    sorted[sorted.len() / 2]
}

/// Points after each step for each point before it.
pub(crate) fn growths(refined: &Refined) -> Vec<f64> {
    refined.level_sizes.windows(2).map(|w| w[1] as f64 / w[0] as f64).collect()
}

/// Points sorted into cells of about their spacing, for questions about the nearest.
pub(crate) struct Nearest<'a> {
    positions: &'a [Vec3],
    grid: Grid,
}

impl<'a> Nearest<'a> {
    /// Cells of this size for these positions.
    pub(crate) fn new(positions: &'a [Vec3], cell: f32) -> Self {
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let shape = GridShape::with_cell(low, cell, positions.len());
        Self { positions, grid: Grid::build(shape, (0u32..).zip(positions.iter().copied())) }
    }

    /// Distance from `x` to the nearest position for which `other` holds. There must be one.
    pub(crate) fn distance(&self, x: Vec3, other: impl Fn(u32) -> bool) -> f64 {
        let mut ball = self.grid.shape.cell;
        loop {
            let mut nearest = f32::MAX;
            self.grid.visit_ball(x, ball, |j, _| {
                if other(j) {
                    nearest = nearest.min((self.positions[j as usize] - x).length());
                }
            });
            // Cells hold points beyond the ball too: a nearer one may lie in a cell that was not visited.
            if nearest <= ball {
                return f64::from(nearest);
            }
            ball *= 2.0;
        }
    }
}

/// Distance from each point to the nearest other one.
pub(crate) fn nearest_distances(points: &PointSet) -> Vec<f64> {
    let nearest = Nearest::new(&points.positions, 0.5 * median(&points.radii));
    let distance = |(i, &x): (u32, &Vec3)| nearest.distance(x, |j| j != i);
    (0..).zip(&points.positions).map(distance).collect()
}

/// Coefficient of variation of the distance to the nearest other point, "nnCV": 0 for a lattice, .52 for points thrown
/// at random into the plane.
pub(crate) fn nearest_variation(points: &PointSet) -> f64 {
    let distances = nearest_distances(points);
    let mean_distance = mean(distances.iter().copied());
    mean(distances.iter().map(|d| (d - mean_distance).powi(2))).sqrt() / mean_distance
}

/// Radius of the largest ball around a point of the shape that holds no point of the cloud, found with this many random
/// points of the shape.
pub(crate) fn largest_empty_disc(points: &PointSet, shape: Shape, probes: usize) -> f64 {
    let nearest = Nearest::new(&points.positions, median(&points.radii));
    let probes = sample(shape, Sampling::Random, probes, 99).positions;
    probes.into_iter().map(|x| nearest.distance(x, |_| true)).fold(0.0, f64::max)
}

/// Mean distance of the new points from a shape.
pub(crate) fn mean_distance(refined: &Refined, shape: Shape) -> f64 {
    let new = &refined.points.positions[refined.level_sizes[0]..];
    mean(new.iter().map(|&x| f64::from(shape.distance(x))))
}

/// Mean angle in degrees between the new points' normals and those of the shape.
pub(crate) fn mean_normal_error(refined: &Refined, shape: Shape) -> f64 {
    let new = refined.level_sizes[0]..refined.points.len();
    let error = |i: usize| {
        let (found, exact) = (refined.points.normals[i], shape.normal(refined.points.positions[i]));
        // The cross product keeps its digits at small angles, the inverse cosine does not.
        let (found, exact) = (found.as_dvec3(), exact.as_dvec3());
        found.cross(exact).length().atan2(found.dot(exact)).to_degrees()
    };
    mean(new.map(error))
}

/// The bits of vectors, in which the smallest difference shows.
pub(crate) fn vector_bits(vectors: &[Vec3]) -> Vec<[u32; 3]> {
    vectors.iter().map(|v| v.to_array().map(f32::to_bits)).collect()
}

/// The bits of numbers.
pub(crate) fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|v| v.to_bits()).collect()
}

/// Fails unless two results have the same bytes: sizes of the levels, positions, normals, radii, parents.
#[track_caller]
pub(crate) fn assert_same_bytes(a: &Refined, b: &Refined, what: &str) {
    assert_eq!(a.level_sizes, b.level_sizes, "{what}: points per level");
    let same = |equal: bool, column: &str| assert!(equal, "{what}: {column} differ");
    same(a.parents == b.parents, "parents");
    same(vector_bits(&a.points.positions) == vector_bits(&b.points.positions), "positions");
    same(vector_bits(&a.points.normals) == vector_bits(&b.points.normals), "normals");
    same(bits(&a.points.radii) == bits(&b.points.radii), "radii");
}
