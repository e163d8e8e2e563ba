//! Meshes and clouds that several tests share.

use std::f64::consts::TAU;

use surfine_evaluate::{Evaluation, Options, Truth, evaluate};
use surfine_points::shapes::{Sampling, Shape, sample};
use surfine_points::{Attribute, DVec3, Model, Values, Vec3};

/// A mesh without normals.
pub(crate) fn mesh(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Model {
    Model { positions, triangles, ..Model::default() }
}

/// A cloud without normals.
pub(crate) fn cloud(positions: Vec<DVec3>) -> Model {
    mesh(positions, Vec::new())
}

/// A grid of quads, each two triangles, over `(column, row)` in 0 to 1; closed if the ends meet.
pub(crate) fn grid(columns: u32, rows: u32, at: impl Fn(f64, f64) -> DVec3) -> Model {
    let point = |i: u32| {
        let (column, row) = (i % (columns + 1), i / (columns + 1));
        at(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows))
    };
    let quad = |i: u32| {
        let a = i % columns + i / columns * (columns + 1);
        let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
        [[a, b, c], [a, c, d]]
    };
    let positions = (0..(columns + 1) * (rows + 1)).map(point).collect();
    mesh(positions, (0..columns * rows).flat_map(quad).collect())
}

/// The torus of [`Shape::Torus`], closed up to rounding: vertices of the seams differ in the last digits, or not at all.
pub(crate) fn torus(columns: u32, rows: u32) -> Model {
    let turn = |share: f64| if share == 1.0 { 0.0f64 } else { share * TAU };
    grid(columns, rows, |u, v| {
        let (around, across) = (turn(u), turn(v));
        let ring = 1.0 + 0.4 * across.cos();
        DVec3::new(ring * around.cos(), ring * around.sin(), 0.4 * across.sin())
    })
}

/// The square of [`Shape::Plane`] in two triangles.
pub(crate) fn square() -> Model {
    grid(1, 1, |u, v| DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0))
}

/// The cube from -1 to 1 with eight vertices, two triangles a side, outward.
pub(crate) fn cube() -> Model {
    let corner = |i: u32| {
        let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        DVec3::new(sign(0), sign(1), sign(2))
    };
    let sides =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    mesh((0..8).map(corner).collect(), triangles.collect())
}

/// Points on a shape with exact normals.
pub(crate) fn points(shape: Shape, sampling: Sampling, n: usize, seed: u64) -> Model {
    Model::from(&sample(shape, sampling, n, seed))
}

/// Adds colours that a function gives.
pub(crate) fn paint(model: &mut Model, color: impl Fn(DVec3) -> [u8; 3]) {
    for (channel, name) in ["red", "green", "blue"].into_iter().enumerate() {
        let values = model.positions.iter().map(|&p| color(p)[channel]).collect();
        model.attributes.push(Attribute::new(name, Values::U8(values)));
    }
}

/// The points for which the condition holds, with normals.
pub(crate) fn keep(model: &Model, holds: impl Fn(DVec3) -> bool) -> Model {
    let normals = model.normals.as_ref().expect("these points have normals");
    let both = model.positions.iter().zip(normals).filter(|(p, _)| holds(**p));
    let (positions, normals): (Vec<DVec3>, Vec<Vec3>) = both.map(|(&p, &n)| (p, n)).unzip();
    Model { normals: Some(normals), ..cloud(positions) }
}

/// A truth that is fit.
pub(crate) fn truth(model: &Model) -> Truth {
    Truth::new(model).expect("the truth is fit")
}

/// All measures with 100 000 samples or fewer, without an input.
pub(crate) fn measure(output: &Model, truth: &Truth) -> Evaluation {
    let options = Options { samples: 50_000, seed: 7 };
    evaluate(output, truth, None, &options, &mut |_| ()).expect("the output is fit")
}
