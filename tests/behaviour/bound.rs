//! Section 8.1: radii fall from level to level, and the bound of eq. 13 and 14 that says so.
//!
//! The bound holds as printed. With p at the origin and both neighbours no farther than r, the new point is the mean of
//! the three halves `½(b_210 + b_120)`, `½(b_201 + b_102)` and `½(b_021 + b_012)`; tangents have a third of their
//! edge's length. So the first two are no longer than `½(1/3 + 1 + 1/3) r = 5/6 r`, and the third, for two neighbours
//! at distance r, than `(cos β/2 + 2/3 sin β/2) r`: half the diagonal and a third of the edge. At unequal distances the
//! triangle inequality gives 5/6 there where that is more, from β = 160° on, but no triangle comes near. The largest
//! `c_β` is (5 + √13)/9 = .9562.
//!
//! It is generous. A tangent never leads away from the other end of its edge, so the first two halves stay below
//! `½ √(11/9 + 2 √10/9) r = .694 r`, and a search over all triangles found no new point beyond .802 r. On smooth
//! surfaces it is at .58.

use surfine_points::shapes::Shape;
use surfine_points::{Convergence, PointSet, RefineParams, Refined, Vec3};
use surfine_reference::pn_triangle::{Corner, center_of_gravity, displaced_center, tangent};

use crate::clouds::{blue_noise, levels, literal, random, refine};
use crate::measure::assert_same_bytes;

/// Eq. 14 for the cosine of β.
fn c_beta(cosine: f32) -> f32 {
    let (cos_half, sin_half) = (((1.0 + cosine) / 2.0).sqrt(), ((1.0 - cosine) / 2.0).sqrt());
    (5.0 / 6.0 + 5.0 / 6.0 + (cos_half + 2.0 / 3.0 * sin_half)) / 3.0
}

/// The radius of the apex (the first corner) and eq. 14's share of it; `None` if a neighbour is at the apex.
fn bound([p, a, b]: [Corner; 3]) -> Option<(f32, f32)> {
    let (a, b) = (a.position - p.position, b.position - p.position);
    let lengths = a.length() * b.length();
    (lengths > 0.0).then(|| {
        let cosine = (a.dot(b) / lengths).clamp(-1.0, 1.0);
        (a.length().max(b.length()), c_beta(cosine))
    })
}

fn vector(random: &mut fastrand::Rng) -> Vec3 {
    loop {
        let mut coordinate = || 2.0 * random.f32() - 1.0;
        let v = Vec3::new(coordinate(), coordinate(), coordinate());
        if v.length_squared() <= 1.0 {
            return v;
        }
    }
}

/// Triangles around the origin: any positions and normals, however inconsistent, and such that stretch the bound. The
/// latter were found by search.
fn triangles(count: usize, seed: u64) -> Vec<[Corner; 3]> {
    let mut random = fastrand::Rng::with_seed(seed);
    let in_plane =
        |degrees: f32| Vec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0);
    // β and the directions of the three normals.
    let stretched = [(49.3, [116.9, 180.0, 229.2]), (106.8, [142.1, 180.0, 286.7])];
    let mut make = |i: usize| {
        let mut corner = |position, normal: Vec3| {
            let normal = (normal + 0.3 * vector(&mut random)).normalize();
            Corner { position, normal }
        };
        match stretched.get(i % 4) {
            Some(&(beta, [n0, n1, n2])) => [
                corner(Vec3::ZERO, in_plane(n0)),
                corner(in_plane(0.0), in_plane(n1)),
                corner(in_plane(beta), in_plane(n2)),
            ],
            None => [(); 3].map(|()| Corner {
                position: vector(&mut random),
                normal: vector(&mut random).normalize(),
            }),
        }
    };
    (0..count).map(&mut make).collect()
}

/// The largest distance of what `center` makes of random triangles from their first corner: in shares of the radius,
/// and of the bound.
fn reach(center: impl Fn([Corner; 3]) -> Vec3) -> (f32, f32) {
    let shares = triangles(200_000, 1).into_iter().filter_map(|corners| {
        let (radius, c) = bound(corners)?;
        let share = (center(corners) - corners[0].position).length() / radius;
        Some((share, share / c))
    });
    shares.fold((0.0, 0.0), |a, b| (f32::max(a.0, b.0), f32::max(a.1, b.1)))
}

#[test]
fn the_constant_is_below_the_published_one() {
    let constants = (0..=1000).map(|i| c_beta((i as f32 * 0.001 * std::f32::consts::PI).cos()));
    let largest = constants.fold(0.0, f32::max);
    assert!((largest - (5.0 + 13f32.sqrt()) / 9.0).abs() < 1e-5 && largest < 0.96, "{largest}");
}

#[test]
fn new_points_of_any_triangle_keep_the_bound() {
    let (share, of_bound) = reach(displaced_center);
    println!("farthest at {share} of the radius, {of_bound} of the bound");
    assert!(of_bound <= 1.0, "a new point at {of_bound} of its bound");
    // Without the displacement none is beyond 2/3.
    assert!(
        share > 0.75,
        "the farthest new point is at {share} of the radius: no triangle stretches the bound"
    );
    let plain = reach(center_of_gravity).0;
    assert!(plain < 0.667, "{plain}");
    // The bound is one on the displacement: twice as much breaks it, and the radius with it.
    let twice = |t| 2.0 * displaced_center(t) - center_of_gravity(t);
    let (share, of_bound) = reach(twice);
    println!("displaced twice as far: {share}, {of_bound}");
    assert!(share > 1.0 && of_bound > 1.1, "displaced twice as far: {share}, {of_bound}");
}

#[test]
fn each_half_of_the_control_polygon_keeps_its_bound() {
    let mut largest = [0f32; 2];
    for corners in triangles(200_000, 2) {
        let Some((radius, c)) = bound(corners) else { continue };
        let [p, a, b] = corners;
        // ½(b_ij + b_ji) of the edge from one corner to the other.
        let half = |from: Corner, to: Corner| {
            let d = to.position - from.position;
            let tangents = tangent(d, from.normal) + tangent(-d, to.normal);
            0.5 * (from.position + to.position + tangents) - p.position
        };
        let sides = half(p, a).length().max(half(p, b).length()) / radius;
        let opposite = half(a, b).length() / radius / (3.0 * c - 5.0 / 3.0);
        largest = [largest[0].max(sides), largest[1].max(opposite)];
    }
    println!("halves at {largest:?}");
    // The paper says 5/6; see above for .6937.
    assert!(largest[0] < 0.694 && largest[0] > 0.68, "{largest:?}");
    assert!(largest[1] < 1.0001 && largest[1] > 0.97, "{largest:?}");
}

/// The shapes that the bound is shown on.
fn clouds() -> [(&'static str, PointSet); 5] {
    [
        ("sphere", blue_noise(Shape::Sphere, 600, 1)),
        ("torus", blue_noise(Shape::Torus, 1000, 1)),
        ("ellipsoid", blue_noise(Shape::Ellipsoid, 800, 1)),
        ("random sphere", random(Shape::Sphere, 600, 1)),
        ("random torus", random(Shape::Torus, 1000, 1)),
    ]
}

fn kept(params: RefineParams) -> RefineParams {
    RefineParams { keep_radii: true, ..params }
}

/// The largest share of its corners' radii at which a new point lies, and that over the bound.
fn new_points(refined: &Refined) -> (f32, f32) {
    let points = &refined.points;
    let corner = |i: u32| Corner {
        position: points.positions[i as usize],
        normal: points.normals[i as usize],
    };
    let mut largest = (0f32, 0f32);
    for (new, parents) in (refined.level_sizes[0]..).zip(&refined.parents) {
        for turn in 0..3 {
            let corners = [0, 1, 2].map(|i| corner(parents[(i + turn) % 3]));
            let (radius, c) = bound(corners).expect("corners are apart");
            let share = (points.positions[new] - corners[0].position).length() / radius;
            largest = (largest.0.max(share), largest.1.max(share / c));
        }
    }
    largest
}

#[test]
fn new_points_of_a_refinement_keep_the_bound_at_all_corners() {
    for (name, cloud) in clouds() {
        for (rules, params) in [("text", literal(3)), ("rules", levels(3))] {
            let (share, of_bound) = new_points(&refine(&cloud, &params));
            println!("{name}, {rules}: {share} of the radius, {of_bound} of the bound");
            assert!(of_bound <= 1.0, "{name}, {rules}: {of_bound} of the bound");
        }
    }
}

/// The largest factor from one level to the next of the radius of a point that both have, by step.
fn factors(refined: &Refined) -> Vec<f32> {
    let step =
        |w: &[Vec<f32>]| w[0].iter().zip(&w[1]).map(|(old, new)| new / old).fold(0.0, f32::max);
    refined.level_radii.windows(2).map(step).collect()
}

#[test]
fn by_the_text_no_radius_rises() {
    for (name, cloud) in clouds() {
        // The 1.02 is ours. Points that wait for no new neighbour keep their radius: these are the 1.
        let largest = factors(&refine(&cloud, &kept(literal(4)))).into_iter().fold(0.0, f32::max);
        // Measured .82 to .93 on even input, 1 on random: new neighbours of another fan may be farther than eq. 14
        // says.
        let most = if name.starts_with("random") { 1.02 } else { 0.9562 * 1.02 };
        assert!(largest <= most, "{name}: a radius times {largest}");
    }
}

#[test]
fn radii_and_co_cone_angles_fall_at_every_level() {
    for (name, cloud) in clouds() {
        for (rules, params) in [("text", literal(4)), ("rules", levels(4))] {
            let levels = Convergence::by_level(&refine(&cloud, &kept(params)));
            assert_eq!(levels.len(), 5);
            for pair in levels.windows(2) {
                let falls = |what, before: f64, after: f64, most: f64| {
                    let ratio = after / before;
                    assert!(ratio < most, "{name}, {rules}: {what} times {ratio}, {levels:?}");
                };
                let (before, after) = (pair[0], pair[1]);
                // Measured ratios up to .62, .61, .74, .63 and .63; 1/sqrt 3 is .577. The largest angle may rise.
                falls("median radius", before.radius.median, after.radius.median, 0.67);
                falls("mean radius", before.radius.mean, after.radius.mean, 0.67);
                falls("largest radius", before.radius.max, after.radius.max, 0.9);
                falls("median angle", before.angle.median, after.angle.median, 0.7);
                falls("mean angle", before.angle.mean, after.angle.mean, 0.7);
            }
        }
    }
}

#[test]
fn keeping_radii_changes_nothing_else() {
    let (_, cloud) = clouds().into_iter().last().expect("there are some");
    let (plain, mut with) = (refine(&cloud, &levels(2)), refine(&cloud, &kept(levels(2))));
    assert!(plain.level_radii.is_empty());
    let sizes: Vec<usize> = with.level_radii.iter().map(Vec::len).collect();
    assert_eq!(sizes, with.level_sizes);
    assert_eq!((&with.level_radii[0], &with.level_radii[2]), (&cloud.radii, &with.points.radii));
    with.level_radii.clear();
    assert_same_bytes(&plain, &with, "with the radii kept");
}
