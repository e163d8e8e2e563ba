//! Creases that no modeller should make, and files have.

use surfine_points::shapes::{Outlined, natural_radii, square_grid};
use surfine_points::{Attribute, CurveCounts, Invalid, PointSet, Refined, Values, Vec3};
use surfine_reference::Error;

use crate::clouds::{closed, levels, refine};
use crate::curves::{even, floats, further_normals, new_points, set_float};
use crate::degenerate::assert_sound;
use crate::measure::{assert_same_bytes, vector_bits};

/// Gives every point room for a second normal: zero, so it has none.
fn with_second_normals(mut points: PointSet) -> PointSet {
    for name in ["nx2", "ny2", "nz2"] {
        let zeros = Values::F32(vec![0.0; points.len()]);
        points.attributes.push(Attribute::new(name, zeros));
    }
    points
}

fn set_second_normal(points: &mut PointSet, i: usize, n: Vec3) {
    for (name, value) in ["nx2", "ny2", "nz2"].into_iter().zip(n.to_array()) {
        set_float(points, name, i, value);
    }
}

/// Without boundaries, whose counts would only distract.
fn refine_closed(points: &PointSet, steps: u32) -> Refined {
    let refined = refine(points, &closed(steps));
    assert_sound(&refined);
    refined
}

/// A strip of the plane folded by 90° along x = 0: `z = -|x|`, with the points of the middle row given as `creased`
/// says.
fn roof(side: i32, creased: impl Fn(i32) -> bool) -> PointSet {
    let (left, right) =
        (Vec3::new(-1.0, 0.0, 1.0).normalize(), Vec3::new(1.0, 0.0, 1.0).normalize());
    let mut points = PointSet::default();
    let mut seconds = Vec::new();
    for y in -side..=side {
        for x in -side..=side {
            points.positions.push(Vec3::new(x as f32, y as f32, -x.abs() as f32) * 0.1);
            points.normals.push(if x < 0 {
                left
            } else if x > 0 {
                right
            } else {
                Vec3::Z
            });
            if x == 0 && creased(y) {
                *points.normals.last_mut().expect("just pushed") = left;
                seconds.push((points.positions.len() - 1, right));
            }
        }
    }
    points.radii = vec![0.22; points.positions.len()];
    let mut points = with_second_normals(points);
    seconds.into_iter().for_each(|(i, n)| set_second_normal(&mut points, i, n));
    points
}

#[test]
fn a_roof_stays_a_roof() {
    let cloud = roof(6, |_| true);
    let refined = refine_closed(&cloud, 4);
    assert_eq!((refined.curves.crease_points, refined.curves.crease_segments), (13, 12));
    for i in new_points(&refined) {
        let x = refined.points.positions[i];
        let off = (x.z + x.x.abs()).abs();
        assert!(off < 1e-6, "{x} is {off:e} off the roof");
    }
}

#[test]
fn a_groove_stays_a_groove() {
    // The roof upside down: the normals of its sides lean towards each other.
    let mut cloud = roof(6, |_| true);
    cloud.positions.iter_mut().for_each(|x| x.z = -x.z);
    cloud.normals.iter_mut().for_each(|n| n.x = -n.x);
    for i in 0..cloud.len() {
        let x = floats(&cloud, "nx2")[i];
        set_float(&mut cloud, "nx2", i, -x);
    }
    let refined = refine_closed(&cloud, 4);
    assert_eq!((refined.curves.crease_points, refined.curves.crease_segments), (13, 12));
    assert!(refined.points.len() > 40 * cloud.len(), "{:?}", refined.level_sizes);
    for i in new_points(&refined) {
        let x = refined.points.positions[i];
        let off = (x.z - x.x.abs()).abs();
        assert!(off < 1e-6, "{x} is {off:e} off the groove");
    }
}

#[test]
fn a_crease_may_end_inside_a_face() {
    // A dart: sharp for y <= 0 only. Beyond, the middle row is round.
    let cloud = roof(6, |y| y <= 0);
    let refined = refine_closed(&cloud, 4);
    assert_eq!((refined.curves.crease_points, refined.curves.crease_segments), (7, 6));
    for i in new_points(&refined) {
        let x = refined.points.positions[i];
        let off = (x.z + x.x.abs()).abs();
        // Away from the end the sharp part is flat; elsewhere points lie within the round of the middle row.
        let allowed = if x.y < -0.2 { 1e-6 } else { 0.06 };
        assert!(off < allowed, "{x} is {off:e} off the roof");
    }
}

#[test]
fn crease_points_without_partners_are_smooth_points() {
    let plain = with_second_normals(square_grid(9));
    let mut one = plain.clone();
    set_second_normal(&mut one, 40, Vec3::X);
    let refined = refine_closed(&one, 3);
    assert_eq!(refined.curves, CurveCounts::default());
    assert_eq!(further_normals_of_new(&refined), 0);
    // Two that are farther apart than 1.5 radii.
    let mut two = one.clone();
    set_second_normal(&mut two, 36, Vec3::X);
    assert_eq!(refine_closed(&two, 3).curves, CurveCounts::default());
}

/// Number of new points that have a second normal.
fn further_normals_of_new(refined: &Refined) -> usize {
    let second =
        |i: usize| ["nx2", "ny2", "nz2"].iter().any(|name| floats(&refined.points, name)[i] != 0.0);
    new_points(refined).filter(|&i| second(i)).count()
}

#[test]
fn two_crease_points_are_a_crease() {
    let cloud = roof(4, |y| y == 0 || y == 1);
    let refined = refine_closed(&cloud, 4);
    assert_eq!((refined.curves.crease_points, refined.curves.crease_segments), (2, 1));
    assert_eq!(further_normals_of_new(&refined), 2 + 6);
}

#[test]
fn two_points_alone_with_two_normals_have_no_fans_but_a_crease() {
    let mut cloud = PointSet::new(vec![Vec3::ZERO, Vec3::Y], vec![Vec3::Z; 2], vec![1.5; 2]);
    cloud = with_second_normals(cloud);
    (0..2).for_each(|i| set_second_normal(&mut cloud, i, Vec3::X));
    let refined = refine_closed(&cloud, 4);
    assert_eq!(refined.level_sizes, [2, 2, 4, 4, 10]);
    assert!(refined.points.positions.iter().all(|x| x.x == 0.0 && x.z == 0.0));
}

#[test]
fn normals_that_are_alike_make_no_crease() {
    let plain = even(Outlined::Cube, 300, 1);
    // Three times the same normal, at a smooth point: copies, not sides.
    let smooth = plain.len() - 1;
    let mut cloud = plain.clone();
    let n = cloud.normals[smooth];
    for rank in ["2", "3"] {
        for (letter, value) in ["x", "y", "z"].into_iter().zip(n.to_array()) {
            set_float(&mut cloud, &format!("n{letter}{rank}"), smooth, value);
        }
    }
    let refined = refine(&cloud, &levels(2));
    assert_sound(&refined);
    assert_eq!(refined.curves, refine(&plain, &levels(2)).curves);
    assert_eq!(further_normals(&refined.points, smooth), [n; 2], "as it came");
}

#[test]
fn further_normals_of_zero_are_none() {
    let mut bare = even(Outlined::Hole, 300, 1);
    bare.attributes.clear();
    let zeros = with_second_normals(bare.clone());
    let (plain, refined) = (refine(&bare, &levels(3)), refine(&zeros, &levels(3)));
    assert_same_bytes(&plain, &refined, "zero normals");
    assert_eq!(plain.curves, refined.curves);
    assert_eq!(further_normals_of_new(&refined), 0);
}

#[test]
fn lengths_of_further_normals_do_not_matter() {
    let cloud = even(Outlined::Cylinder, 300, 1);
    let mut long = cloud.clone();
    for name in ["nx2", "ny2", "nz2"] {
        for i in 0..long.len() {
            let value = floats(&cloud, name)[i];
            set_float(&mut long, name, i, 8.0 * value);
        }
    }
    assert_same_bytes(&refine(&cloud, &levels(2)), &refine(&long, &levels(2)), "8 times as long");
}

#[test]
fn further_normals_that_are_not_finite_are_errors_that_name_the_point() {
    for (name, bad) in [("nx2", f32::NAN), ("nz2", f32::INFINITY), ("ny3", f32::NAN)] {
        let mut cloud = even(Outlined::Cube, 300, 1);
        set_float(&mut cloud, name, 17, bad);
        let error = surfine_reference::refine(&cloud, &levels(1)).expect_err("a normal is unfit");
        assert!(error.to_string().contains("vertex 17:"), "{error}");
        let Error::Points(Invalid::NotFinite { point, .. }) = error else { panic!("{error}") };
        assert_eq!(point, 17);
    }
}

#[test]
fn opposite_normals_are_two_sheets() {
    let mut cloud = with_second_normals(square_grid(9));
    for i in 0..cloud.len() {
        set_second_normal(&mut cloud, i, Vec3::NEG_Z);
    }
    let refined = refine_closed(&cloud, 2);
    assert_eq!(refined.curves, CurveCounts::default());
    assert!(refined.points.len() > 3 * cloud.len(), "{:?}", refined.level_sizes);
}

#[test]
fn four_records_in_one_place_do_no_harm() {
    // The tip of a pyramid, and its four edges.
    let mut points = PointSet::default();
    let sides = [Vec3::X, Vec3::Y, Vec3::NEG_X, Vec3::NEG_Y];
    let normals = sides.map(|s| (s + Vec3::Z).normalize());
    let mut push = |x: Vec3, n: Vec3| {
        points.positions.push(x);
        points.normals.push(n);
    };
    normals.iter().for_each(|&n| push(Vec3::ZERO, n));
    for k in 0..4 {
        let (a, b) = (sides[k], sides[(k + 1) % 4]);
        for step in 1..=6 {
            let height = Vec3::NEG_Z * step as f32;
            let edge = (a + b) * step as f32 + height;
            push(edge, normals[k]);
            push(edge, normals[(k + 1) % 4]);
            // Between this edge and the one before, on the face of `a`.
            let before = sides[(k + 3) % 4];
            for t in 1..2 * step {
                let t = t as f32 / (2 * step) as f32;
                push(edge + (before - b) * (t * step as f32), normals[k]);
            }
        }
    }
    points.radii = natural_radii(&points.positions, &points.normals);
    let refined = refine_closed(&points, 4);
    let counts = refined.curves;
    assert_eq!((counts.crease_points, counts.corners), (24, 1), "{counts:?}");
    assert_eq!(counts.crease_segments, 24, "{counts:?}");
    for i in new_points(&refined) {
        let x = refined.points.positions[i];
        let off = (x.z + x.x.abs().max(x.y.abs())).abs();
        assert!(off < 0.05, "{x} is {off} off the pyramid");
    }
}

#[test]
fn copies_of_points_are_no_creases() {
    let single = even(Outlined::SaddleRim, 300, 2);
    let mut doubled = single.clone();
    doubled.positions.extend(&single.positions);
    doubled.normals.extend(&single.normals);
    doubled.radii.extend(&single.radii);
    doubled.attributes.clear();
    let refined = refine(&doubled, &levels(2));
    assert_sound(&refined);
    assert_eq!((refined.curves.crease_points, refined.curves.corners), (0, 0));
    let n = doubled.len();
    let kept = &refined.points.positions[..n];
    assert_eq!(vector_bits(kept), vector_bits(&doubled.positions));
}

#[test]
fn a_point_too_near_to_a_crease_point_to_have_a_direction_lies_on_no_side() {
    let mut cloud = roof(3, |_| true);
    // The crease point of the middle is at the origin: the square of this distance is no number of 32 bits.
    let beside =
        cloud.positions.iter().position(|x| x.x == 0.1 && x.y == 0.0).expect("it is there");
    cloud.positions[beside] = Vec3::new(1e-25, 0.0, 0.0);
    assert!(refine_closed(&cloud, 2).points.len() > 2 * cloud.len());
}

#[test]
fn boundaries_are_not_split_beyond_what_numbers_can_hold() {
    let mut cloud = square_grid(6);
    for x in &mut cloud.positions {
        // Ten steps would put points closer than f32 has places here.
        *x = (*x - cloud_middle()) * 5.0 + Vec3::splat(1.0e6);
    }
    cloud.radii.iter_mut().for_each(|r| *r *= 5.0);
    let refined = refine(&cloud, &levels(6));
    assert!(refined.curves.boundary_segments > 0, "there is no boundary");
    assert_sound(&refined);
}

/// Middle of the unit square.
fn cloud_middle() -> Vec3 {
    Vec3::new(0.5, 0.5, 0.0)
}

#[test]
fn the_kind_is_right_where_no_step_splits_the_crease() {
    let mut cloud = roof(4, |_| true);
    let kinds = (0..cloud.len()).map(|i| u8::from(cloud.positions[i].x == 0.0)).collect();
    cloud.attributes.push(Attribute::new("kind", Values::U8(kinds)));
    let refined = refine_closed(&cloud, 1);
    let new = crate::curves::bytes(&refined.points, "kind")[cloud.len()..].iter();
    assert!(new.clone().count() > 100 && new.copied().all(|kind| kind == 0));
}
