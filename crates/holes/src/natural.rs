//! Natural radii, and radii that were raised by hand to close a hole as in [R] figure 9 (rule 0, ours).

use glam::Vec3;
use surfine_points::shapes::{natural_radii, natural_radii_of};
use surfine_points::{Grid, GridShape, PointSet};

/// Only radii of more than this many median radii are looked at: a large cloud without any costs a median.
const SUSPICIOUS: f32 = 4.0;
/// A radius of more than this many natural radii was raised.
const RAISED: f32 = 2.5;

/// A point whose radius was raised by hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Raised {
    /// Index of the point.
    pub point: u32,
    /// The natural radius, in the units of the positions.
    pub radius: f32,
}

/// The points whose radius is more than 4 times the median and 2.5 times the natural one, by index. The natural radius is
/// [`natural_radii`], but no more than the largest radius of the points within it that were not raised: next to a hole
/// the neighbours on the tangent plane are some that the surface does not connect.
pub fn raised(points: &PointSet) -> Vec<Raised> {
    let Some(limit) = median(&points.radii).map(|median| SUSPICIOUS * median) else {
        return Vec::new();
    };
    let suspects: Vec<u32> =
        (0..points.len() as u32).filter(|&p| points.radii[p as usize] > limit).collect();
    if suspects.is_empty() {
        return Vec::new();
    }
    let natural = natural_radii_of(&suspects, &points.positions, &points.unit_normals());
    let mut found: Vec<Raised> = suspects
        .into_iter()
        .zip(natural)
        .filter(|&(p, natural)| points.radii[p as usize] > RAISED * natural)
        .map(|(point, radius)| Raised { point, radius })
        .collect();
    if let Some(widest) = found.iter().map(|raised| raised.radius).reduce(f32::max) {
        bound_by_neighbors(points, &mut found, widest);
    }
    found
}

/// Lowers each radius to the largest of those points within it that were not raised, if there are any.
fn bound_by_neighbors(points: &PointSet, raised: &mut [Raised], widest: f32) {
    let low = points.positions.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
    let shape = GridShape::with_cell(low, widest, points.len());
    let grid = Grid::build(shape, (0u32..).zip(points.positions.iter().copied()));
    let known: Vec<u32> = raised.iter().map(|raised| raised.point).collect();
    for raised in raised {
        let center = points.positions[raised.point as usize];
        let mut largest = 0.0f32;
        grid.visit_ball(center, raised.radius, |p, _| {
            let d = points.positions[p as usize] - center;
            if d.dot(d) <= raised.radius * raised.radius && known.binary_search(&p).is_err() {
                largest = largest.max(points.radii[p as usize]);
            }
        });
        if largest > 0.0 {
            raised.radius = raised.radius.min(largest);
        }
    }
}

/// The smaller of the natural and the given radius of each point: a given one that is less knows more, for instance
/// which points a mesh connects.
pub(crate) fn least_radii(points: &PointSet) -> Vec<f32> {
    let natural = natural_radii(&points.positions, &points.unit_normals());
    let mut least: Vec<f32> =
        natural.iter().zip(&points.radii).map(|(natural, given)| natural.min(*given)).collect();
    for Raised { point, radius } in raised(points) {
        least[point as usize] = radius;
    }
    least
}

fn median(values: &[f32]) -> Option<f32> {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f32::total_cmp).1)
}
