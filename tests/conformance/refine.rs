//! Whole runs of several levels: the engine's cloud against the reference's.

use crate::clouds::{Cloud, demanding, describe, shared_outlined, variants, whole, whole_outlined};
use crate::harness::{Device, compare, compare_equal, device, first_level, must};
use crate::tolerance::{EXACT, FLIPPED_DECISIONS, POSITION};
use std::collections::HashMap;
use surfine::testing::records::Point;
use surfine::testing::{Sizing, read};
use surfine::{Boundary, LevelReport, Mode, PointSet, RefineParams, Refined, Refiner, Rules, Vec3};
use surfine_points::shapes::{Sampling, Shape, sample};

fn flat(vectors: &[Vec3]) -> Vec<f32> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}

/// Everything must be equal, bit for bit.
fn must_be_identical(name: &str, expected: &Refined, found: &Refined) {
    let what = |column: &str| format!("{name}: {column}");
    must(compare_equal(&what("level sizes"), &expected.level_sizes, &found.level_sizes));
    must(compare_equal(&what("parents"), &expected.parents, &found.parents));
    let (e, f) = (&expected.points, &found.points);
    must(compare(&what("positions"), &flat(&e.positions), &flat(&f.positions), EXACT, 1.0));
    must(compare(&what("normals"), &flat(&e.normals), &flat(&f.normals), EXACT, 1.0));
    must(compare(&what("radii"), &e.radii, &f.radii, EXACT, 1.0));
    must(compare_equal(&what("levels"), &expected.levels(), &found.levels()));
    must(compare_equal(&what("radii by level"), &expected.level_radii, &found.level_radii));
    must(compare_equal(&what("attributes"), &e.attributes, &f.attributes));
    assert_eq!(expected.curves, found.curves, "{name}: curves");
    assert_eq!(expected.reports.len(), found.reports.len(), "{name}: reports");
    for (e, f) in expected.reports.iter().zip(&found.reports) {
        assert_eq!(
            (e.points_in, e.points_out, e.ball_neighbors, e.ring_neighbors, e.classes, e.isolated),
            (f.points_in, f.points_out, f.ball_neighbors, f.ring_neighbors, f.classes, f.isolated),
            "{name}: report"
        );
        let words = |report: &LevelReport| report.stages.iter().map(|s| s.0).collect::<Vec<_>>();
        must(compare_equal(&what("stages"), &words(e), &words(f)));
    }
}

/// On adapters that round otherwise: the first level's new points are those of the same triangles, but for a budget of
/// flipped decisions, and lie where the reference puts them.
fn must_be_close(name: &str, expected: &Refined, found: &Refined) {
    let old = expected.level_sizes[0];
    let (expected_new, found_new) = (expected.level_sizes[1] - old, found.level_sizes[1] - old);
    let place: HashMap<[u32; 3], usize> =
        (0..expected_new).map(|i| (expected.parents[i], old + i)).collect();
    let scale = expected.points.radii[..old].iter().copied().fold(0.0, f32::max);
    let mut flipped = expected_new.abs_diff(found_new);
    for i in 0..found_new {
        let Some(&at) = place.get(&found.parents[i]) else {
            flipped += 1;
            continue;
        };
        let (e, f) = (expected.points.positions[at], found.points.positions[old + i]);
        must(compare(&format!("{name}: position"), &e.to_array(), &f.to_array(), POSITION, scale));
    }
    let budget = (FLIPPED_DECISIONS * expected_new as f64).ceil() as usize;
    println!("{name}: {flipped} flipped decisions of {expected_new}, {budget} allowed");
    assert!(flipped <= budget, "{name}: {flipped} flipped decisions, {budget} allowed");
}

fn check(device: &mut Device, cloud: &Cloud, params: &RefineParams) {
    let is_exact = device.is_exact();
    check_with(&mut device.refiner, is_exact, cloud, params);
}

/// Returns what the refiner makes of a cloud, which must be what the reference makes of it.
pub(crate) fn check_with(
    refiner: &mut Refiner,
    is_exact: bool,
    cloud: &Cloud,
    params: &RefineParams,
) -> Refined {
    let name = format!("{} {}", cloud.name, describe(params));
    let expected = surfine_reference::refine(&cloud.points, params).expect("the cloud is sound");
    let found = refiner.refine(&cloud.points, params).unwrap_or_else(|e| panic!("{name}: {e}"));
    // Without a level nothing is rounded.
    if is_exact || params.levels == 0 {
        must_be_identical(&name, &expected, &found);
    } else {
        must_be_close(&name, &expected, &found);
    }
    found
}

#[test]
fn whole_runs_give_the_bytes_of_the_reference() {
    let mut device = device();
    for (cloud, levels) in whole() {
        for params in variants() {
            check(&mut device, &cloud, &RefineParams { levels, ..params });
        }
    }
}

#[test]
fn whole_runs_with_curves_give_the_bytes_of_the_reference() {
    let mut device = device();
    let mut check = |cloud: &Cloud, params: RefineParams| {
        let level = first_level(&cloud.points, &params);
        assert!(level.curves.is_some(), "{} {}", cloud.name, describe(&params));
        check(&mut device, cloud, &params);
    };
    for (cloud, most) in whole_outlined() {
        for (variant, params) in variants().into_iter().enumerate() {
            // The second level splits the curves, whatever the variant.
            let levels = if variant == 0 { most } else { 2 };
            check(&cloud, RefineParams { levels, ..params });
        }
    }
    for cloud in shared_outlined() {
        check(&cloud, RefineParams { levels: 2, ..RefineParams::default() });
    }
}

#[test]
fn boundaries_reach_the_device_as_asked() {
    let mut device = device();
    let cloud = |(cloud, _): (Cloud, u32)| cloud;
    let (cube, saddle) = (cloud(whole_outlined().remove(0)), cloud(whole_outlined().remove(4)));
    for boundary in [Boundary::None, Boundary::Marked("rim".into()), Boundary::Angle(2.4)] {
        for cloud in [&cube, &saddle] {
            let boundary = boundary.clone();
            let params = RefineParams { levels: 2, boundary, ..RefineParams::default() };
            let marks = params.boundary.property();
            if marks.is_some_and(|name| cloud.points.attribute(name).is_none()) {
                // The cube has no rim: both refuse.
                let refused = device.refiner.refine(&cloud.points, &params).expect_err("no marks");
                let expected = surfine_reference::refine(&cloud.points, &params);
                assert_eq!(refused.to_string(), expected.expect_err("no marks").to_string());
                continue;
            }
            check(&mut device, cloud, &params);
        }
    }
}

/// Whether two refinements of one cloud give different results.
fn differ(a: &Refined, b: &Refined) -> bool {
    (&a.points, &a.parents, &a.level_radii) != (&b.points, &b.parents, &b.level_radii)
}

#[test]
fn other_parameters_reach_the_kernels() {
    let mut device = device();
    let (cloud, _) = whole().remove(1);
    let defaults = RefineParams { levels: 2, ..RefineParams::default() };
    let rules = Rules { largest_first: false, ..Rules::ALL };
    // The default selection asks neither for angles between new neighbours nor for the largest of them.
    let paper_loop = RefineParams { rules, ..defaults.clone() };
    for (params, base) in [
        (RefineParams { plain_angle: true, ..paper_loop.clone() }, &paper_loop),
        (RefineParams { theta_c: 1.2, ..paper_loop.clone() }, &paper_loop),
        (RefineParams { lambda1: 0.4, ..paper_loop.clone() }, &paper_loop),
        (RefineParams { lambda2: 0.8, ..paper_loop.clone() }, &paper_loop),
        (RefineParams { theta_f: 0.3, ..defaults.clone() }, &defaults),
        (RefineParams { lambda1: 0.4, ..defaults.clone() }, &defaults),
        (RefineParams { lambda2: 0.8, ..defaults.clone() }, &defaults),
        (RefineParams { keep_radii: true, ..defaults.clone() }, &defaults),
        (RefineParams { levels: 0, ..defaults.clone() }, &defaults),
    ] {
        let [with, without] = [&params, base]
            .map(|p| surfine_reference::refine(&cloud.points, p).expect("the cloud is sound"));
        assert!(differ(&with, &without), "nothing to see: {params:?}");
        check(&mut device, &cloud, &params);
    }
}

#[test]
fn each_rule_left_out_reaches_the_kernels() {
    let mut device = device();
    let clouds = demanding();
    for (rule, _) in Rules::ALL.named() {
        // These mean nothing to the default selection.
        let paper_loop = ["first_radii", "curve_bounds"].contains(&rule);
        let all = Rules { largest_first: !paper_loop, ..Rules::ALL };
        let mut others = all;
        *others.get_mut(rule).expect("it is its name") = false;
        let params = |rules| RefineParams { levels: 2, rules, ..RefineParams::default() };
        let matters = |cloud: &&Cloud| {
            let [with, without] = [all, others].map(|rules| {
                surfine_reference::refine(&cloud.points, &params(rules)).expect("it is sound")
            });
            differ(&with, &without)
        };
        // One cloud will do: the kernels are compiled anew for each rule, which takes the time.
        let cloud = clouds.iter().find(matters);
        let cloud = cloud.unwrap_or_else(|| panic!("no cloud needs {rule}"));
        check(&mut device, cloud, &params(others));
    }
}

#[test]
fn degenerate_clouds_give_the_bytes_of_the_reference() {
    let mut device = device();
    let point = |x: f32| (Vec3::new(x, 0.0, 0.0), Vec3::Z, 1.5f32);
    type Row = (Vec3, Vec3, f32);
    // The triangle of the first three puts its candidate on the fourth.
    let on_top = |x: f32, y: f32, n: Vec3| (Vec3::new(x, y, 0.0), n, 5.0);
    let under = Vec3::new(0.192_450_09, 0.192_450_09, -0.962_250_4);
    let cases: [(&str, Vec<Row>); 7] = [
        ("empty", vec![]),
        ("one", vec![point(0.0)]),
        ("two", vec![point(0.0), point(1.0)]),
        ("collinear", (0..5).map(|i| point(i as f32)).collect()),
        ("coincident", vec![point(2.0); 7]),
        (
            "on top",
            vec![
                on_top(0.0, 0.0, Vec3::Z),
                on_top(3.0, 0.0, Vec3::Z),
                on_top(0.0, 3.0, Vec3::Z),
                on_top(1.0, 1.0, under),
            ],
        ),
        ("triangle", vec![point(0.0), point(1.0), (Vec3::Y, Vec3::Z, 1.5)]),
    ];
    for (name, rows) in cases {
        let points = PointSet::new(
            rows.iter().map(|r| r.0).collect(),
            rows.iter().map(|r| r.1).collect(),
            rows.iter().map(|r| r.2).collect(),
        );
        let cloud = Cloud { name: name.into(), points };
        let params = RefineParams { levels: 2, ..RefineParams::default() };
        let expected =
            surfine_reference::refine(&cloud.points, &params).expect("the cloud is sound");
        let found = device.refiner.refine(&cloud.points, &params).expect("the device can do it");
        must_be_identical(name, &expected, &found);
    }
}

#[test]
fn buffers_that_turn_out_too_small_grow() {
    // A refiner of its own, which provides hardly anything and works in the smallest pieces.
    let mut refiner = Refiner::with_gpu(device().gpu().clone()).expect("the kernels compile");
    refiner.set_sizing(Sizing { chunk: 100, part: 7, entries: 1, rounds: 1 });
    let params = RefineParams { levels: 2, ..RefineParams::default() };
    let simplified = RefineParams { simplified: true, ..params.clone() };
    let rules = Rules { largest_first: false, ..Rules::ALL };
    let paper_loop = RefineParams { rules, ..params.clone() };
    // Large, small and large again: buffers are used for clouds of other sizes.
    for (i, params) in
        [(1, &params), (0, &simplified), (2, &paper_loop), (2, &simplified), (1, &params)]
    {
        let cloud = whole().swap_remove(i).0;
        check_with(&mut refiner, device().is_exact(), &cloud, params);
    }
}

#[test]
fn too_many_neighbors_for_the_driver_are_an_error_that_names_a_point() {
    let mut device = device();
    let mut cloud = whole().remove(0).0;
    // One point that has all others around it. The device has it elsewhere: it brings the points into an order of its
    // own.
    const CROWDED: usize = 137;
    cloud.points.radii[CROWDED] = 3.0;
    match device.refiner.refine(&cloud.points, &RefineParams::default()) {
        Err(surfine::Error::Crowded { vertex, level, .. }) => {
            assert_eq!((vertex, level), (Some(CROWDED), 1));
        }
        // Hardware has no such limit: then the answer must be right.
        Ok(found) => {
            let expected = surfine_reference::refine(&cloud.points, &RefineParams::default());
            assert_eq!(found.level_sizes, expected.expect("the cloud is sound").level_sizes);
        }
        Err(other) => panic!("{other}"),
    }
}

/// Pipelines that a refiner has compiled so far: its debug output is the only way to see them.
pub(crate) fn pipelines(refiner: &Refiner) -> usize {
    format!("{refiner:?}").matches("pipeline: ComputePipeline").count()
}

#[test]
fn kernels_for_curves_can_be_compiled_beforehand() {
    let device = device();
    let mut refiner = Refiner::with_gpu(device.gpu().clone()).expect("the kernels compile");
    let params = RefineParams { levels: 2, ..RefineParams::default() };
    let before = pipelines(&refiner);
    refiner.prepare_curves(&params).expect("the kernels compile");
    let prepared = pipelines(&refiner);
    assert!(prepared > before, "{prepared} pipelines, {before} before");
    // A cube, and a saddle whose rim is a boundary: each has kernels of its own.
    for (at, is_creased) in [(0, true), (4, false)] {
        let (cloud, _) = whole_outlined().swap_remove(at);
        let curves = check_with(&mut refiner, device.is_exact(), &cloud, &params).curves;
        let segments = [curves.crease_segments, curves.boundary_segments];
        assert_eq!(segments.map(|count| count > 0), [is_creased, !is_creased], "{segments:?}");
    }
    assert_eq!(pipelines(&refiner), prepared, "kernels were compiled after all");
}

#[test]
fn a_device_without_passthrough_runs_plain_and_says_so() {
    let adapter = surfine::choose_adapter(None).expect("the suite has an adapter");
    let descriptor =
        surfine::wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
    let opened = pollster::block_on(adapter.request_device(&descriptor));
    let (own_device, queue) = opened.expect("the adapter opens");
    let mut refiner = Refiner::with_device(own_device, queue).expect("the kernels compile");
    assert_eq!(refiner.gpu().mode, Mode::Plain);
    let (cloud, _) = whole().remove(1);
    let params = RefineParams::default();
    let expected = surfine_reference::refine(&cloud.points, &params).expect("the cloud is sound");
    let found = refiner.refine(&cloud.points, &params).expect("the device can do it");
    must_be_close("plain mode", &expected, &found);
}

#[test]
fn a_device_of_too_small_limits_is_an_error() {
    let adapter = surfine::choose_adapter(None).expect("the suite has an adapter");
    let opened = pollster::block_on(adapter.request_device(&Default::default()));
    let (own_device, queue) = opened.expect("the adapter opens");
    // The default limits allow eight storage buffers a stage; the insertion has ten.
    let error = Refiner::with_device(own_device, queue).expect_err("the limits are too small");
    assert!(error.to_string().contains("storage"), "{error}");
}

#[test]
fn a_result_left_on_the_device_is_the_one_that_is_read_back() {
    let mut device = device();
    let (cloud, _) = whole().remove(0);
    let params = RefineParams { levels: 2, ..RefineParams::default() };
    let kept =
        device.refiner.refine_on_device(&cloud.points, &params, &mut |_| ()).expect("it runs");
    let found = device.refiner.refine(&cloud.points, &params).expect("it runs again");
    assert_eq!(kept.level_sizes, found.level_sizes);
    assert!(kept.points.usage().contains(surfine::wgpu::BufferUsages::VERTEX));
    let records: Vec<Point> =
        read(device.gpu(), &kept.points, kept.len()).expect("the device is alive");
    let levels = found.levels();
    for (at, record) in records.iter().enumerate() {
        let i = kept.ordered.order.get(at).map_or(at, |&i| i as usize);
        assert_eq!(record.position, found.points.positions[i].to_array(), "position {i}");
        assert_eq!(record.normal, found.points.normals[i].to_array(), "normal {i}");
        assert_eq!(record.radius.to_bits(), found.points.radii[i].to_bits(), "radius {i}");
        assert_eq!(record.level, u32::from(levels[i]), "level {i}");
    }
}

#[test]
fn a_filled_hole_gives_the_bytes_of_the_reference() {
    let mut device = device();
    let whole = sample(Shape::Sphere, Sampling::BlueNoise, 1000, 1);
    let outside = (0..whole.len()).filter(|&i| whole.positions[i].z < 0.85);
    let (mut positions, mut normals, mut radii) = (Vec::new(), Vec::new(), Vec::new());
    for i in outside {
        positions.push(whole.positions[i]);
        normals.push(whole.normals[i]);
        radii.push(whole.radii[i]);
    }
    let open = PointSet::new(positions, normals, radii);
    let filled = surfine_holes::fill_holes(&open, &surfine_holes::Choice::All).expect("it fits");
    assert!(filled.points.len() > open.len() + 20, "nothing was filled");
    let cloud = Cloud { name: "filled sphere".into(), points: filled.points };
    check(&mut device, &cloud, &RefineParams { levels: 3, ..RefineParams::default() });
}
