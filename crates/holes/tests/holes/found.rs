//! Which loops are found.

use crate::clouds::{even, two_holes, without};
use surfine_holes::{Kind, loops};
use surfine_points::shapes::{Sampling, Shape, hexagonal_grid, icosphere, sample};
use surfine_points::{Attribute, PointSet, Values, Vec3};

#[test]
fn closed_surfaces_have_none() {
    for shape in [Shape::Sphere, Shape::Torus, Shape::Ellipsoid] {
        assert_eq!(loops(&even(shape, 1500)), [], "{shape}");
        for seed in 0..4 {
            let random = sample(shape, Sampling::Random, 2000, seed);
            assert_eq!(loops(&random), [], "random {shape}, seed {seed}");
        }
    }
    assert_eq!(loops(&icosphere(3)), []);
}

#[test]
fn clouds_of_few_points_have_none() {
    for count in 0..4 {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE].into_iter().take(count).collect();
        assert_eq!(loops(&PointSet::new(positions, vec![Vec3::Z; count], vec![2.0; count])), []);
    }
}

#[test]
fn outlines_are_outer_rims() {
    for cloud in [even(Shape::Plane, 600), even(Shape::Saddle, 1500), hexagonal_grid(8)] {
        let found = loops(&cloud);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].kind(), Kind::OuterRim, "{}", found[0].turning);
    }
}

#[test]
fn the_rim_of_a_hemisphere_is_undecided() {
    let found = loops(&without(&even(Shape::Sphere, 1500), Vec3::NEG_Z, 2f32.sqrt()));
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].kind(), Kind::Undecided, "{}", found[0].turning);
    assert!(
        (found[0].span - 2.0).abs() < 0.1
            && (found[0].perimeter - std::f32::consts::TAU).abs() < 0.6
    );
}

#[test]
fn holes_are_numbered_by_span_and_turn_by_the_angle_of_their_cone() {
    let found = loops(&two_holes());
    assert_eq!(found.iter().map(|hole| hole.id).collect::<Vec<_>>(), [1, 2]);
    for (hole, (chord, height)) in found.iter().zip([(0.6f32, 1.0), (0.3, -1.0)]) {
        assert_eq!(hole.kind(), Kind::Hole);
        // A chord c from the pole spans a circle of diameter 2 c √(1 - c²/4), a little less than what is left of it.
        let across = 2.0 * chord * (1.0 - 0.25 * chord * chord).sqrt();
        let longer = hole.span / across;
        assert!((1.0..1.25).contains(&longer), "span {} of {across}", hole.span);
        // Gauss and Bonnet: the turning of a circle on the sphere is 2π cos θ = 2π (1 - c²/2).
        let turning = std::f32::consts::TAU * (1.0 - 0.5 * chord * chord);
        assert!((hole.turning - turning).abs() < 0.4, "{} of {turning}", hole.turning);
        let cloud = two_holes();
        assert!(hole.points.iter().all(|&p| cloud.positions[p as usize].z * height > 0.7));
    }
}

#[test]
fn open_sides_are_to_the_right_of_a_loop() {
    let cloud = without(&even(Shape::Plane, 1500), Vec3::ZERO, 0.4);
    let hole = loops(&cloud).into_iter().find(|found| found.kind() == Kind::Hole).unwrap();
    let around = |i: usize| {
        let at = |i: usize| cloud.positions[hole.points[i % hole.points.len()] as usize];
        at(i).cross(at(i + 1)).z
    };
    assert!((0..hole.points.len()).map(around).sum::<f32>() < 0.0);
}

#[test]
fn creases_are_no_loops() {
    // A plane folded along x = 0, where each side has its own points or one point has both normals.
    let side = even(Shape::Plane, 800);
    let line = (0..30).map(|i| Vec3::new(0.0, i as f32 / 14.5 - 1.0, 0.0));
    let fold = |x: &Vec3| if x.x > 0.0 { Vec3::new(0.0, x.y, -x.x) } else { *x };
    let normal = |x: &Vec3| if x.x > 0.0 { Vec3::X } else { Vec3::Z };
    let off: Vec<Vec3> = side.positions.into_iter().filter(|x| x.x.abs() > 0.04).collect();
    let positions: Vec<Vec3> = off.iter().map(fold).chain(line.clone()).collect();
    let normals: Vec<Vec3> = off.iter().map(normal).chain(line.clone().map(|_| Vec3::Z)).collect();
    let one_side = positions.clone();
    let radii = |positions: &[Vec3]| vec![0.16; positions.len()];
    let doubled: Vec<Vec3> = positions.into_iter().chain(line.clone()).collect();
    let both: Vec<Vec3> = normals.iter().copied().chain(line.clone().map(|_| Vec3::X)).collect();
    let holes =
        |cloud: &PointSet| loops(cloud).iter().filter(|found| found.kind() == Kind::Hole).count();
    let twice = PointSet::new(doubled.clone(), both, radii(&doubled));
    let mut more = PointSet::new(one_side.clone(), normals, radii(&one_side));
    for (name, value) in [("nx2", 1.0), ("ny2", 0.0), ("nz2", 0.0)] {
        let values = (0..more.len()).map(|i| if i >= off.len() { value } else { 0.0 }).collect();
        more.attributes.push(Attribute::new(name, Values::F32(values)));
    }
    assert_eq!((holes(&twice), holes(&more)), (0, 0));
}
