//! Creases and corners: they stay sharp, and nothing reaches across them (section 6).

use std::f64::consts::PI;

use surfine_features::Features;
use surfine_points::shapes::{Outlined, one_record_a_normal};
use surfine_points::{Boundary, CurveCounts, PointSet, RefineParams, Refined, Rules, Vec3};

use crate::clouds::{levels, refine, with_radii_times};
use crate::curves::{
    bytes, even, from_cube_edges, from_cylinder_edges, further_normals, new_points, spacing, uneven,
};
use crate::measure::{Nearest, assert_same_bytes, vector_bits};

/// Points of the small cubes and cylinders.
const POINTS: usize = 400;

fn cube_spacing() -> f64 {
    spacing(6.0, POINTS)
}

/// The cubes that the tests below look at.
fn cubes() -> Vec<(String, PointSet)> {
    let mut cubes = Vec::new();
    for seed in 1..=3 {
        cubes.push((format!("even cube {seed}"), even(Outlined::Cube, POINTS, seed)));
        cubes.push((format!("random cube {seed}"), uneven(Outlined::Cube, POINTS, seed)));
    }
    for factor in [1.5, 2.0] {
        let cloud = with_radii_times(even(Outlined::Cube, POINTS, 1), factor);
        cubes.push((format!("cube with radii times {factor}"), cloud));
    }
    cubes
}

/// The new points of a kind.
fn new_of_kind(refined: &Refined, kind: u8) -> Vec<usize> {
    let kinds = bytes(&refined.points, "kind");
    new_points(refined).filter(|&i| kinds[i] == kind).collect()
}

/// How far a smooth point of the cube lies off the plane of the face that its normal says.
fn off_its_face(x: Vec3, n: Vec3) -> f64 {
    let axis = (0..3).max_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).expect("three axes");
    f64::from((x[axis] - 0.5 * n[axis].signum()).abs())
}

#[test]
fn faces_of_a_cube_stay_flat_and_its_edges_straight() {
    for (name, cloud) in cubes() {
        let refined = refine(&cloud, &levels(4));
        let growth = refined.points.len() as f64 / cloud.len() as f64;
        assert!(growth > 50.0, "{name}: growth {growth} in 4 levels");
        for i in new_of_kind(&refined, 0) {
            let (x, n) = (refined.points.positions[i], refined.points.normals[i]);
            let off = off_its_face(x, n);
            // Not only of the face's plane: within the face, but for rounding.
            let outside = f64::from(x.abs().max_element()) - 0.5;
            assert!(off < 1e-6 && outside < 1e-6, "{name}: {x} is {off:e} off its face");
            assert!(n.abs().max_element() > 1.0 - 1e-6, "{name}: normal {n} is of no face");
        }
        for i in new_of_kind(&refined, 1) {
            let x = refined.points.positions[i];
            let off = from_cube_edges(x);
            assert!(off < 1e-6, "{name}: {x} is {off:e} off the edges");
        }
    }
}

/// The largest hole of the whole surface after 4 levels, in output spacings.
fn largest_hole(shape: Outlined, area: f64, cloud: &PointSet, rules: Rules) -> f64 {
    let refined = refine(cloud, &RefineParams { rules, ..levels(4) });
    let output = spacing(area, refined.points.len());
    let nearest = Nearest::new(&refined.points.positions, output as f32);
    let probes = uneven(shape, 6000, 77).positions;
    probes.iter().map(|&x| nearest.distance(x, |_| true)).fold(0.0, f64::max) / output
}

#[test]
fn no_holes_are_left_beside_creases() {
    for (shape, area) in [(Outlined::Cube, 6.0), (Outlined::Cylinder, 1.5 * PI)] {
        for seed in 1..=2 {
            // Measured .95 to 1.39 over eight seeds, and 1.31 to 1.82 for random points.
            let hole = largest_hole(shape, area, &even(shape, 300, seed), Rules::ALL);
            assert!(hole < 1.45, "even {shape} {seed}: a hole of {hole} spacings");
            let hole = largest_hole(shape, area, &uneven(shape, 300, seed), Rules::ALL);
            assert!(hole < 2.2, "random {shape} {seed}: a hole of {hole} spacings");
        }
    }
}

#[test]
fn the_rules_for_creases_matter() {
    // Measured 1.23 instead of 1.08. Single clouds differ by more.
    let mean_hole = |rules| {
        let (shape, area) = (Outlined::Cylinder, 1.5 * PI);
        let hole = |seed| largest_hole(shape, area, &even(shape, 300, seed), rules);
        (1..=8).map(hole).sum::<f64>() / 8.0
    };
    // Only the paper's loop asks for gaps.
    let paper_loop = Rules { largest_first: false, ..Rules::ALL };
    let without = mean_hole(Rules { curve_bounds: false, ..paper_loop });
    assert!(without > mean_hole(paper_loop) + 0.08, "without partners as bounds: {without}");
    let cube = Outlined::Cube;
    let rules = Rules { separating_segments: false, ..Rules::ALL };
    let refined = refine(&even(cube, 300, 1), &RefineParams { rules, ..levels(4) });
    let off = |x: &Vec3| (x.abs().max_element() - 0.5).abs();
    let farthest = refined.points.positions.iter().map(off).fold(0.0, f32::max);
    assert!(farthest > 1e-3, "without segments between points the cube stays flat: {farthest:e}");
}

#[test]
fn faces_fill_up_to_the_edges() {
    let cloud = even(Outlined::Cube, POINTS, 4);
    let refined = refine(&cloud, &levels(4));
    // The edge between two faces has neighbours on both: no strip beside it stays empty.
    let spacing = spacing(6.0, refined.points.len());
    let nearest = Nearest::new(&refined.points.positions, spacing as f32);
    let kinds = bytes(&refined.points, "kind");
    let mut random = fastrand::Rng::with_seed(1);
    for _ in 0..4000 {
        let mut place = || random.f32() - 0.5;
        let x = Vec3::new(place(), place(), 0.5);
        let distance = nearest.distance(x, |_| true) / spacing;
        assert!(distance < 1.7, "a hole of {distance} spacings at {x}");
    }
    let smooth = |j: u32| kinds[j as usize] == 0;
    for i in (0..refined.points.len()).filter(|&i| kinds[i] == 1) {
        let distance = nearest.distance(refined.points.positions[i], smooth) / spacing;
        assert!(distance < 2.0, "no smooth point within {distance} spacings of a crease point");
    }
}

#[test]
fn a_cylinder_keeps_its_mantle_its_ends_and_its_circles() {
    let clouds = [
        ("even", even(Outlined::Cylinder, POINTS, 1)),
        ("random", uneven(Outlined::Cylinder, POINTS, 2)),
    ];
    for (name, cloud) in clouds {
        let spacing = spacing(1.5 * PI, POINTS);
        let refined = refine(&cloud, &levels(4));
        let points = &refined.points;
        let creased = new_of_kind(&refined, 1);
        assert!(creased.len() > 400, "{name}: {} crease points", creased.len());
        for i in creased {
            let off = from_cylinder_edges(points.positions[i]) / spacing;
            assert!(off < 0.01, "{name}: a crease point is {off} spacings off the circles");
            let [second, third] = further_normals(points, i);
            let (mantle, end) = (points.normals[i], second);
            let upright = if end.z.abs() > 0.5 { end } else { mantle };
            assert!(
                upright.z.abs() > 1.0 - 1e-5,
                "{name}: no normal of {mantle} {end} is an end's"
            );
            assert!(mantle.dot(end).abs() < 1e-3, "{name}: {mantle} and {end}");
            assert_eq!(third, Vec3::ZERO, "{name}");
        }
        for i in new_of_kind(&refined, 0) {
            let (x, n) = (points.positions[i].as_dvec3(), points.normals[i]);
            let off = if n.z.abs() > 0.7 {
                (x.z - 0.5 * f64::from(n.z.signum())).abs()
            } else {
                (x.x.hypot(x.y) - 0.5).abs()
            };
            // Random points have longer triangles, which miss the curved mantle by more.
            let allowed = if name == "even" { 5e-3 } else { 5e-2 } * spacing;
            assert!(off < allowed, "{name}: {x} is {} spacings off", off / spacing);
            // Every normal is one of a side: nothing is averaged over a crease.
            let exact = if n.z.abs() > 0.7 {
                Vec3::Z * n.z.signum()
            } else {
                x.with_z(0.0).normalize().as_vec3()
            };
            let turned = n.dot(exact).clamp(-1.0, 1.0).acos().to_degrees();
            assert!(turned < if name == "even" { 3.0 } else { 20.0 }, "{name}: {turned}° at {x}");
        }
    }
}

#[test]
fn creases_are_split_in_three_at_every_second_step() {
    for shape in [Outlined::Cube, Outlined::Cylinder] {
        let cloud = even(shape, POINTS, 5);
        let refined = refine(&cloud, &levels(4));
        let input = bytes(&cloud, "kind");
        let mut segments = input.iter().filter(|&&k| k == 1).count();
        if shape == Outlined::Cube {
            // One more an edge than points between its corners.
            segments += 12;
        }
        assert_eq!(refined.curves.crease_segments, segments, "{shape}");
        let kinds = bytes(&refined.points, "kind");
        for level in 1..=4 {
            let new = refined.level_sizes[level - 1]..refined.level_sizes[level];
            let creased = kinds[new].iter().filter(|&&k| k == 1).count();
            if level % 2 == 0 {
                assert_eq!(creased, 2 * segments, "{shape}, level {level}");
                segments *= 3;
            } else {
                assert_eq!(creased, 0, "{shape}, level {level}");
            }
        }
    }
    let at = |step| Features::splits_at(step, Rules::ALL);
    assert_eq!([1, 2, 3, 4].map(at), [false, true, false, true]);
}

#[test]
fn corners_stay_and_none_is_made() {
    for (name, cloud) in cubes() {
        let refined = refine(&cloud, &levels(3));
        let expected = CurveCounts {
            crease_points: bytes(&cloud, "kind").iter().filter(|&&k| k == 1).count(),
            corners: 8,
            crease_segments: bytes(&cloud, "kind").iter().filter(|&&k| k == 1).count() + 12,
            boundary_points: 0,
            boundary_segments: 0,
        };
        assert_eq!(refined.curves, expected, "{name}");
        assert_eq!(new_of_kind(&refined, 2), [], "{name}: new corners");
        for i in new_points(&refined) {
            let [second, third] = further_normals(&refined.points, i);
            let creased = bytes(&refined.points, "kind")[i] == 1;
            assert_eq!(third, Vec3::ZERO, "{name}");
            assert_eq!(second != Vec3::ZERO, creased, "{name}: second normal {second}");
            if creased {
                let n = refined.points.normals[i];
                assert!((second.length() - 1.0).abs() < 1e-6, "{name}: {second}");
                assert!(n.dot(second).abs() < 1e-6, "{name}: {n} and {second}");
            }
        }
    }
}

#[test]
fn input_points_stay_bit_for_bit() {
    for (name, cloud) in cubes() {
        let refined = refine(&cloud, &levels(2)).points;
        let n = cloud.len();
        assert_eq!(vector_bits(&refined.positions[..n]), vector_bits(&cloud.positions), "{name}");
        assert_eq!(vector_bits(&refined.normals[..n]), vector_bits(&cloud.normals), "{name}");
        assert_eq!(bytes(&refined, "kind")[..n], *bytes(&cloud, "kind"), "{name}");
        for i in 0..n {
            assert_eq!(further_normals(&refined, i), further_normals(&cloud, i), "{name}");
        }
    }
}

#[test]
fn records_that_share_a_position_are_the_other_way_to_say_it() {
    for shape in [Outlined::Cube, Outlined::Cylinder] {
        let cloud = even(shape, POINTS, 6);
        let doubled = one_record_a_normal(&cloud);
        assert!(doubled.len() > cloud.len() + 50, "{shape}");
        let (one, other) = (refine(&cloud, &levels(4)), refine(&doubled, &levels(4)));
        assert_eq!(one.curves, other.curves, "{shape}");
        // The numbering differs, so ties may fall otherwise; the surface is the same.
        let creased = new_of_kind(&one, 1).len();
        let smooth = new_of_kind(&one, 0).len();
        let found = new_points(&other).len() - 2 * creased;
        let ratio = found as f64 / smooth as f64;
        assert!((ratio - 1.0).abs() < 0.01, "{shape}: {found} smooth points instead of {smooth}");
        // Each new crease point is two records in one place, which follow each other.
        let points = &other.points;
        let kinds = bytes(points, "kind");
        let records: Vec<usize> = new_points(&other).filter(|&i| kinds[i] == 1).collect();
        assert_eq!(records.len(), 2 * creased, "{shape}");
        for pair in records.chunks(2) {
            let [a, b] = [pair[0], pair[1]];
            assert_eq!(b, a + 1, "{shape}");
            assert_eq!(
                vector_bits(&points.positions[a..=a]),
                vector_bits(&points.positions[b..=b])
            );
            assert!(points.normals[a].dot(points.normals[b]).abs() < 1e-3, "{shape}: {pair:?}");
        }
    }
}

#[test]
fn parents_of_new_points_lie_on_one_side() {
    let refined = refine(&even(Outlined::Cube, POINTS, 7), &levels(4));
    let points = &refined.points;
    for (i, corners) in new_points(&refined).zip(&refined.parents) {
        if bytes(points, "kind")[i] != 0 {
            continue;
        }
        let n = points.normals[i];
        for &corner in corners {
            let corner = corner as usize;
            let [second, third] = further_normals(points, corner);
            let like = [points.normals[corner], second, third].map(|m| m.dot(n));
            assert!(like.iter().any(|&c| c > 0.999), "{i} has corner {corner} of another face");
        }
    }
}

#[test]
fn powers_of_two_scale_every_byte() {
    for (name, cloud) in [
        ("cube", even(Outlined::Cube, 300, 8)),
        ("random cylinder", uneven(Outlined::Cylinder, 300, 9)),
        ("saddle with rim", even(Outlined::SaddleRim, 300, 8)),
        ("random hole", uneven(Outlined::Hole, 300, 8)),
    ] {
        let plain = refine(&cloud, &levels(3));
        for exponent in [-10, 10] {
            let factor = 2f32.powi(exponent);
            let mut refined = refine(&crate::scale::scaled(&cloud, factor), &levels(3));
            refined.points = crate::scale::scaled(&refined.points, 1.0 / factor);
            assert_same_bytes(&plain, &refined, &format!("{name}, 2^{exponent}"));
            assert_eq!(plain.points.attributes, refined.points.attributes, "{name}");
        }
    }
}

#[test]
fn without_further_normals_a_cube_is_rounded() {
    // Or else the tests above would show nothing.
    let mut cloud = even(Outlined::Cube, POINTS, 1);
    cloud.attributes.clear();
    // Its edges would count as boundaries.
    let params = RefineParams { boundary: Boundary::None, ..levels(2) };
    let refined = refine(&cloud, &params);
    assert_eq!(refined.curves, CurveCounts::default());
    let off = |i: usize| off_its_face(refined.points.positions[i], refined.points.normals[i]);
    let worst = new_points(&refined).map(off).fold(0.0, f64::max) / cube_spacing();
    assert!(worst > 0.05, "the worst point is {worst} spacings off its face");
}
