//! Units and places of a cloud do not matter.

use surfine_points::shapes::{Shape, icosphere, square_grid};
use surfine_points::{PointSet, Refined, Vec3};

use crate::clouds::{blue_noise, levels, random, refine};
use crate::measure::{assert_same_bytes, growths, mean};

pub(crate) fn scaled(points: &PointSet, factor: f32) -> PointSet {
    let mut points = points.clone();
    points.positions.iter_mut().for_each(|p| *p *= factor);
    points.radii.iter_mut().for_each(|r| *r *= factor);
    points
}

fn moved(points: &PointSet, offset: Vec3) -> PointSet {
    let mut points = points.clone();
    points.positions.iter_mut().for_each(|p| *p += offset);
    points
}

#[test]
fn powers_of_two_scale_every_byte() {
    let clouds = [random(Shape::Torus, 300, 1), blue_noise(Shape::Sphere, 300, 1), square_grid(12)];
    for cloud in clouds {
        let plain = refine(&cloud, &levels(3));
        for exponent in [-20, -3, 1, 20] {
            let factor = 2f32.powi(exponent);
            let mut refined = refine(&scaled(&cloud, factor), &levels(3));
            refined.points = scaled(&refined.points, 1.0 / factor);
            assert_same_bytes(&plain, &refined, &format!("2^{exponent}"));
        }
    }
}

/// Fails unless both results have the same triangles and the second one's points are those of the first times `factor`.
#[track_caller]
fn assert_scaled(plain: &Refined, refined: &Refined, factor: f32, what: &str) {
    assert_eq!(plain.parents, refined.parents, "{what}: triangles");
    for (i, (&x, &y)) in plain.points.positions.iter().zip(&refined.points.positions).enumerate() {
        // Shapes have a size of about 1, so rounding is 1e-7; where an edge is nearly along a normal its projection
        // loses digits: measured up to 5e-6.
        let error = (y / factor - x).length();
        assert!(error < 1e-5, "{what}: position {i} is off by {error}");
        let ratio = refined.points.radii[i] / (factor * plain.points.radii[i]);
        // Measured up to 9e-6, for the same reason.
        assert!((ratio - 1.0).abs() < 3e-5, "{what}: radius {i} by {ratio}");
    }
}

#[test]
fn other_factors_keep_the_triangles() {
    // Rounding differs between units, so a comparison that ties to 1e-7 may fall the other way. On these clouds none
    // does; a lattice would tie everywhere.
    for shape in [Shape::Sphere, Shape::Torus, Shape::Ellipsoid] {
        for (kind, cloud) in
            [("even", blue_noise(shape, 300, 1)), ("random", random(shape, 300, 1))]
        {
            let plain = refine(&cloud, &levels(2));
            for factor in [1e-6, 1e6] {
                let refined = refine(&scaled(&cloud, factor), &levels(2));
                assert_scaled(&plain, &refined, factor, &format!("{kind} {shape} times {factor}"));
            }
        }
    }
}

#[test]
fn icospheres_stay_exact_in_any_unit() {
    for factor in [1e-6, 0.3, 7.0, 1e6] {
        let cloud = scaled(&icosphere(2), factor);
        // 10 * 4^2 + 2 points; each step adds as many points as there are triangles: 320, then 960.
        assert_eq!(refine(&cloud, &levels(2)).level_sizes, [162, 482, 1442], "times {factor}");
    }
}

#[test]
fn moved_clouds_refine_alike() {
    let cloud = blue_noise(Shape::Sphere, 500, 1);
    let plain = growths(&refine(&cloud, &levels(2)));
    for offset in [Vec3::new(3.0, -2.0, 1.0), Vec3::new(100.0, -250.0, 30.0)] {
        let refined = refine(&moved(&cloud, offset), &levels(2));
        for (found, expected) in growths(&refined).into_iter().zip(&plain) {
            // Coordinates of 250 are rounded to 1.5e-5, so some near-ties may fall the other way. None does here.
            let difference = (found - expected).abs();
            assert!(difference < 0.005, "{offset}: growth {found}, {expected} in place");
        }
        let new = refined.points.positions[500..].iter();
        let error = mean(new.map(|&x| f64::from(Shape::Sphere.distance(x - offset))));
        // Measured 1.89e-5 in all places: a rounding of 8e-6 hardly adds to it.
        assert!(error < 2.4e-5, "{offset}: mean distance from the sphere {error:e}");
    }
}

#[test]
fn exact_moves_keep_the_triangles_of_a_lattice_free_cloud() {
    // Coordinates in units of 2^-14 stay exact when 8 is added: only the new points' own rounding differs.
    let mut cloud = random(Shape::Torus, 300, 2);
    cloud.positions.iter_mut().for_each(|p| *p = (*p * 16384.0).round() / 16384.0);
    let offset = Vec3::new(8.0, -8.0, 4.0);
    let plain = refine(&cloud, &levels(1));
    let refined = refine(&moved(&cloud, offset), &levels(1));
    assert_eq!(plain.parents, refined.parents);
    for (&x, &y) in plain.points.positions.iter().zip(&refined.points.positions) {
        // f32 has a step of 1e-6 at 9.4.
        assert!((y - offset - x).abs().max_element() < 2e-6, "{x} moved to {y}");
    }
}
