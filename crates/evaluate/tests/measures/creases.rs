//! Sharp edges, open borders, and what else real meshes have.

use approx::assert_relative_eq;
use glam::Vec3Swizzles;
use surfine_evaluate::Truth;
use surfine_points::{DVec3, Model, Vec3};

use crate::scenes;

const SIDES: [DVec3; 6] = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];

/// The cube with vertices of each triangle's own.
fn unwelded_cube() -> Model {
    let cube = scenes::cube();
    let corners = cube.triangles.as_flattened().iter().map(|&c| cube.positions[c as usize]);
    scenes::mesh(corners.collect(), (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

#[test]
fn a_cube_has_a_normal_a_side() {
    for cube in [scenes::cube(), unwelded_cube()] {
        let truth = scenes::truth(&cube);
        assert_eq!((truth.summary().sharp_edges, truth.summary().triangles), (12, 12));
        assert_relative_eq!(truth.summary().area.unwrap(), 24.0, max_relative = 1e-14);
        for side in SIDES {
            // Right up to the edge the normal is that of the side, not of the vertices.
            for (along, up) in [(0.0, 0.0), (0.3, -0.7), (0.9999, 0.9), (-0.9999, 0.9999)] {
                let position = 1.1 * side + along * side.yzx() + up * side.zxy();
                let found = truth.nearest(position, None);
                assert_relative_eq!(found.normal.unwrap().dot(side), 1.0, epsilon = 1e-12);
                assert_relative_eq!(found.distance, 0.1, epsilon = 1e-12);
            }
        }
    }
}

#[test]
fn on_an_edge_the_side_that_was_asked_for_counts() {
    // As far from the origin as the edge of a file with 32-bit coordinates may be off.
    let step = f64::from(f32::EPSILON);
    for cube in [scenes::cube(), unwelded_cube()] {
        let truth = scenes::truth(&cube);
        for (side, other) in [(DVec3::X, DVec3::Y), (DVec3::Z, DVec3::NEG_X)] {
            let along = 0.3 * side.cross(other);
            for (a, b) in [(0.0, 0.0), (step, -step), (-step, step), (step, step), (-step, 0.0)] {
                let position = (1.0 + a) * side + (1.0 + b) * other + along;
                for wanted in [side, other] {
                    let found = truth.nearest(position, Some(wanted)).normal.unwrap();
                    assert_relative_eq!(found.dot(wanted), 1.0, epsilon = 1e-12);
                }
            }
        }
        // Three sides meet in a corner, and a normal between two takes the nearer.
        for wanted in [DVec3::X, DVec3::Y, DVec3::Z] {
            let tilted = (wanted + 0.3 * wanted.yzx()).normalize();
            for asked in [wanted, tilted] {
                let found = truth.nearest(DVec3::splat(1.0 + step), Some(asked)).normal.unwrap();
                assert_relative_eq!(found.dot(wanted), 1.0, epsilon = 1e-12);
            }
        }
        // Off the edge there is no choice.
        let off = DVec3::new(1.0, 0.999, 0.2);
        assert_relative_eq!(truth.nearest(off, Some(DVec3::Y)).normal.unwrap().x, 1.0);
    }
}

/// The sides of the cube on a grid of 21 by 21, each with its normal: edges twice, corners three times.
fn points_of_the_cube() -> Model {
    let steps = || (-10..=10).map(|i| f64::from(i) / 10.0);
    let place = |side: DVec3| move |(u, v): (f64, f64)| side + u * side.yzx() + v * side.zxy();
    let cells = || steps().flat_map(|u| steps().map(move |v| (u, v)));
    let positions = SIDES.into_iter().flat_map(|side| cells().map(place(side))).collect();
    let normals = SIDES.into_iter().flat_map(|side| cells().map(move |_| side.as_vec3()));
    Model { normals: Some(normals.collect()), ..scenes::cloud(positions) }
}

#[test]
fn a_cloud_with_a_record_for_each_side_of_a_crease_has_no_error() {
    let truth = scenes::truth(&scenes::cube());
    let output = points_of_the_cube();
    let found = scenes::measure(&output, &truth);
    // 8 corners, 12 edges of 19, 6 sides of 19 by 19.
    assert_eq!((found.output.points, found.output.positions), (2646, 2402));
    let normals = found.normals.unwrap();
    assert_eq!(normals.points, 2646);
    assert!(normals.all.max < 1e-6, "{normals:?}");
    // Neighbours across the edge are turned by 90°; the truth says that it is meant.
    let smoothness = found.smoothness.unwrap();
    assert_relative_eq!(smoothness.output.max, smoothness.truth.unwrap().max, epsilon = 1e-6);
    assert!(smoothness.output.max > 10.0, "{smoothness:?}");
    // In a row of one step from each edge, none is closer than a spacing of 0.1 and a little.
    let away = normals.away_from_creases.expect("there are sharp edges");
    assert!(away.points <= 6 * 19 * 19 && away.points >= 6 * 17 * 17, "{}", away.points);
}

#[test]
fn errors_near_creases_are_told_from_those_elsewhere() {
    let truth = scenes::truth(&scenes::cube());
    let mut output = points_of_the_cube();
    let on_edge = |p: DVec3| p.to_array().iter().filter(|c| c.abs() == 1.0).count() > 1;
    let mut turned = 0;
    for (&position, normal) in output.positions.iter().zip(output.normals.iter_mut().flatten()) {
        if on_edge(position) {
            *normal = position.as_vec3();
            turned += 1;
        }
    }
    assert_eq!(turned, 2646 - 6 * 19 * 19);
    let normals = scenes::measure(&output, &truth).normals.unwrap();
    assert!(normals.all.max > 44.0, "{normals:?}");
    assert!(normals.away_from_creases.unwrap().angles.max < 1e-6, "{normals:?}");
    // The crease angle is a choice: nothing of a cube is sharp at 100°.
    let smooth = Truth::with_crease_angle(&scenes::cube(), 100.0).expect("fit");
    assert_eq!(smooth.summary().sharp_edges, 0);
    let corner = smooth.nearest(DVec3::splat(2.0), None).normal.unwrap();
    assert_relative_eq!(corner.dot(DVec3::ONE.normalize()), 1.0, epsilon = 1e-12);
    assert_eq!(scenes::measure(&output, &smooth).normals.unwrap().away_from_creases, None);
}

#[test]
fn along_a_curved_edge_each_side_keeps_its_own_normals() {
    // A strip around a cylinder, 15° a step, and its flat top.
    let mut mesh = scenes::grid(24, 1, |u, v| {
        let (sine, cosine) = (u % 1.0 * std::f64::consts::TAU).sin_cos();
        DVec3::new(cosine, sine, v)
    });
    let middle = mesh.len() as u32;
    mesh.positions.push(DVec3::Z);
    mesh.triangles.extend((25..49).map(|i| [i, i + 1, middle]));
    let truth = scenes::truth(&mesh);
    assert_eq!(truth.summary().sharp_edges, 24);
    let (a, b) = (mesh.positions[25], mesh.positions[26]);
    for share in [0.1, 0.25, 0.8] {
        let position = a.lerp(b, share);
        // Vertex normals are radial, and between two of them the mean by distance.
        let round = (a.lerp(b, share) - DVec3::Z).normalize();
        for wanted in [round, DVec3::Z] {
            let found = truth.nearest(position, Some(wanted)).normal.unwrap();
            assert_relative_eq!(found.dot(wanted), 1.0, epsilon = 1e-9);
        }
    }
}

#[test]
fn a_truth_of_records_shows_the_side_that_was_asked_for() {
    let truth = scenes::truth(&points_of_the_cube());
    let edge = DVec3::new(1.0, 1.0, 0.5);
    for wanted in [DVec3::X, DVec3::Y] {
        let found = truth.nearest(edge + 0.01 * wanted, Some(wanted));
        assert_eq!(found.normal, Some(wanted));
        assert_relative_eq!(found.distance, 0.01, epsilon = 1e-12);
    }
    assert!(!truth.crease_within(edge, 1.0), "a cloud has no edges");
}

#[test]
fn creases_are_within_their_distance_only() {
    let truth = scenes::truth(&scenes::cube());
    let position = DVec3::new(1.0, 0.75, 0.0);
    assert!(truth.crease_within(position, 0.26));
    assert!(!truth.crease_within(position, 0.24));
    // The diagonals of the sides are edges, but flat.
    assert!(!truth.crease_within(DVec3::new(1.0, 0.0, 0.0), 0.9));
}

#[test]
fn beyond_an_open_border_the_rim_is_closest() {
    let truth = scenes::truth(&scenes::square());
    assert_eq!(truth.summary().sharp_edges, 0, "a border is no crease");
    let found = truth.nearest(DVec3::new(4.0, 0.25, -4.0), Some(DVec3::NEG_Z));
    assert_eq!(found.position, DVec3::new(1.0, 0.25, 0.0));
    assert_eq!((found.distance, found.normal), (5.0, Some(DVec3::Z)));
    // An output that ends before the border leaves a strip bare.
    let short = scenes::grid(40, 40, |u, v| DVec3::new(2.0 * u - 1.0, 1.5 * v - 1.0, 0.0));
    let output = Model { triangles: Vec::new(), ..short };
    let coverage = scenes::measure(&output, &truth).coverage;
    assert!((0.49..=0.51).contains(&coverage.max_distance), "{coverage:?}");
    // A strip of a fourth of the square, less a spacing of about 0.05 of 2 beside it.
    assert!((0.21..0.25).contains(&coverage.over_1), "{coverage:?}");
}

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let mut mesh = scenes::square();
    let whole = scenes::truth(&mesh);
    mesh.positions.push(mesh.positions[0]);
    mesh.positions.push((mesh.positions[0] + mesh.positions[1]) / 2.0);
    mesh.positions.push(DVec3::splat(100.0));
    mesh.triangles.extend([[0, 0, 1], [0, 1, 4], [0, 1, 5], [6, 6, 6]]);
    let truth = scenes::truth(&mesh);
    assert_eq!((truth.summary().triangles, truth.summary().degenerate_triangles), (2, 4));
    assert_eq!(truth.summary().area, whole.summary().area);
    // The vertex far away is of no triangle that is left.
    assert_eq!(truth.summary().diagonal, whole.summary().diagonal);
    let x = DVec3::new(0.3, 3.0, 2.0);
    assert_eq!(truth.nearest(x, None), whole.nearest(x, None));
}

#[test]
fn triangles_that_show_their_back_are_noticed() {
    let mut mesh = scenes::square();
    assert_eq!(scenes::truth(&mesh).summary().inconsistent_edges, 0);
    mesh.triangles[1].swap(0, 1);
    let summary = scenes::truth(&mesh).summary().clone();
    assert_eq!((summary.inconsistent_edges, summary.sharp_edges), (1, 1));
}

#[test]
fn normals_of_the_mesh_file_do_not_count() {
    let mut mesh = scenes::square();
    mesh.normals = Some(vec![Vec3::X; mesh.len()]);
    let found = scenes::truth(&mesh).nearest(DVec3::new(0.1, 0.2, 0.3), None);
    assert_eq!(found.normal, Some(DVec3::Z));
}
