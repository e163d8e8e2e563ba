//! What fills holes.

use crate::clouds::{even, reach, spacing, two_holes, without};
use surfine_holes::{Choice, Error, Filled, fill_holes, loops, raised};
use surfine_points::shapes::{Sampling, Shape, sample};
use surfine_points::{Attribute, PointSet, RefineParams, Values, Vec3};

fn fill_all(points: &PointSet) -> Filled {
    fill_holes(points, &Choice::All).unwrap()
}

fn tags(points: &PointSet) -> &[i32] {
    match points.attribute("hole").map(|a| &a.values) {
        Some(Values::I32(tags)) => tags,
        other => panic!("the tags are {other:?}"),
    }
}

#[test]
fn a_cap_of_a_sphere_comes_back() {
    for (chord, most_off, most_tilt) in [(0.2, 0.01, 0.2), (0.5, 0.03, 0.4), (0.8, 0.07, 0.6)] {
        let cloud = without(&even(Shape::Sphere, 3000), Vec3::Z, chord);
        let Filled { points, fills, .. } = fill_all(&cloud);
        assert_eq!(fills.len(), 1);
        let fill = cloud.len()..points.len();
        let inside = spacing(&points, |i| i >= cloud.len());
        let around = spacing(&points, |i| i < cloud.len());
        let off = |i: usize| (points.positions[i].length() - 1.0).abs() / around;
        let off = fill.clone().map(off).fold(0.0, f32::max);
        let tilt = |i: usize| points.positions[i].angle_between(points.normals[i]).to_degrees();
        let tilt = fill.clone().map(tilt).fold(0.0, f32::max);
        assert!((0.75..1.33).contains(&(inside / around)), "{inside} against {around}");
        assert!(off < most_off && tilt < most_tilt, "{off} spacings, {tilt} degrees");
        // The largest empty disc is no larger than on an even cloud: places of the cap are near to a point.
        let places = sample(Shape::Sphere, Sampling::Random, 20_000, 9).positions;
        let cap = places.into_iter().filter(|x| (*x - Vec3::Z).length() < chord);
        let gap = cap.map(|x| reach(&points, x)).fold(0.0, f32::max);
        assert!(gap < 1.25 * around, "{} spacings", gap / around);
    }
}

#[test]
fn a_hole_in_a_plane_stays_flat() {
    let cloud = without(&even(Shape::Plane, 2000), Vec3::ZERO, 0.4);
    let Filled { points, .. } = fill_all(&cloud);
    assert!(points.len() > cloud.len() + 150, "{} points", points.len());
    for i in cloud.len()..points.len() {
        assert!(points.positions[i].z.abs() < 1e-6, "{}", points.positions[i]);
        assert!(points.positions[i].length() < 0.45, "{}", points.positions[i]);
        assert!((points.normals[i] - Vec3::Z).length() < 1e-5, "{}", points.normals[i]);
    }
}

#[test]
fn refined_fills_have_no_gaps() {
    let cloud = without(&even(Shape::Sphere, 1000), Vec3::Z, 0.6);
    let Filled { points, .. } = fill_all(&cloud);
    let params = RefineParams { levels: 2, ..RefineParams::default() };
    let refined = surfine_reference::refine(&points, &params).unwrap().points;
    let hole = tags(&refined);
    let inside = spacing(&refined, |i| hole[i] > 0);
    let around = spacing(&refined, |i| hole[i] == 0 && refined.positions[i].z > 0.0);
    assert!((0.67..1.5).contains(&(inside / around)), "{inside} against {around}");
    let places = sample(Shape::Sphere, Sampling::Random, 10_000, 9).positions;
    let cap = places.into_iter().filter(|x| (*x - Vec3::Z).length() < 0.6);
    let gap = cap.map(|x| reach(&refined, x)).fold(0.0, f32::max);
    assert!(gap < 2.0 * around, "{} spacings", gap / around);
    let off = |x: &Vec3| (x.length() - 1.0).abs();
    assert!(refined.positions.iter().map(off).fold(0.0, f32::max) < 0.1 * around);
}

#[test]
fn input_points_stay_bit_for_bit() {
    let cloud = two_holes();
    let Filled { points, fills, restored, kept_raised } = fill_all(&cloud);
    let n = cloud.len();
    assert_eq!(
        (points.positions[..n].to_vec(), points.normals[..n].to_vec()),
        (cloud.positions.clone(), cloud.normals.clone())
    );
    assert_eq!((restored, kept_raised), (0, 0));
    let rims: Vec<u32> = loops(&cloud).into_iter().flat_map(|hole| hole.points).collect();
    for i in 0..n {
        let (before, after) = (cloud.radii[i], points.radii[i]);
        let touched = rims.contains(&(i as u32));
        assert!(before == after || touched && after > before, "{i}: {before} to {after}");
    }
    assert_eq!(fills.iter().map(|fill| fill.points).sum::<usize>(), points.len() - n);
    points.validate().unwrap();
}

#[test]
fn only_the_chosen_are_filled() {
    let cloud = two_holes();
    let span = loops(&cloud)[1].span;
    for (choice, ids) in [
        (Choice::None, vec![]),
        (Choice::Raised, vec![]),
        (Choice::All, vec![1, 2]),
        (Choice::Ids(vec![2]), vec![2]),
        (Choice::Ids(vec![2, 1, 2]), vec![1, 2]),
        (Choice::MaxSpan(1.01 * span), vec![2]),
        (Choice::MaxSpan(0.99 * span), vec![]),
    ] {
        let Filled { points, fills, .. } = fill_holes(&cloud, &choice).unwrap();
        assert_eq!(fills.iter().map(|fill| fill.id).collect::<Vec<_>>(), ids, "{choice:?}");
        if ids.is_empty() {
            assert_eq!(points, cloud, "{choice:?}");
            continue;
        }
        let mut expected = vec![0; cloud.len()];
        fills.iter().for_each(|f| expected.resize(expected.len() + f.points, f.id as i32));
        assert_eq!(tags(&points), expected, "{choice:?}");
        for (x, &tag) in points.positions.iter().zip(tags(&points)) {
            assert!(tag == 0 || (x.z > 0.0) == (tag == 1), "{x} has tag {tag}");
        }
    }
    let unknown = fill_holes(&cloud, &Choice::Ids(vec![1, 3])).unwrap_err();
    assert_eq!(unknown, Error::UnknownId { id: 3, known: vec![1, 2] });
    assert_eq!(unknown.to_string(), "there is no loop 3: they are 1 to 2");
}

#[test]
fn outer_rims_are_only_filled_by_id() {
    let plane = even(Shape::Plane, 600);
    for choice in [Choice::All, Choice::MaxSpan(100.0)] {
        assert_eq!(fill_holes(&plane, &choice).unwrap().points, plane, "{choice:?}");
    }
}

#[test]
fn other_holes_do_not_matter() {
    // Each fill sees its own loop alone.
    let cloud = two_holes();
    let one = fill_holes(&cloud, &Choice::Ids(vec![2])).unwrap().points;
    let both = fill_all(&cloud).points;
    let count = one.len() - cloud.len();
    assert_eq!(one.positions[cloud.len()..], both.positions[both.len() - count..]);
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let cloud = two_holes();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fill_all(&cloud).points)
    };
    let one = with(1);
    assert!(one.len() > cloud.len());
    assert!(one == with(2) && one == with(5));
}

#[test]
fn attributes_come_from_the_corners() {
    let mut cloud = two_holes();
    let height = cloud.positions.iter().map(|x| x.z).collect();
    let label = cloud.positions.iter().map(|x| u8::from(x.z > 0.0) + 4).collect();
    cloud.attributes.push(Attribute::new("height", Values::F32(height)));
    cloud.attributes.push(Attribute::new("label", Values::U8(label)));
    let filled = fill_all(&cloud).points;
    let names: Vec<&str> = filled.attributes.iter().map(|a| a.name.as_str()).collect();
    assert_eq!(names, ["height", "label", "hole"]);
    let [Values::F32(height), Values::U8(label)] =
        [0, 1].map(|i: usize| filled.attributes[i].values.clone())
    else {
        panic!("the types changed")
    };
    for i in cloud.len()..filled.len() {
        let z = filled.positions[i].z;
        // The rims are at 0.82 and -0.955: means of their points stay there.
        let rim = if z > 0.0 { 0.7..0.9 } else { -1.0..-0.85 };
        assert!(rim.contains(&height[i]), "{} at {z}", height[i]);
        assert_eq!(label[i], u8::from(z > 0.0) + 4);
    }
}

#[test]
fn a_second_fill_goes_on_with_the_tags() {
    let cloud = two_holes();
    let first = fill_holes(&cloud, &Choice::Ids(vec![1])).unwrap().points;
    let second = fill_all(&first);
    assert_eq!(second.fills.len(), 1, "the first hole is closed");
    assert_eq!(tags(&second.points)[..first.len()], *tags(&first));
    assert!(tags(&second.points)[first.len()..].iter().all(|&tag| tag == 2));
    let mut named = cloud;
    let values = Values::F32(vec![0.0; named.len()]);
    named.attributes.push(Attribute::new("hole", values));
    assert_eq!(fill_holes(&named, &Choice::All), Err(Error::Tag));
}

#[test]
fn raised_radii_are_filled_and_natural_again() {
    let cloud = two_holes();
    let hole = &loops(&cloud)[0];
    let mut by_hand = cloud.clone();
    for &p in &hole.points {
        by_hand.radii[p as usize] = 1.1 * hole.span;
    }
    let found: Vec<u32> = raised(&by_hand).iter().map(|raised| raised.point).collect();
    let mut expected = hole.points.clone();
    expected.sort_unstable();
    assert_eq!(found, expected);
    let Filled { points, fills, restored, kept_raised } =
        fill_holes(&by_hand, &Choice::Raised).unwrap();
    assert_eq!((fills.len(), fills[0].id), (1, 1));
    assert_eq!((restored, kept_raised), (expected.len(), 0));
    let largest = cloud.radii.iter().copied().fold(0.0, f32::max);
    assert!(points.radii.iter().all(|&r| r < 1.5 * largest));
    // Elsewhere nothing changes.
    for i in (0..cloud.len()).filter(|&i| cloud.positions[i].z < 0.6) {
        assert_eq!(points.radii[i], cloud.radii[i]);
    }
    assert_eq!(fill_holes(&by_hand, &Choice::None).unwrap().points, by_hand);
}

#[test]
fn raised_radii_without_a_loop_are_kept() {
    let mut cloud = even(Shape::Sphere, 800);
    cloud.radii[5] = 1.0;
    let filled = fill_holes(&cloud, &Choice::Raised).unwrap();
    assert_eq!((filled.points, filled.kept_raised, filled.restored), (cloud, 1, 0));
}

#[test]
fn scale_and_place_do_not_matter() {
    let cloud = without(&even(Shape::Sphere, 1000), Vec3::Z, 0.6);
    let count = fill_all(&cloud).points.len();
    // Powers of two leave all digits as they are.
    for scale in [2f32.powi(-30), 2f32.powi(30)] {
        let mut scaled = cloud.clone();
        scaled.positions.iter_mut().for_each(|x| *x *= scale);
        scaled.radii.iter_mut().for_each(|r| *r *= scale);
        assert_eq!(fill_all(&scaled).points.len(), count, "{scale}");
    }
}
