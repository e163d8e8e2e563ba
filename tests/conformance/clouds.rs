//! The clouds that conformance is shown on.

use std::path::{Path, PathBuf};
use surfine::{Neighborhood, PointSet, RefineParams, Rules, Vec3};
use surfine_points::ply;
use surfine_points::shapes::{Sampling, Shape, icosphere, sample, square_grid};

/// A named cloud.
pub(crate) struct Cloud {
    pub name: String,
    pub points: PointSet,
}

impl Cloud {
    fn new(name: &str, points: PointSet) -> Self {
        Self { name: name.into(), points }
    }
}

/// Small clouds for single kernels: even, random and regular, closed and open.
pub(crate) fn small() -> Vec<Cloud> {
    vec![
        Cloud::new("sphere", sample(Shape::Sphere, Sampling::BlueNoise, 300, 1)),
        Cloud::new("random torus", sample(Shape::Torus, Sampling::Random, 500, 2)),
        Cloud::new("saddle", sample(Shape::Saddle, Sampling::Random, 200, 3)),
        Cloud::new("icosphere", icosphere(2)),
        Cloud::new("square grid", square_grid(9)),
        Cloud::new(
            "crowded sphere",
            scaled_radii(sample(Shape::Sphere, Sampling::Random, 300, 4), 2.0),
        ),
    ]
}

/// Clouds for whole runs, with the number of levels.
pub(crate) fn whole() -> Vec<(Cloud, u32)> {
    let mut clouds = vec![
        (Cloud::new("sphere", sample(Shape::Sphere, Sampling::BlueNoise, 1000, 1)), 3),
        (Cloud::new("random torus", sample(Shape::Torus, Sampling::Random, 1000, 2)), 3),
        (Cloud::new("icosphere", icosphere(3)), 3),
        (Cloud::new("square grid", square_grid(20)), 3),
        (Cloud::new("two scales", two_scales()), 3),
        (
            Cloud::new(
                "crowded ellipsoid",
                scaled_radii(sample(Shape::Ellipsoid, Sampling::Random, 500, 5), 1.7),
            ),
            3,
        ),
    ];
    for (file, levels) in
        [("igea-600-uniform", 4), ("nefertiti-3500-random", 3), ("armadillo-10000-uniform", 3)]
    {
        let path = shared_data().join(format!("points/{file}.ply"));
        if path.exists() {
            let (points, _) = ply::read(&path).expect("the shared file is sound");
            clouds.push((Cloud::new(file, points), levels));
        } else {
            println!("{file} is not there: the generated clouds stand alone");
        }
    }
    clouds
}

/// Accurate, fuzzy, simplified, and the paper's text.
pub(crate) fn variants() -> [RefineParams; 4] {
    let accurate = RefineParams::default();
    let fuzzy = RefineParams { neighborhood: Neighborhood::Fuzzy, ..accurate.clone() };
    let simplified = RefineParams { simplified: true, ..accurate.clone() };
    let literal = RefineParams { rules: Rules::LITERAL, ..accurate.clone() };
    [accurate, fuzzy, simplified, literal]
}

/// What tells a variant from the others.
pub(crate) fn describe(params: &RefineParams) -> String {
    let RefineParams { neighborhood, simplified, rules, .. } = params;
    let rules = if *rules == Rules::LITERAL { "literal" } else { "all rules" };
    format!("{neighborhood:?}, simplified {simplified}, {rules}")
}

/// Models that are too large or too unfree for the repository, where they are at hand.
fn shared_data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data")
}

fn scaled_radii(mut points: PointSet, factor: f32) -> PointSet {
    points.radii.iter_mut().for_each(|r| *r *= factor);
    points
}

/// A small dense sphere beside a large coarse one: cells that fit neither.
fn two_scales() -> PointSet {
    let mut points = sample(Shape::Sphere, Sampling::Random, 300, 6);
    let small = sample(Shape::Sphere, Sampling::BlueNoise, 400, 7);
    let place = |x: &Vec3| *x * 0.4 + Vec3::new(2.0, 0.0, 0.0);
    points.positions.extend(small.positions.iter().map(place));
    points.normals.extend(&small.normals);
    points.radii.extend(small.radii.iter().map(|r| r * 0.4));
    points
}
