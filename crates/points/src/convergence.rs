//! How far a level has converged: its radii and its co-cone angles (section 8.1 of the paper).

use crate::{Grid, GridShape, Refined};
use glam::Vec3;
use rayon::prelude::*;

/// Pairs of points whose normals differ by more than 150° lie on two sheets.
const OPPOSITE: f64 = -0.866_025_403_784_438_6;

/// What section 8.1 says falls to zero from level to level.
///
/// The co-cone of a point is what a double cone around its normal leaves free. Its angle is the largest elevation of a
/// neighbour over the tangent plane, `max asin |n·u|`, u the unit vector to the neighbour: 0 where all of them lie in
/// the plane, 90° where one lies along the normal.
///
/// Neighbours are all points within the radius, not the one-ring alone: they hold it, so the angle of the one-ring is no
/// larger. As in the refinement, pairs that eq. 6 rejects and pairs of opposite normals (more than 150° apart) are on
/// different sheets, and coincident points have no direction: none of them counts. Across a sharp edge eq. 6 lets points
/// through, so there the angle stays large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// Points of the level.
    pub points: usize,
    /// Radii, in the unit of the positions.
    pub radius: Spread,
    /// Co-cone angles of the points that have neighbours, in degrees.
    pub angle: Spread,
    /// Points without a neighbour, which have no co-cone.
    pub alone: usize,
}

/// Middle and largest of some values; zeros where there are none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The value in the middle, of an even number the upper one.
    pub median: f64,
    /// Sum over number.
    pub mean: f64,
    /// The largest.
    pub max: f64,
}

impl Convergence {
    /// Measures one level; normals have unit length. The result does not depend on the number of threads.
    ///
    /// # Panics
    /// The lengths differ.
    pub fn of(positions: &[Vec3], normals: &[Vec3], radii: &[f32]) -> Self {
        assert_eq!((positions.len(), normals.len()), (radii.len(), radii.len()), "lengths differ");
        let shape = GridShape::fit(positions, radii);
        let grid = Grid::build(shape, (0..).zip(positions.iter().copied()));
        let sines: Vec<Option<f64>> = (0..positions.len())
            .into_par_iter()
            .map(|p| largest_sine(positions, normals, radii[p], &grid, p))
            .collect();
        let angles: Vec<f64> = sines.iter().flatten().map(|s| s.asin().to_degrees()).collect();
        Self {
            points: positions.len(),
            radius: Spread::of(radii.iter().map(|&r| f64::from(r)).collect()),
            alone: positions.len() - angles.len(),
            angle: Spread::of(angles),
        }
    }

    /// Measures every level of a refinement that kept its radii (`RefineParams::keep_radii`); else there is none.
    pub fn by_level(refined: &Refined) -> Vec<Self> {
        let normals = refined.points.unit_normals();
        // Points are appended and never moved: a level is a prefix.
        let level = |radii: &Vec<f32>| {
            let n = radii.len();
            Self::of(&refined.points.positions[..n], &normals[..n], radii)
        };
        refined.level_radii.iter().map(level).collect()
    }
}

impl Spread {
    fn of(mut values: Vec<f64>) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let max = values.iter().copied().fold(f64::MIN, f64::max);
        let middle = values.len() / 2;
        let (_, &mut median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
        Self { median, mean, max }
    }
}

/// Sine of the co-cone angle of a point; `None` if it has no neighbour.
fn largest_sine(
    positions: &[Vec3],
    normals: &[Vec3],
    radius: f32,
    grid: &Grid,
    p: usize,
) -> Option<f64> {
    let (center, normal) = (positions[p], normals[p].as_dvec3());
    let r2 = f64::from(radius) * f64::from(radius);
    let mut largest: Option<f64> = None;
    grid.visit_ball(center, radius, |id, _| {
        let d = (positions[id as usize] - center).as_dvec3();
        let d2 = d.length_squared();
        // Nearer than 1e-6 of the radius counts as being in one place.
        if id as usize == p || d2 > r2 || d2 <= 1e-12 * r2 {
            return;
        }
        let u = d / d2.sqrt();
        let other = normals[id as usize].as_dvec3();
        let cosine = normal.dot(other);
        // Eq. 6, which is printed inverted; the margin is for flat surfaces, where both sides are rounding.
        let consistent = (normal + other).dot(u).abs() <= 1.0 + cosine + 1e-6;
        if cosine >= OPPOSITE && consistent {
            let sine = normal.dot(u).abs().min(1.0);
            largest = Some(largest.map_or(sine, |l| l.max(sine)));
        }
    });
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measure(rows: &[(Vec3, Vec3, f32)]) -> Convergence {
        let (mut positions, mut normals, mut radii) = (Vec::new(), Vec::new(), Vec::new());
        for &(position, normal, radius) in rows {
            positions.push(position);
            normals.push(normal);
            radii.push(radius);
        }
        Convergence::of(&positions, &normals, &radii)
    }

    #[test]
    fn angles_are_elevations_over_the_tangent_plane() {
        let lifted = 30f32.to_radians().tan();
        let rows = [
            (Vec3::ZERO, Vec3::Z, 2.0),
            (Vec3::new(1.0, 0.0, lifted), Vec3::Z, 2.0),
            (Vec3::new(0.0, -1.0, 0.0), Vec3::Z, 0.5),
        ];
        let found = measure(&rows);
        // The third point sees nobody within its radius. A neighbour below the plane counts like one above.
        assert_eq!((found.points, found.alone), (3, 1));
        assert!((found.angle.max - 30.0).abs() < 1e-4, "{found:?}");
        assert!((found.angle.mean - 30.0).abs() < 1e-4, "{found:?}");
        assert_eq!(found.radius, Spread { median: 2.0, mean: 1.5, max: 2.0 });
    }

    #[test]
    fn other_sheets_and_points_in_one_place_do_not_count() {
        let beside = (Vec3::X, Vec3::Z, 2.0);
        for other in [
            // The other face of a thin plate, obliquely below.
            (Vec3::new(0.5, 0.0, -0.5), Vec3::NEG_Z, 1e-3),
            // Along the sum of the normals: the axis of the cone of eq. 6.
            (Vec3::new(0.2, 0.0, 0.6), Vec3::new(0.6, 0.0, 0.8), 1e-3),
            // Another record of the same place.
            (Vec3::ZERO, Vec3::X, 1e-3),
        ] {
            let found = measure(&[(Vec3::ZERO, Vec3::Z, 2.0), (beside.0, Vec3::Z, 1e-3), other]);
            assert_eq!((found.alone, found.angle.max), (2, 0.0), "{other:?}: {found:?}");
        }
    }

    #[test]
    fn nothing_gives_zeros() {
        let none = measure(&[]);
        assert_eq!((none.points, none.alone), (0, 0));
        assert_eq!((none.radius, none.angle), (Spread::default(), Spread::default()));
    }
}
