//! The clouds that conformance is shown on.

use glam::Vec2;
use std::f32::consts::TAU;
use std::path::Path;
use surfine::{Neighborhood, PointSet, RefineParams, Rules, Vec3};
use surfine_points::ply;
use surfine_points::shapes::{
    Outlined, Sampling, Shape, icosphere, one_record_a_normal, sample, sample_outlined, square_grid,
};

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

/// Small clouds for single kernels: even, random and regular, closed and open, and one with a long ring.
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
        Cloud::new("wheel", wheel()),
    ]
}

/// Clouds with creases, corners and boundaries for single kernels.
pub(crate) fn small_outlined() -> Vec<Cloud> {
    let cloud = |shape, sampling, seed| sample_outlined(shape, sampling, 160, seed);
    let (even, uneven) = (Sampling::BlueNoise, Sampling::Random);
    vec![
        Cloud::new("cube", cloud(Outlined::Cube, even, 1)),
        // Random points beside creases have so many of these in their balls that a software driver cuts its loops.
        Cloud::new("cylinder", one_record_a_normal(&cloud(Outlined::Cylinder, even, 2))),
        Cloud::new("saddle with rim", cloud(Outlined::SaddleRim, even, 3)),
        Cloud::new("hole", cloud(Outlined::Hole, uneven, 4)),
    ]
}

/// Clouds with creases, corners and boundaries for whole runs, with the number of levels.
pub(crate) fn whole_outlined() -> Vec<(Cloud, u32)> {
    let even = |shape, seed| sample_outlined(shape, Sampling::BlueNoise, 300, seed);
    let random = |shape, seed| sample_outlined(shape, Sampling::Random, 300, seed);
    vec![
        (Cloud::new("cube", even(Outlined::Cube, 1)), 4),
        (Cloud::new("records of a cube", one_record_a_normal(&even(Outlined::Cube, 2))), 2),
        (Cloud::new("cylinder", even(Outlined::Cylinder, 3)), 2),
        (Cloud::new("hemisphere", random(Outlined::Hemisphere, 4)), 2),
        (Cloud::new("saddle with rim", even(Outlined::SaddleRim, 5)), 2),
        (Cloud::new("hole", random(Outlined::Hole, 6)), 2),
    ]
}

/// Models with creases and boundaries, where they are at hand.
pub(crate) fn shared_outlined() -> Vec<Cloud> {
    let files = ["points/fandisk-3000-crease", "analytic/hemisphere-800-boundary"];
    files.into_iter().filter_map(shared).collect()
}

/// Small clouds, one or the other of which needs each rule.
pub(crate) fn demanding() -> [Cloud; 3] {
    let [mut spheres, other] =
        [4, 5].map(|seed| sample(Shape::Sphere, Sampling::Random, 150, seed));
    // They all but touch: sheets that face each other at all distances.
    spheres.positions.extend(other.positions.iter().map(|x| *x + Vec3::new(2.05, 0.0, 0.0)));
    spheres.normals.extend(&other.normals);
    spheres.radii.extend(&other.radii);
    let saddle = sample_outlined(Outlined::SaddleRim, Sampling::BlueNoise, 160, 3);
    // So coarse that neighbours are not surely on one side of a crease.
    let cylinder = sample_outlined(Outlined::Cylinder, Sampling::Random, 40, 17);
    [("near spheres", spheres), ("saddle with rim", saddle), ("coarse cylinder", cylinder)]
        .map(|(name, points)| Cloud::new(name, points))
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
        clouds.extend(shared(&format!("points/{file}")).map(|cloud| (cloud, levels)));
    }
    clouds
}

/// Accurate, fuzzy and simplified; the same with the paper's loop, and the paper's text.
pub(crate) fn variants() -> [RefineParams; 6] {
    let accurate = RefineParams::default();
    let fuzzy = RefineParams { neighborhood: Neighborhood::Fuzzy, ..accurate.clone() };
    let simplified = RefineParams { simplified: true, ..accurate.clone() };
    let rules = Rules { largest_first: false, ..Rules::ALL };
    let [paper_loop, simplified_loop] =
        [&accurate, &simplified].map(|params| RefineParams { rules, ..params.clone() });
    let literal = RefineParams { rules: Rules::LITERAL, ..accurate.clone() };
    [accurate, fuzzy, simplified, paper_loop, simplified_loop, literal]
}

/// What tells a variant from the others.
pub(crate) fn describe(params: &RefineParams) -> String {
    let RefineParams { neighborhood, simplified, rules, .. } = params;
    let rules = match *rules {
        Rules::ALL => "all rules".into(),
        Rules::LITERAL => "literal".into(),
        some => {
            let off = some.named().into_iter().filter(|(_, on)| !on).map(|(name, _)| name);
            format!("without {}", off.collect::<Vec<_>>().join(", "))
        }
    };
    format!("{neighborhood:?}, simplified {simplified}, {rules}")
}

/// A model that is too large or too unfree for the repository, where it is at hand.
fn shared(file: &str) -> Option<Cloud> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data");
    let path = folder.join(format!("{file}.ply"));
    if !path.exists() {
        println!("{file} is not there: the generated clouds stand alone");
        return None;
    }
    let (points, _) = ply::read(&path).expect("the shared file is sound");
    Some(Cloud::new(file, points))
}

/// A point amid so many on a circle that its ring is too long for private rows.
fn wheel() -> PointSet {
    const SPOKES: usize = 60;
    let around = |i: usize| Vec3::from((Vec2::from_angle(TAU * i as f32 / SPOKES as f32), 0.0));
    let positions: Vec<Vec3> = std::iter::once(Vec3::ZERO).chain((0..SPOKES).map(around)).collect();
    let (normals, radii) = (vec![Vec3::Z; SPOKES + 1], vec![1.25; SPOKES + 1]);
    PointSet::new(positions, normals, radii)
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
