//! Sheets of opposite sides in one place, and new points that land on old ones.

use surfine_points::shapes::Shape;
use surfine_points::{PointSet, Refined, Vec3};

use crate::clouds::{blue_noise, joined, levels, random, refine};
use crate::degenerate::assert_sound;
use crate::measure::growths;

#[test]
fn a_new_point_on_top_of_an_old_one_leaves_it_a_radius() {
    // A flat triangle, and in its centre a point of the other side that is no neighbour of its corners (eq. 6): the
    // candidate of the triangle falls on that point.
    let below = Vec3::new(0.2, 0.2, -1.0).normalize();
    let positions = [[0.0, 0.0], [3.0, 0.0], [0.0, 3.0], [1.0, 1.0]];
    let positions = positions.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec();
    let normals = vec![Vec3::Z, Vec3::Z, Vec3::Z, below];
    let refined = refine(&PointSet::new(positions, normals, vec![5.0; 4]), &levels(1));
    assert_eq!(refined.parents, [[0, 1, 2]]);
    assert_eq!(refined.points.positions[4], refined.points.positions[3], "the case that is meant");
    assert_sound(&refined);
}

/// A sphere and one inside it whose normals point inward: a shell of this thickness, outer points first.
fn shell(outer: PointSet, mut inner: PointSet, thickness: f32) -> PointSet {
    inner.positions.iter_mut().for_each(|p| *p *= 1.0 - thickness);
    inner.normals.iter_mut().for_each(|n| *n = -*n);
    joined(outer, &inner)
}

/// Fails if a new point has corners of both sides, or a normal of the other side.
#[track_caller]
fn assert_sides_keep_apart(refined: &Refined, what: &str) {
    let points = &refined.points;
    let outward = |p: usize| points.normals[p].dot(points.positions[p]) > 0.0;
    for (i, corners) in refined.parents.iter().enumerate() {
        let [a, b, c] = corners.map(|c| outward(c as usize));
        assert!(a == b && b == c, "{what}: new point {i} has corners of both sides");
        let turned = outward(refined.level_sizes[0] + i) != a;
        assert!(!turned, "{what}: the normal of new point {i} is turned over");
    }
}

#[test]
fn sheets_of_opposite_sides_share_no_triangle() {
    // Spacing .16: the thinner shells are far thinner than that. Without eq. 6 half of the triangles have corners of
    // both sides.
    for thickness in [0.3, 0.1, 0.05, 0.02] {
        let [even, other] = [1, 2].map(|seed| blue_noise(Shape::Sphere, 500, seed));
        let refined = refine(&shell(even, other, thickness), &levels(2));
        assert_sides_keep_apart(&refined, &format!("shell of {thickness}"));
        let [one, other] = [1, 2].map(|seed| random(Shape::Sphere, 500, seed));
        let refined = refine(&shell(one, other, thickness), &levels(2));
        assert_sides_keep_apart(&refined, &format!("random shell of {thickness}"));
    }
}

#[test]
fn two_sides_in_the_same_places_share_no_triangle() {
    let sphere = blue_noise(Shape::Sphere, 300, 1);
    let refined = refine(&shell(sphere.clone(), sphere, 0.0), &levels(2));
    assert_sides_keep_apart(&refined, "no thickness");
    // Both sides discard each other's candidates; measured 1.99 and 2.36 instead of the 2.98 of a single one.
    for growth in growths(&refined) {
        assert!((1.8..3.0).contains(&growth), "growth {growth}");
    }
    assert_sound(&refined);
}
