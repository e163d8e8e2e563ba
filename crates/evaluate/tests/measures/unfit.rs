//! Models that can't be measured are turned away with a reason.

use surfine_evaluate::{Options, Truth, Unfit, errors, evaluate};
use surfine_points::shapes::{Sampling, Shape};
use surfine_points::{Attribute, DVec3, Model, Values};

use crate::scenes;

fn good() -> Model {
    scenes::points(Shape::Sphere, Sampling::Random, 30, 1)
}

fn as_output(output: &Model) -> Unfit {
    let options = Options::default();
    let found = evaluate(output, &scenes::truth(&good()), None, &options, &mut |_| ());
    found.expect_err("the output is not fit")
}

fn as_truth(truth: &Model) -> Unfit {
    Truth::new(truth).err().expect("the truth is not fit")
}

#[test]
fn models_without_points_are_turned_away() {
    let none = Model::default();
    assert_eq!(as_output(&none), Unfit::Empty { model: "output" });
    assert_eq!(as_truth(&none), Unfit::Empty { model: "truth" });
    let (truth, options) = (scenes::truth(&good()), Options::default());
    let found = evaluate(&good(), &truth, Some(&none), &options, &mut |_| ());
    assert_eq!(found, Err(Unfit::Empty { model: "input" }));
    assert_eq!(errors(&none, &truth), Err(Unfit::Empty { model: "output" }));
}

#[test]
fn one_place_has_no_spacing() {
    let same = scenes::cloud(vec![DVec3::ONE; 4]);
    assert_eq!(as_output(&same), Unfit::OnePlace { model: "output" });
    assert_eq!(as_truth(&same), Unfit::OnePlace { model: "truth" });
    // Distances alone need none.
    assert_eq!(errors(&same, &scenes::truth(&scenes::cube())), Ok(vec![0.0; 4]));
}

#[test]
fn lengths_that_underflow_are_named() {
    let mut tiny = good();
    tiny.positions.iter_mut().for_each(|p| *p *= 1e-200);
    let is = |found: Unfit, name: &str| {
        assert!(matches!(found, Unfit::TooSmall { model, .. } if model == name), "{found}");
    };
    is(as_output(&tiny), "output");
    is(as_truth(&tiny), "truth");
}

#[test]
fn coordinates_that_are_no_places_are_named() {
    for value in [f64::NAN, f64::INFINITY, 1e200] {
        let mut model = good();
        model.positions[17].y = value;
        let message = as_output(&model).to_string();
        assert!(message.contains("output's vertex 17") && message.contains("repair"), "{message}");
        assert!(matches!(as_truth(&model), Unfit::Coordinate { vertex: 17, .. }));
    }
}

#[test]
fn columns_of_another_length_are_named() {
    let mut model = good();
    model.normals.as_mut().unwrap().pop();
    let column = "normals".into();
    assert_eq!(as_output(&model), Unfit::Length { model: "output", column, found: 29, points: 30 });
    let mut model = good();
    model.attributes.push(Attribute::new("heat", Values::F32(vec![0.0; 31])));
    assert!(matches!(as_truth(&model), Unfit::Length { found: 31, .. }));
}

#[test]
fn meshes_must_have_their_corners_and_an_area() {
    let mut mesh = scenes::square();
    mesh.triangles[1][2] = 4;
    assert_eq!(
        as_truth(&mesh),
        Unfit::Corner { model: "truth", triangle: 1, vertex: 4, vertices: 4 }
    );
    mesh.triangles = vec![[0, 0, 1], [1, 1, 1]];
    assert_eq!(as_truth(&mesh), Unfit::NoArea { triangles: 2 });
}
