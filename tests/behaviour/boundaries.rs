//! Boundaries: the surface ends where its points end, and not before (section 6).

use std::f64::consts::{PI, TAU};

use surfine_points::shapes::{Outlined, Sampling, Shape, sample};
use surfine_points::{Boundary, CurveCounts, PointSet, RefineParams, Refined, Vec3};

use crate::clouds::{levels, refine, with_radii_times};
use crate::curves::{bytes, even, new_points, spacing, uneven};
use crate::measure::Nearest;

const POINTS: usize = 500;

/// An open surface, its area, and points all along its rim.
struct Open {
    shape: Outlined,
    area: f64,
    rim: Vec<Vec3>,
}

fn on_circle(radius: f64) -> Vec<Vec3> {
    let at = |k: u32| TAU * f64::from(k) / 2000.0;
    (0..2000)
        .map(|k| Vec3::new((radius * at(k).cos()) as f32, (radius * at(k).sin()) as f32, 0.0))
        .collect()
}

fn on_square(height: impl Fn(f32, f32) -> f32) -> Vec<Vec3> {
    let along = (0..=1000).map(|k| k as f32 / 500.0 - 1.0);
    along
        .flat_map(|t| [(t, 1.0), (t, -1.0), (1.0, t), (-1.0, t)])
        .map(|(x, y)| Vec3::new(x, y, height(x, y)))
        .collect()
}

fn open_surfaces() -> [Open; 3] {
    [
        Open { shape: Outlined::Hemisphere, area: TAU, rim: on_circle(1.0) },
        Open {
            shape: Outlined::SaddleRim,
            area: 4.756_724,
            rim: on_square(|x, y| 0.4 * (x * x - y * y)),
        },
        Open {
            shape: Outlined::Hole,
            area: 4.0 - PI * 0.16,
            rim: [on_square(|_, _| 0.0), on_circle(0.4)].concat(),
        },
    ]
}

/// Even clouds, random ones, and one with larger radii than it needs.
fn clouds(shape: Outlined) -> Vec<(String, PointSet)> {
    let mut clouds = Vec::new();
    for seed in 1..=2 {
        clouds.push((format!("even {shape} {seed}"), even(shape, POINTS, seed)));
        clouds.push((format!("random {shape} {seed}"), uneven(shape, POINTS, seed)));
    }
    let wide = with_radii_times(even(shape, POINTS, 1), 1.5);
    clouds.push((format!("{shape} with radii times 1.5"), wide));
    clouds
}

fn marked(levels: u32) -> RefineParams {
    RefineParams { levels, boundary: Boundary::Marked("rim".into()), ..RefineParams::default() }
}

/// New points that the run itself marks as points of the rim.
fn new_on_rim(refined: &Refined) -> Vec<Vec3> {
    let marks = bytes(&refined.points, "rim");
    let new = new_points(refined).filter(|&i| marks[i] == 1);
    new.map(|i| refined.points.positions[i]).collect()
}

#[test]
fn the_boundary_that_is_found_is_the_rim() {
    for Open { shape, .. } in open_surfaces() {
        for seed in 1..=3 {
            let cloud = even(shape, POINTS, seed);
            let count = bytes(&cloud, "rim").iter().filter(|&&r| r == 1).count();
            let curves = refine(&cloud, &levels(1)).curves;
            let expected = CurveCounts {
                boundary_points: count,
                boundary_segments: count,
                ..CurveCounts::default()
            };
            assert_eq!(curves, expected, "{shape} {seed}");
        }
    }
}

#[test]
fn the_refined_surface_reaches_the_rim_and_ends_there() {
    for Open { shape, area, rim } in open_surfaces() {
        for (name, cloud) in clouds(shape) {
            let refined = refine(&cloud, &marked(4));
            let (input, output) = (spacing(area, cloud.len()), spacing(area, refined.points.len()));
            let nearest = Nearest::new(&refined.points.positions, output as f32);
            let farthest =
                rim.iter().map(|&x| nearest.distance(x, |_| true)).fold(0.0, f64::max) / output;
            // Measured up to .47, and 1.01 where a random point hides a piece of the rim from its ends.
            let allowed = if name.starts_with("random") { 1.1 } else { 0.6 };
            assert!(farthest < allowed, "{name}: a point of the rim is {farthest} spacings away");
            let true_rim = Nearest::new(&rim, input as f32);
            let on_rim = new_on_rim(&refined);
            assert!(on_rim.len() > 6 * 30, "{name}: {} new points on the rim", on_rim.len());
            for x in on_rim {
                let off = true_rim.distance(x, |_| true) / input;
                // Measured up to .013.
                assert!(off < 0.016, "{name}: a new rim point is {off} spacings off at {x}");
            }
            for i in new_points(&refined) {
                let beyond = beyond(shape, refined.points.positions[i]) / input;
                assert!(beyond < 0.05, "{name}: a new point is {beyond} spacings beyond the rim");
            }
        }
    }
}

/// How far a point lies outside of the region over which the surface lies.
fn beyond(shape: Outlined, x: Vec3) -> f64 {
    let x = x.as_dvec3();
    let outside_square = x.x.abs().max(x.y.abs()) - 1.0;
    match shape {
        Outlined::Hemisphere => -x.z,
        Outlined::Hole => outside_square.max(0.4 - x.x.hypot(x.y)),
        _ => outside_square,
    }
}

#[test]
fn no_holes_are_left_beside_the_rim() {
    for Open { shape, area, rim } in open_surfaces() {
        let refined = refine(&even(shape, POINTS, 3), &levels(4));
        let output = spacing(area, refined.points.len());
        let nearest = Nearest::new(&refined.points.positions, output as f32);
        let probes = even_probes(shape);
        let probes = probes.iter().chain(&rim);
        let worst = probes.map(|&x| nearest.distance(x, |_| true)).fold(0.0, f64::max) / output;
        assert!(worst < 2.0, "{shape}: a hole of {worst} spacings");
    }
}

/// Random points of the open surface.
fn even_probes(shape: Outlined) -> Vec<Vec3> {
    uneven(shape, 8000, 77).positions
}

#[test]
fn rims_are_split_in_three_at_every_second_step() {
    for Open { shape, .. } in open_surfaces() {
        let cloud = even(shape, POINTS, 4);
        let refined = refine(&cloud, &marked(4));
        let marks = bytes(&refined.points, "rim");
        let mut segments = bytes(&cloud, "rim").iter().filter(|&&r| r == 1).count();
        for level in 1..=4 {
            let new = refined.level_sizes[level - 1]..refined.level_sizes[level];
            let on_rim = marks[new].iter().filter(|&&r| r == 1).count();
            if level % 2 == 0 {
                assert_eq!(on_rim, 2 * segments, "{shape}, level {level}");
                segments *= 3;
            } else {
                assert_eq!(on_rim, 0, "{shape}, level {level}");
            }
        }
    }
}

#[test]
fn without_boundaries_the_rim_erodes() {
    for Open { shape, area, rim } in open_surfaces() {
        let cloud = even(shape, POINTS, 1);
        let params = RefineParams { boundary: Boundary::None, ..levels(4) };
        let refined = refine(&cloud, &params);
        assert_eq!(refined.curves, CurveCounts::default(), "{shape}");
        let output = spacing(area, refined.points.len());
        let nearest = Nearest::new(&refined.points.positions, output as f32);
        let farthest = rim.iter().map(|&x| nearest.distance(x, |_| true)).fold(0.0, f64::max);
        assert!(farthest / output > 1.0, "{shape}: {} spacings", farthest / output);
    }
}

#[test]
fn only_marked_points_are_boundary() {
    let mut cloud = even(Outlined::Hole, POINTS, 5);
    // Half of the rim: what is not marked is closed, however wide its gaps are.
    let left: Vec<u8> = (0..cloud.len())
        .map(|i| u8::from(bytes(&cloud, "rim")[i] == 1 && cloud.positions[i].x < 0.0))
        .collect();
    let count = left.iter().filter(|&&m| m == 1).count();
    cloud.attributes[0].values = surfine_points::Values::U8(left);
    let refined = refine(&cloud, &marked(2));
    let found = refined.curves.boundary_points;
    assert!(found <= count && found + 4 > count, "{found} of {count}");
    for x in new_on_rim(&refined) {
        assert!(x.x < 0.1, "a new rim point at {x}");
    }
    // A property that is not there is a mistake.
    cloud.attributes.clear();
    let error = surfine_reference::refine(&cloud, &marked(1)).expect_err("there are no marks");
    assert!(error.to_string().contains("no property rim"), "{error}");
}

#[test]
fn closed_clouds_have_no_boundary() {
    for shape in [Shape::Sphere, Shape::Torus, Shape::Ellipsoid] {
        for sampling in Sampling::ALL {
            for seed in 1..=4 {
                let cloud = sample(shape, sampling, 1000, seed);
                let curves = refine(&cloud, &levels(1)).curves;
                assert_eq!(curves, CurveCounts::default(), "{sampling} {shape} {seed}");
            }
        }
    }
}

#[test]
fn points_of_creases_are_no_boundary() {
    for shape in [Outlined::Cube, Outlined::Cylinder] {
        for seed in 1..=3 {
            let curves = refine(&even(shape, POINTS, seed), &levels(1)).curves;
            assert_eq!((curves.boundary_points, curves.boundary_segments), (0, 0), "{shape}");
        }
    }
}
