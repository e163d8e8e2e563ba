//! Whether the input is still there.

use surfine_evaluate::{Options, Survival, evaluate};
use surfine_points::shapes::{Sampling, Shape};
use surfine_points::{Attribute, DVec3, Model, Values, Vec3};

use crate::scenes;

/// A cloud with attributes, and an output that goes on with other points.
fn pair() -> (Model, Model) {
    let with_attributes = |n, seed| {
        let mut model = scenes::points(Shape::Sphere, Sampling::Random, n, seed);
        model.attributes.push(Attribute::new("id", Values::I32((0..n as i32).collect())));
        model.attributes.push(Attribute::new("heat", Values::F32(vec![0.5; n])));
        model
    };
    let (input, mut output) = (with_attributes(50, 1), with_attributes(120, 2));
    output.positions[..50].copy_from_slice(&input.positions);
    output.normals.as_mut().unwrap()[..50].copy_from_slice(input.normals.as_ref().unwrap());
    (input, output)
}

fn survival(input: &Model, output: &Model) -> Survival {
    let truth = scenes::truth(&scenes::points(Shape::Sphere, Sampling::Random, 100, 3));
    let options = Options::default();
    let found = evaluate(output, &truth, Some(input), &options, &mut |_| ()).expect("fit");
    found.survival.expect("there is an input")
}

#[track_caller]
fn assert_changed(input: &Model, output: &Model, index: usize, found_anywhere: usize) {
    let found = survival(input, output);
    assert_eq!(found.kept, 49, "{found:?}");
    assert_eq!(found.first_changed, Some(index));
    assert_eq!(found.found_anywhere, Some(found_anywhere));
}

#[test]
fn an_input_that_leads_the_output_has_survived() {
    let (input, mut output) = pair();
    // Radii may change.
    output.radii.as_mut().unwrap()[0] *= 2.0;
    let found = survival(&input, &output);
    assert_eq!((found.input_points, found.kept), (50, 50));
    assert_eq!((found.first_changed, found.found_anywhere), (None, None));
    assert!(found.missing.is_empty());
}

#[test]
fn one_bit_of_a_coordinate_is_found() {
    let (input, mut output) = pair();
    output.positions[31].y = f64::from_bits(output.positions[31].y.to_bits() ^ 1);
    assert_changed(&input, &output, 31, 49);
}

#[test]
fn a_zero_of_the_other_sign_is_found() {
    let (mut input, mut output) = pair();
    (input.positions[7].z, output.positions[7].z) = (0.0, -0.0);
    assert_changed(&input, &output, 7, 49);
    output.positions[7].z = 0.0;
    let (ours, theirs) = (input.normals.as_mut().unwrap(), output.normals.as_mut().unwrap());
    (ours[9], theirs[9]) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, -0.0, 1.0));
    assert_changed(&input, &output, 9, 50);
}

#[test]
fn changed_attributes_are_found() {
    let (input, output) = pair();
    let mut changed = output.clone();
    changed.attributes[0].values = Values::I32((0..120).map(|i| i + i32::from(i == 4)).collect());
    assert_changed(&input, &changed, 4, 50);
    let mut changed = output;
    let heat = |i: i32| f32::from_bits(0.5f32.to_bits() + u32::from(i == 12));
    changed.attributes[1].values = Values::F32((0..120).map(heat).collect());
    assert_changed(&input, &changed, 12, 50);
}

#[test]
fn an_attribute_of_zero_with_another_sign_is_found() {
    let (mut input, mut output) = pair();
    input.attributes[1].values = Values::F32(vec![0.0; 50]);
    let heat = |i: i32| if i == 20 { -0.0 } else { 0.0 };
    output.attributes[1].values = Values::F32((0..120).map(heat).collect());
    assert_changed(&input, &output, 20, 50);
    input.attributes[1].values = Values::F64(vec![0.0; 50]);
    output.attributes[1].values = Values::F64((0..120).map(|i| heat(i).into()).collect());
    assert_changed(&input, &output, 20, 50);
}

#[test]
fn missing_properties_are_named_and_do_not_count() {
    let (input, mut output) = pair();
    output.normals = None;
    output.attributes[0].values = Values::U32((0..120).collect());
    output.attributes.remove(1);
    let found = survival(&input, &output);
    assert_eq!(found.kept, 50);
    assert_eq!(found.missing, ["nx", "ny", "nz", "id", "heat"]);
}

#[test]
fn points_in_another_order_are_found_but_not_kept() {
    let (input, mut output) = pair();
    output.positions.swap(3, 100);
    assert_changed(&input, &output, 3, 50);
}

#[test]
fn an_output_with_fewer_points_keeps_those_it_has() {
    let (input, output) = pair();
    let mut short = Model { positions: output.positions[..20].to_vec(), ..Model::default() };
    let found = survival(&input, &short);
    assert_eq!((found.kept, found.first_changed, found.found_anywhere), (20, Some(20), Some(20)));
    short.positions[0] = DVec3::splat(9.0);
    let found = survival(&input, &short);
    assert_eq!((found.kept, found.first_changed, found.found_anywhere), (19, Some(0), Some(19)));
}
