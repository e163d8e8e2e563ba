//! Clouds of a few points, with values worked out by hand.

use approx::assert_relative_eq;
use surfine_evaluate::TruthKind;
use surfine_points::DVec3;
use surfine_points::shapes::{Sampling, Shape};

use crate::scenes;

fn on_a_line(coordinates: &[f64]) -> Vec<DVec3> {
    coordinates.iter().map(|&x| DVec3::new(x, 0.0, 0.0)).collect()
}

#[test]
fn two_points_against_three() {
    let output = scenes::cloud(on_a_line(&[0.0, 4.0]));
    let corner = |x, y| DVec3::new(x, y, 0.0);
    let truth = scenes::cloud(vec![corner(0.0, 1.0), corner(4.0, 1.0), corner(4.0, 3.0)]);
    let found = scenes::measure(&output, &scenes::truth(&truth));

    assert_eq!(found.truth.kind, TruthKind::Points);
    assert_relative_eq!(found.truth.diagonal, 20f64.sqrt(), max_relative = 1e-15);
    assert_eq!(found.output.spacing, 4.0);
    let distance = found.distance;
    assert_eq!((distance.absolute.mean, distance.absolute.max), (1.0, 1.0));
    assert_eq!(distance.in_spacings.rms, 0.25);
    assert_relative_eq!(distance.in_diagonals.p95, 1.0 / 20f64.sqrt(), max_relative = 1e-15);
    // The three are 1, 1 and 3 away from points whose spacing is 4.
    assert_eq!((found.coverage.samples, found.coverage.max_distance), (3, 3.0));
    assert_eq!((found.coverage.max, found.coverage.over_1), (0.75, 0.0));

    // Both points are 1 away from the three, which are 1, 1 and 3 away from the two.
    assert_relative_eq!(found.chamfer.plain.chamfer, 1.0 + 5.0 / 3.0, max_relative = 1e-15);
    assert_eq!(found.chamfer.plain.hausdorff, 3.0);
    // The two become (-1, 0) and (1, 0); the three (-8, -2), (4, -2) and (4, 4), all divided by the root of 68.
    let k = 1.0 / 68f64.sqrt();
    let (left, low, high) = (2.0 - 16.0 * k, 88.0 / 68.0 - 8.0 * k, 100.0 / 68.0 - 8.0 * k);
    let chamfer = (left + low) / 2.0 + (left + low + high) / 3.0;
    assert_relative_eq!(found.chamfer.pu.chamfer, chamfer, max_relative = 1e-12);
    assert_relative_eq!(found.chamfer.pu.hausdorff, low + high, max_relative = 1e-12);
}

#[test]
fn the_pu_convention_sees_neither_size_nor_place() {
    let truth = scenes::cloud(on_a_line(&[0.0, 1.0, 3.0]));
    let output = scenes::cloud(truth.positions.iter().map(|&p| 5.0 * p + 2.0).collect());
    let found = scenes::measure(&output, &scenes::truth(&truth)).chamfer;
    assert!(found.pu.chamfer < 1e-30 && found.pu.hausdorff < 1e-30, "{found:?}");
    assert!(found.plain.hausdorff > 10.0);
}

#[test]
fn three_points_on_a_line() {
    let truth = scenes::truth(&scenes::cloud(on_a_line(&[0.0, 1.0])));
    let found = scenes::measure(&scenes::cloud(on_a_line(&[0.0, 1.0, 3.0])), &truth);
    // Nearest neighbours are 1, 1 and 2 away: mean 4/3, variance 2/9.
    assert_relative_eq!(found.uniformity.nn_cv, 2f64.sqrt() / 4.0, max_relative = 1e-14);
    // Mean distances to the two others: 2, 1.5 and 2.5.
    assert_eq!(found.output.spacing, 2.0);
}

#[test]
fn a_position_of_several_points_counts_once_for_spacing_and_uniformity() {
    let truth = scenes::truth(&scenes::cloud(on_a_line(&[0.0, 1.0])));
    // A zero of the other sign is the same place.
    let doubled = scenes::cloud(on_a_line(&[0.0, 1.0, -0.0, 3.0, 1.0, 1.0]));
    let found = scenes::measure(&doubled, &truth);
    assert_eq!((found.output.points, found.output.positions), (6, 3));
    assert_eq!(found.output.spacing, 2.0);
    assert_relative_eq!(found.uniformity.nn_cv, 2f64.sqrt() / 4.0, max_relative = 1e-14);
    // But the mean over points counts them all: 2 is the only distance.
    assert_relative_eq!(found.distance.absolute.mean, 2.0 / 6.0, max_relative = 1e-14);
}

#[test]
fn the_spacing_is_that_of_six_neighbours() {
    let output = scenes::cloud(on_a_line(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]));
    let truth = scenes::truth(&scenes::cloud(on_a_line(&[-7.0, 7.0])));
    let found = scenes::measure(&output, &truth);
    // The first point's six nearest others are 3.5 away in the mean, and 7 is twice that.
    assert_relative_eq!(found.coverage.max, 2.0, max_relative = 1e-14);
    assert_eq!((found.coverage.over_1, found.coverage.over_2), (0.5, 0.0));
    // 21/6, 16/6, 13/6, 12/6 and back.
    assert_relative_eq!(found.output.spacing, 62.0 / 24.0, max_relative = 1e-14);
}

#[test]
fn blue_noise_is_more_even_than_random_points() {
    let truth = scenes::truth(&scenes::torus(100, 50));
    let measure = |sampling| {
        let output = scenes::points(Shape::Torus, sampling, 2000, 5);
        scenes::measure(&output, &truth).uniformity
    };
    let (even, random) = (measure(Sampling::BlueNoise), measure(Sampling::Random));
    assert!(even.nn_cv < 0.1, "{}", even.nn_cv); // 0.060
    assert!((0.48..0.56).contains(&random.nn_cv), "{}", random.nn_cv); // 0.52 in the plane
    let (even, random) = (even.discs.expect("a mesh"), random.discs.expect("a mesh"));
    assert_eq!(even.len(), 5);
    for (even, random) in even.into_iter().zip(random) {
        let (even, random) = (even.value.expect("discs count"), random.value.expect("discs count"));
        assert!(20.0 * even < random, "{even} and {random}"); // 1 to 60 at least
    }
}
