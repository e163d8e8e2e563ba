//! What a refinement keeps, and where it puts what it adds.

use surfine_points::shapes::{Outlined, Shape, square_grid};
use surfine_points::{
    Attribute, Boundary, DVec3, PointSet, RefineParams, Refined, Rules, Values, Vec3,
};

use crate::clouds::{blue_noise, closed, jittered_grid, levels, random, refine, with_uneven_radii};
use crate::curves::{bytes, even};
use crate::measure::{median, vector_bits};

/// Clouds of all kinds, small.
fn clouds() -> Vec<(&'static str, PointSet)> {
    vec![
        ("sphere", blue_noise(Shape::Sphere, 300, 1)),
        ("random torus", random(Shape::Torus, 400, 1)),
        ("random saddle", random(Shape::Saddle, 300, 1)),
        ("jittered grid", jittered_grid(15, 1)),
        ("square grid", square_grid(15)),
        ("uneven radii", with_uneven_radii(random(Shape::Ellipsoid, 300, 1), 1)),
    ]
}

/// Adds what a file may bring along: attributes, an origin, and normals of odd lengths.
fn dressed(mut points: PointSet) -> PointSet {
    let n = points.len();
    let values = |step: u32| (0..n as u32).map(move |i| i.wrapping_mul(step) >> 24);
    let red = Values::U8(values(0x9e37_79b9).map(|v| v as u8).collect());
    let label = Values::I32(values(0x85eb_ca6b).map(|v| v as i32 - 100).collect());
    let heat = Values::F64(values(0xc2b2_ae35).map(|v| f64::from(v) / 7.0).collect());
    points.attributes = vec![
        Attribute::new("red", red),
        Attribute::new("label", label),
        Attribute::new("heat", heat),
    ];
    points.origin = DVec3::new(4.5e5, -5.1e6, 0.125);
    points.normals.iter_mut().step_by(3).for_each(|n| *n *= 1.7);
    points
}

/// The attributes of the first `n` points.
fn first_attributes(points: &PointSet, n: usize) -> Vec<Attribute> {
    let mut attributes = points.attributes.clone();
    for attribute in &mut attributes {
        match &mut attribute.values {
            Values::U8(v) => v.truncate(n),
            Values::I32(v) => v.truncate(n),
            Values::F64(v) => v.truncate(n),
            other => panic!("{other:?} is not among the attributes of these clouds"),
        }
    }
    attributes
}

#[test]
fn old_points_stay_first_and_untouched() {
    for (name, cloud) in clouds() {
        let cloud = dressed(cloud);
        let refined = refine(&cloud, &levels(3)).points;
        let n = cloud.len();
        assert!(refined.len() > 5 * n, "{name}: {} points of {n}", refined.len());
        let same = |old: &[Vec3], new: &[Vec3]| vector_bits(old) == vector_bits(&new[..n]);
        assert!(same(&cloud.positions, &refined.positions), "{name}: positions");
        assert!(same(&cloud.normals, &refined.normals), "{name}: normals");
        assert_eq!(cloud.attributes, first_attributes(&refined, n), "{name}: attributes");
        assert_eq!(cloud.origin, refined.origin, "{name}: origin");
        refined.validate().unwrap_or_else(|e| panic!("{name}: a column is short or unfit: {e}"));
    }
}

#[test]
fn no_level_leaves_the_input_as_it_is() {
    let cloud = dressed(random(Shape::Torus, 100, 1));
    let refined = refine(&cloud, &levels(0));
    assert_eq!(refined.points, cloud);
    assert_eq!(refined.level_sizes, [100]);
    assert!(refined.parents.is_empty());
}

#[test]
fn single_steps_add_up_to_as_many_points() {
    // The radii of a later run's input are no input radii, and its first step would be an odd one again, which splits
    // no rim.
    let rules = Rules { first_radii: false, ..Rules::ALL };
    let levels = |n| RefineParams { rules, ..closed(n) };
    for (name, cloud) in clouds() {
        let at_once = refine(&cloud, &levels(3));
        let mut steps = refine(&cloud, &levels(0));
        for _ in 0..3 {
            let step = refine(&steps.points, &levels(1));
            steps.points = step.points;
            steps.level_sizes.push(step.level_sizes[1]);
        }
        // Each run brings its input into its own order, and with it the order in which points are refined.
        for (one, other) in at_once.level_sizes.iter().zip(&steps.level_sizes) {
            let ratio = *one as f64 / *other as f64;
            assert!((ratio - 1.0).abs() < 0.03, "{name}: {one} and {other} points");
        }
    }
}

/// Sizes, levels and parents that agree with each other.
fn check_bookkeeping(refined: &Refined, name: &str) {
    let (sizes, levels) = (&refined.level_sizes, refined.levels());
    assert_eq!(levels.len(), refined.points.len(), "{name}");
    assert_eq!(refined.parents.len(), refined.points.len() - sizes[0], "{name}");
    assert_eq!(sizes.last(), Some(&refined.points.len()), "{name}");
    for (i, report) in refined.reports.iter().enumerate() {
        assert_eq!([report.points_in, report.points_out], [sizes[i], sizes[i + 1]], "{name}");
    }
    for (i, &[a, b, c]) in refined.parents.iter().enumerate() {
        let level = levels[sizes[0] + i];
        let before = |p: u32| levels[p as usize] < level;
        assert!(before(a) && before(b) && before(c), "{name}: parents of new point {i}");
        assert!(a < b && a < c && b != c, "{name}: corners of new point {i}: {a} {b} {c}");
    }
}

#[test]
fn parents_are_three_different_points_of_earlier_levels() {
    for (name, cloud) in clouds() {
        check_bookkeeping(&refine(&cloud, &closed(3)), name);
    }
}

#[test]
fn parents_on_a_rim_are_the_ends_of_its_segment_the_nearer_twice() {
    let cloud = even(Outlined::Hemisphere, 300, 1);
    let boundary = Boundary::Marked("rim".into());
    let refined = refine(&cloud, &RefineParams { boundary, ..levels(2) });
    let rim = bytes(&refined.points, "rim");
    let mut seen = 0;
    for (i, &[a, b, c]) in refined.parents.iter().enumerate() {
        let (new, x) = (cloud.len() + i, &refined.points.positions);
        assert_eq!(a == b, rim[new] == 1, "corners of new point {i}: {a} {b} {c}");
        if a == b {
            let [near, far] = [a, c].map(|p| (x[p as usize] - x[new]).length());
            assert!(near < 0.6 * far, "new rim point {i}: {near} and {far}");
            assert_eq!([rim[a as usize], rim[c as usize]], [1, 1]);
            seen += 1;
        }
    }
    assert!(seen > 40, "{seen} new rim points");
}

#[test]
fn new_points_lie_near_their_parents() {
    for (name, cloud) in clouds() {
        let refined = refine(&cloud, &levels(1));
        for (i, &corners) in refined.parents.iter().enumerate() {
            let x = refined.points.positions[cloud.len() + i];
            let [a, b, c] = corners.map(|c| cloud.positions[c as usize]);
            let longest = (a - b).length().max((b - c).length()).max((c - a).length());
            let farthest = [a, b, c].map(|p| (p - x).length()).into_iter().fold(0.0, f32::max);
            // The centre of gravity is within 2/3 of the longest side of all corners; displacement adds a little.
            assert!(farthest < longest, "{name}: new point {i} is {farthest} off, side {longest}");
            // The triangle was found in the ball of one of its corners; 1e-5 is for rounding.
            let centers = corners.map(|p| {
                let reach = (1.0 + 1e-5) * cloud.radii[p as usize];
                let center = cloud.positions[p as usize];
                [a, b, c].iter().all(|q| (*q - center).length() <= reach)
            });
            assert!(
                centers.contains(&true),
                "{name}: corners of {i} are out of each other's balls"
            );
        }
    }
}

#[test]
fn new_points_have_unit_normals_and_radii_that_reach_their_parents_surroundings() {
    for (name, cloud) in clouds() {
        let refined = refine(&cloud, &levels(3)).points;
        for i in cloud.len()..refined.len() {
            let (n, r) = (refined.normals[i], refined.radii[i]);
            // A few roundings of f32, 6e-8 each.
            assert!((n.length() - 1.0).abs() < 1e-6, "{name}: normal {n} of point {i}");
            assert!(r.is_finite() && r > 0.0, "{name}: radius {r} of point {i}");
        }
    }
}

#[test]
fn every_radius_of_an_even_closed_cloud_shrinks() {
    for shape in [Shape::Sphere, Shape::Torus, Shape::Ellipsoid] {
        let cloud = blue_noise(shape, 600, 2);
        let refined = refine(&cloud, &levels(1)).points;
        for i in 0..cloud.len() {
            let (old, new) = (cloud.radii[i], refined.radii[i]);
            assert!(new < old, "{shape}: the radius of point {i} went from {old} to {new}");
        }
    }
}

#[test]
fn the_median_radius_shrinks_with_the_spacing() {
    for (name, cloud) in clouds().into_iter().filter(|(name, _)| *name != "uneven radii") {
        let refined = refine(&cloud, &levels(2));
        let ratio = median(&cloud.radii) / median(&refined.points.radii);
        // The spacing falls by sqrt(3) twice, so 3; measured 2.58 (random saddle) to 4.09 (sphere): input radii are
        // 1.25 times the ring, new ones 1.02 times.
        assert!((2.4..4.3).contains(&ratio), "{name}: the median radius fell by {ratio}");
    }
}

/// The widest angle on the tangent plane of point `p`, in degrees, without a new point nearer than the radius of `p`.
fn widest_gap(refined: &Refined, p: usize) -> f64 {
    let points = &refined.points;
    let (e1, e2) = points.normals[p].any_orthonormal_pair();
    let offsets =
        points.positions[refined.level_sizes[0]..].iter().map(|&x| x - points.positions[p]);
    let near = offsets.filter(|d| d.length() < points.radii[p]);
    let mut angles: Vec<f64> =
        near.map(|d| f64::from(d.dot(e2)).atan2(f64::from(d.dot(e1))).to_degrees()).collect();
    angles.sort_by(f64::total_cmp);
    let Some(&first) = angles.first() else { return 360.0 };
    angles.push(first + 360.0);
    angles.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max)
}

#[test]
fn new_neighbours_surround_every_old_point_of_an_even_closed_cloud() {
    for shape in [Shape::Sphere, Shape::Torus, Shape::Ellipsoid] {
        for seed in 1..=3 {
            let refined = refine(&blue_noise(shape, 600, seed), &levels(1));
            let gaps: Vec<f64> = (0..600).map(|p| widest_gap(&refined, p)).collect();
            let share = |bound: f64| gaps.iter().filter(|&&g| g < bound).count() as f64 / 600.0;
            let widest = gaps.iter().copied().fold(0.0, f64::max);
            let shares = [90.0, 100.0, 120.0].map(share);
            // A gap stays wider than 89 degrees (curved, so a little less on the plane) only where no candidate splits
            // it or its candidates are discarded. Measured: .80 to .85, .93 to .97, .996 to 1, widest 114 to 127.
            let bounds = [0.75, 0.9, 0.99];
            for (share, bound) in shares.into_iter().zip(bounds) {
                assert!(
                    share > bound,
                    "{shape}, seed {seed}: {shares:?} below 90, 100, 120 degrees"
                );
            }
            assert!(widest < 150.0, "{shape}, seed {seed}: a gap of {widest} degrees");
        }
    }
}
