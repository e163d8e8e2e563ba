//! Planted defects: each is seen by its own measure, and the others stay where they were.

use surfine_evaluate::{Evaluation, Truth};
use surfine_points::shapes::{Sampling, Shape};
use surfine_points::{DVec3, Model};

use crate::scenes;

/// Around a point of the outside of the torus.
const CENTER: DVec3 = DVec3::new(1.4, 0.0, 0.0);

struct Scene {
    truth: Truth,
    clean: Model,
    before: Evaluation,
    spacing: f64,
}

/// 3000 even points, 0.005 of their spacing off the mesh at most.
fn scene() -> Scene {
    let truth = scenes::truth(&scenes::torus(200, 100));
    let clean = scenes::points(Shape::Torus, Sampling::BlueNoise, 3000, 1);
    let before = scenes::measure(&clean, &truth);
    let spacing = before.output.spacing;
    Scene { truth, clean, before, spacing }
}

/// Which measures have left the range that blue noise on the torus keeps.
fn seen(found: &Evaluation) -> Vec<&'static str> {
    let normals = found.normals.expect("there are normals").all;
    let smoothness = found.smoothness.expect("there are normals");
    let rough = smoothness.output.max / smoothness.truth.expect("a mesh").max;
    let measures = [
        ("distance", found.distance.in_spacings.max > 0.01),
        ("coverage", found.coverage.max > 1.2),
        ("normals", normals.max > 1.0),
        ("smoothness", rough > 1.1),
        ("nnCV", found.uniformity.nn_cv > 0.2),
    ];
    measures.into_iter().filter(|m| m.1).map(|m| m.0).collect()
}

/// Each point moved along its normal by a share of the spacing that is 0 in the mean, with this deviation.
fn noisy(scene: &Scene, deviation: f64) -> Model {
    let mut random = fastrand::Rng::with_seed(1);
    // A sum of twelve is normal enough, and ends at six deviations.
    let mut normal = || (0..12).map(|_| random.f64() - 0.5).sum::<f64>();
    let mut model = scene.clean.clone();
    for (position, direction) in model.positions.iter_mut().zip(model.normals.iter().flatten()) {
        *position += direction.as_dvec3() * (deviation * scene.spacing * normal());
    }
    model
}

#[test]
fn nothing_is_seen_where_nothing_is_planted() {
    let before = scene().before;
    assert!(seen(&before).is_empty(), "{before}");
    assert_eq!((before.coverage.over_1, before.coverage.over_2), (0.0, 0.0));
}

#[test]
fn a_hole_is_seen_by_the_coverage_alone() {
    let scene = scene();
    // Three spacings across. Nothing of the torus was farther than 0.90 from a point before.
    let small = scenes::keep(&scene.clean, |p| p.distance(CENTER) > 1.5 * scene.spacing);
    let small = scenes::measure(&small, &scene.truth);
    assert_eq!(seen(&small), ["coverage"], "{small}");
    assert!(small.coverage.over_1 > 0.0 && small.coverage.over_2 == 0.0, "{small}");
    // Three spacings from the middle to the rim: 2.46, for points beside a hole have a larger spacing of their own.
    let hole = scenes::keep(&scene.clean, |p| p.distance(CENTER) > 3.0 * scene.spacing);
    let hole = scenes::measure(&hole, &scene.truth);
    assert_eq!(seen(&hole), ["coverage"], "{hole}");
    assert!((2.3..3.1).contains(&hole.coverage.max), "{hole}");
    assert!(hole.coverage.over_2 > 0.0 && hole.coverage.p999 > 1.5, "{hole}");

    // What is left is what was there before.
    let before = scene.before;
    assert!(hole.distance.absolute.max <= before.distance.absolute.max);
    let ratio = |a: f64, b: f64| (a / b - 1.0).abs();
    assert!(ratio(hole.distance.absolute.mean, before.distance.absolute.mean) < 0.02);
    let (now, then) = (hole.normals.unwrap().all, before.normals.unwrap().all);
    assert!(now.max <= then.max && ratio(now.mean, then.mean) < 0.02);
    assert!(ratio(hole.uniformity.nn_cv, before.uniformity.nn_cv) < 0.05);
}

#[test]
fn a_flipped_patch_is_seen_by_the_measures_of_normals_alone() {
    let scene = scene();
    let mut flipped = scene.clean.clone();
    let mut count = 0;
    for (position, normal) in flipped.positions.iter().zip(flipped.normals.iter_mut().flatten()) {
        if position.distance(CENTER) < 3.0 * scene.spacing {
            *normal = -*normal;
            count += 1;
        }
    }
    assert!((20..60).contains(&count), "{count} points are in the patch");
    let found = scenes::measure(&flipped, &scene.truth);
    // The smoothness sees its rim, where normals disagree with their neighbours'.
    assert_eq!(seen(&found), ["normals", "smoothness"], "{found}");
    let normals = found.normals.unwrap().all;
    assert_eq!(normals.over_90, f64::from(count) / 3000.0);
    assert_eq!(normals.over_30, normals.over_90);
    // Nothing else changes by a bit.
    let before = scene.before;
    assert_eq!(found.distance, before.distance);
    assert_eq!(found.coverage, before.coverage);
    assert_eq!(found.uniformity, before.uniformity);
    assert_eq!(found.chamfer, before.chamfer);
    assert_eq!(found.smoothness.unwrap().truth, before.smoothness.unwrap().truth);
}

#[test]
fn noise_of_half_a_spacing_is_seen_by_the_distance_alone() {
    let scene = scene();
    let found = scenes::measure(&noisy(&scene, 0.5), &scene.truth);
    assert_eq!(seen(&found), ["distance"], "{found}");
    // In units of the spacing before; noise itself moves points apart.
    let rms = found.distance.absolute.rms / scene.spacing;
    assert!((0.47..0.53).contains(&rms), "{rms}"); // 0.496
    let mean = found.distance.absolute.mean / scene.spacing;
    assert!((0.37..0.43).contains(&mean), "{mean}"); // 0.398, a normal distribution's 0.8 of that
    // The largest gap grows from 0.90 to 1.05 spacings, nnCV from 0.060 to 0.139, the largest normal error to 0.54°.
    assert_eq!(found.coverage.over_2, 0.0);
    assert!(found.coverage.max < 1.2 && found.normals.unwrap().all.max < 1.0, "{found}");
}

#[test]
fn a_tenth_of_that_noise_is_seen_in_its_proportion() {
    let scene = scene();
    let found = scenes::measure(&noisy(&scene, 0.05), &scene.truth);
    assert_eq!(seen(&found), ["distance"], "{found}");
    let rms = found.distance.absolute.rms / scene.spacing;
    assert!((0.047..0.053).contains(&rms), "{rms}");
}

#[test]
fn clusters_are_seen_by_the_uniformity() {
    let scene = scene();
    let random = scenes::points(Shape::Torus, Sampling::Random, 3000, 1);
    let found = scenes::measure(&random, &scene.truth);
    // Random points leave gaps too.
    assert_eq!(seen(&found), ["coverage", "nnCV"], "{found}");
}

#[test]
fn gaps_along_the_surface_leave_out_how_far_a_dense_output_lies_beside_it() {
    let scene = scene();
    let mut lifted = scene.clean.clone();
    for (position, normal) in lifted.positions.iter_mut().zip(scene.clean.normals.iter().flatten())
    {
        *position += normal.as_dvec3() * scene.spacing;
    }
    let lifted = scenes::measure(&lifted, &scene.truth);
    let along = lifted.coverage.along.expect("the truth has normals");
    assert!(lifted.coverage.over_1 > 0.3, "{lifted}");
    assert!(along.max < 1.0 && along.over_1 == 0.0, "{lifted}");
    // Where nothing is lifted both say the same but for the curvature.
    let (straight, along) = (scene.before.coverage.max, scene.before.coverage.along.unwrap().max);
    assert!((along / straight - 1.0).abs() < 0.02, "{straight} {along}");
}

#[test]
fn gaps_along_the_surface_show_a_hole_above_another_sheet() {
    // Two faces of a plate, half a spacing thick: points of the lower one lie under the hole in the upper one.
    let spacing = 0.1;
    let side = |z: f64, up: bool| {
        let mut face = scenes::grid(20, 20, |u, v| DVec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, z));
        if !up {
            face.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        }
        face
    };
    let (mut plate, lower) = (side(0.5 * spacing, true), side(0.0, false));
    let first = plate.len() as u32;
    plate.positions.extend(&lower.positions);
    plate.triangles.extend(lower.triangles.iter().map(|t| t.map(|corner| corner + first)));
    let truth = scenes::truth(&plate);
    let holed = |radius: f64| {
        let kept = plate.positions.iter().copied();
        let kept = kept.filter(|p| p.z == 0.0 || p.truncate().length() >= radius * spacing);
        scenes::measure(&scenes::cloud(kept.collect()), &truth)
    };
    let (whole, hole) = (holed(0.0), holed(3.0));
    assert!(whole.coverage.along.unwrap().max < 1.1, "{whole}");
    assert!(hole.coverage.max < 1.1, "the lower face hides the hole from the straight measure");
    assert!(hole.coverage.along.unwrap().max > 2.0, "{hole}");
}
