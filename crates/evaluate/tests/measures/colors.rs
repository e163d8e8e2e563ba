//! Colours.

use approx::assert_relative_eq;
use surfine_evaluate::{Options, evaluate};
use surfine_points::shapes::{Sampling, Shape};
use surfine_points::{Attribute, DVec3, Values};

use crate::scenes;

/// Linear over the square, so that interpolation in a mesh is exact: red from 0 to 200 along x.
fn red(p: DVec3) -> [u8; 3] {
    [(100.0 * (p.x + 1.0)).round() as u8, 40, 0]
}

#[test]
fn a_mesh_interpolates_between_its_corners() {
    let mut mesh = scenes::square();
    scenes::paint(&mut mesh, red);
    let truth = scenes::truth(&mesh);
    let found = truth.nearest(DVec3::new(0.5, -0.25, 3.0), None).color.expect("it has colours");
    for (found, expected) in found.into_iter().zip([150.0, 40.0, 0.0]) {
        assert_relative_eq!(found, expected, epsilon = 1e-10);
    }
    let mut output = scenes::points(Shape::Plane, Sampling::Random, 500, 1);
    scenes::paint(&mut output, red);
    let colors = scenes::measure(&output, &truth).colors.expect("both have colours");
    // Rounding to 8 bits: half a step at most in one channel of three.
    assert!(colors.max <= 0.5 && colors.mean > 0.05, "{colors:?}");
    assert_eq!(colors.nearest_input_rms, None);
}

#[test]
fn differences_are_those_by_hand() {
    let place = |x: f64| DVec3::new(x, 0.0, 0.0);
    let mut truth = scenes::cloud(vec![place(0.0), place(1.0)]);
    scenes::paint(&mut truth, |p| if p.x > 0.5 { [200, 100, 0] } else { [10, 20, 30] });
    let mut output = scenes::cloud(vec![place(0.1), place(0.8)]);
    scenes::paint(&mut output, |p| if p.x > 0.5 { [197, 100, 6] } else { [10, 20, 30] });
    let colors = scenes::measure(&output, &scenes::truth(&truth)).colors.unwrap();
    // 0 0 0 and 3 0 6.
    assert_eq!((colors.mean, colors.max), (1.5, 6.0));
    assert_relative_eq!(colors.rms, 7.5f64.sqrt(), max_relative = 1e-14);
}

#[test]
fn the_nearest_point_of_the_input_is_what_there_is_to_beat() {
    let mut truth = scenes::square();
    scenes::paint(&mut truth, red);
    let mut input = scenes::points(Shape::Plane, Sampling::BlueNoise, 60, 1);
    scenes::paint(&mut input, red);
    let mut output = scenes::points(Shape::Plane, Sampling::BlueNoise, 500, 2);
    scenes::paint(&mut output, red);
    let (truth, options) = (scenes::truth(&truth), Options::default());
    let found = evaluate(&output, &truth, Some(&input), &options, &mut |_| ()).expect("fit");
    let colors = found.colors.unwrap();
    let brute: f64 = output
        .positions
        .iter()
        .map(|x| {
            let nearest =
                input.positions.iter().min_by(|a, b| a.distance(*x).total_cmp(&b.distance(*x)));
            (f64::from(red(*nearest.unwrap())[0]) - 100.0 * (x.x + 1.0)).powi(2)
        })
        .sum();
    let expected = (brute / 1500.0).sqrt();
    assert_relative_eq!(colors.nearest_input_rms.unwrap(), expected, max_relative = 1e-6);
    assert!(10.0 * colors.rms < expected, "{colors:?}");
}

#[test]
fn without_colours_on_both_sides_there_is_no_difference() {
    let mut painted = scenes::points(Shape::Plane, Sampling::Random, 50, 1);
    scenes::paint(&mut painted, red);
    let plain = scenes::points(Shape::Plane, Sampling::Random, 50, 2);
    assert_eq!(scenes::measure(&plain, &scenes::truth(&painted)).colors, None);
    assert_eq!(scenes::measure(&painted, &scenes::truth(&plain)).colors, None);
    // Two channels are no colour.
    let mut two = plain;
    for name in ["red", "green"] {
        two.attributes.push(Attribute::new(name, Values::U8(vec![7; 50])));
    }
    assert_eq!(scenes::measure(&two, &scenes::truth(&painted)).colors, None);
}
