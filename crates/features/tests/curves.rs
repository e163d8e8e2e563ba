//! What is found on clouds whose curves are known, and how they are split.

use std::collections::BTreeMap;

use surfine_features::{Cloud, Features, Gap, NONE, Records, Refinement, fold};
use surfine_points::shapes::{Outlined, Sampling, one_record_a_normal, sample_outlined};
use surfine_points::{PointSet, Values, Vec3};

fn records(points: &PointSet) -> Records {
    Records::split(points).expect("generated clouds are fit")
}

fn cloud(records: &Records) -> Cloud<'_> {
    let Records { positions, normals, radii, .. } = records;
    Cloud { positions, normals, radii }
}

fn creases(points: &PointSet) -> Features {
    let records = records(points);
    Features::creases(cloud(&records), &records.groups)
}

fn cube() -> PointSet {
    sample_outlined(Outlined::Cube, Sampling::BlueNoise, 400, 1)
}

/// Which of the coordinates are those of a cube's edge, with their signs.
fn edge_of(x: Vec3) -> Vec<(usize, bool)> {
    (0..3).filter(|&i| x[i].abs() == 0.5).map(|i| (i, x[i] > 0.0)).collect()
}

#[test]
fn records_of_both_conventions_are_the_same_places() {
    let points = cube();
    let (one, other) = (records(&points), records(&one_record_a_normal(&points)));
    assert_eq!(one.len(), other.len());
    assert_eq!(one.groups.len(), other.groups.len());
    let corners = |records: &Records| records.groups.iter().filter(|g| g.len() == 3).count();
    assert_eq!((corners(&one), corners(&other)), (8, 8));
    assert_eq!(one.owners.len(), one.len() - points.len());
    assert!(other.owners.is_empty(), "no normal is a property");
}

#[test]
fn segments_of_a_cube_are_its_twelve_edges() {
    let features = creases(&cube());
    let counts = features.counts();
    assert_eq!(counts.corners, 8);
    assert_eq!(counts.crease_segments, counts.crease_points + 12);
    let mut by_edge: BTreeMap<Vec<(usize, bool)>, usize> = BTreeMap::new();
    for segment in &features.segments {
        assert!(!segment.is_boundary());
        let ends = segment.sides[0].map(|r| features.records[r as usize].position);
        let edge = edge_of((ends[0] + ends[1]) * 0.5);
        assert_eq!(edge.len(), 2, "{ends:?} is no piece of an edge");
        *by_edge.entry(edge).or_default() += 1;
        // Both sides have the normal of one face at both ends.
        for side in segment.sides {
            let [a, b] = side.map(|r| features.records[r as usize].normal);
            assert_eq!(a, b);
        }
    }
    assert_eq!(by_edge.len(), 12);
    let per_edge = counts.crease_points / 12 + 1;
    assert!(by_edge.values().all(|&n| n == per_edge), "{by_edge:?}");
    // Every record lies between two segments of its side, corners too.
    assert!(features.records.iter().all(|r| r.partners.iter().all(|&p| p != NONE)));
}

#[test]
fn conormals_of_a_cube_point_into_its_faces() {
    for record in creases(&cube()).records {
        // Towards the middle of the face to which the normal belongs.
        let inward = record.normal * 0.5 - record.position;
        assert!(record.conormal.dot(inward.normalize()) > 0.5, "{record:?}");
        assert!(record.conormal.dot(record.normal).abs() < 1e-6, "{record:?}");
    }
}

/// A prism along y over an L: its faces meet in convex edges and, at x = z = 0, in a groove.
fn groove(depth: i32) -> (PointSet, Vec<usize>) {
    let mut points = PointSet::default();
    let (mut seconds, mut edge) = (Vec::new(), Vec::new());
    let s = 0.1;
    for y in -depth..=depth {
        for k in 0..=8 {
            let y = y as f32 * s;
            // The floor z = 0 for x >= 0, the wall x = 0 for z >= 0.
            if k == 0 {
                edge.push(points.positions.len());
                seconds.push((points.positions.len(), Vec3::X));
            }
            points.positions.push(Vec3::new(k as f32 * s, y, 0.0));
            points.normals.push(Vec3::Z);
            if k > 0 {
                points.positions.push(Vec3::new(0.0, y, k as f32 * s));
                points.normals.push(Vec3::X);
            }
        }
    }
    points.radii = vec![0.18; points.positions.len()];
    for (axis, name) in ["nx2", "ny2", "nz2"].into_iter().enumerate() {
        let mut values = vec![0.0; points.positions.len()];
        seconds.iter().for_each(|&(i, n)| values[i] = n[axis]);
        points.attributes.push(surfine_points::Attribute::new(name, Values::F32(values)));
    }
    (points, edge)
}

#[test]
fn conormals_of_a_groove_point_out_of_the_solid() {
    let (points, edge) = groove(4);
    let features = creases(&points);
    assert_eq!(features.records.len(), 2 * edge.len());
    for record in &features.records {
        // The floor runs along +x and the wall along +z: each towards the other's normal.
        let expected = if record.normal == Vec3::Z { Vec3::X } else { Vec3::Z };
        assert!((record.conormal - expected).length() < 1e-6, "{record:?}");
    }
}

#[test]
fn a_ridge_and_a_groove_differ_in_their_points_alone() {
    // The same normals on the same line, with the faces on the other side of it.
    let (mut points, _) = groove(4);
    points.positions.iter_mut().for_each(|x| (x.x, x.z) = (-x.x, -x.z));
    for record in creases(&points).records {
        let expected = if record.normal == Vec3::Z { Vec3::NEG_X } else { Vec3::NEG_Z };
        assert!((record.conormal - expected).length() < 1e-6, "{record:?}");
    }
}

/// Points around a unit circle in the plane z = 0 that see all of the rim as a gap, counter-clockwise.
fn ring_of(count: u32) -> (Records, Vec<Gap>) {
    let at = |k: u32| {
        let angle = std::f32::consts::TAU * k as f32 / count as f32;
        Vec3::new(angle.cos(), angle.sin(), 0.0)
    };
    let positions: Vec<Vec3> = (0..count).map(at).collect();
    let n = positions.len();
    let points = PointSet::new(positions, vec![Vec3::Z; n], vec![0.5; n]);
    // The sheet is inside: seen from a point, the gap runs counter-clockwise from the point before it to the one after.
    let gap =
        |k: u32| Gap { point: k, begin: (k + count - 1) % count, end: (k + 1) % count, angle: 3.5 };
    (records(&points), (0..count).map(gap).collect())
}

#[test]
fn a_boundary_is_a_chain_of_gaps() {
    let (records, gaps) = ring_of(12);
    let mut features = Features::default();
    features.add_boundary(cloud(&records), &gaps);
    assert_eq!((features.records.len(), features.segments.len()), (12, 12));
    for record in &features.records {
        assert!(record.is_boundary());
        let towards_sheet = record.conormal.dot(-record.position);
        assert!(towards_sheet > 0.99, "{record:?}");
    }
}

#[test]
fn short_chains_are_no_boundary() {
    let (records, gaps) = ring_of(12);
    for (points, segments) in [(2, 0), (4, 0), (5, 4), (6, 5)] {
        let mut features = Features::default();
        features.add_boundary(cloud(&records), &gaps[..points]);
        assert_eq!(features.segments.len(), segments, "{points} points");
        assert_eq!(features.records.len(), if segments == 0 { 0 } else { points });
    }
    // Three points in a circle are a chain of three, however often one goes round.
    for (points, segments) in [(3, 0), (4, 4)] {
        let (records, gaps) = ring_of(points);
        let mut features = Features::default();
        features.add_boundary(cloud(&records), &gaps);
        assert_eq!(features.segments.len(), segments, "around {points} points");
    }
}

#[test]
fn the_widest_gap_is_the_first_of_equals_and_wraps() {
    let ring = [(7, 0.5f32), (8, 1.5), (9, 2.5)];
    let gap = Gap::widest(3, ring.into_iter()).expect("there are three members");
    assert_eq!((gap.point, gap.begin, gap.end), (3, 9, 7));
    assert!((gap.angle - (std::f32::consts::TAU - 2.0)).abs() < 1e-6);
    let even = [(4, 0.0f32), (5, 1.0), (6, 2.0)];
    assert_eq!(Gap::widest(0, even[..1].iter().copied()), None);
    let first = Gap::widest(0, [(1, 0.0), (2, 2.0), (3, 4.0), (4, 5.5)].into_iter());
    assert_eq!(first.map(|g| (g.begin, g.end)), Some((1, 2)));
}

#[test]
fn thirds_of_a_cylinders_circle_lie_on_it() {
    let points = sample_outlined(Outlined::Cylinder, Sampling::BlueNoise, 400, 1);
    let mut features = creases(&points);
    let segments = features.segments.clone();
    let length = {
        let [a, b] = segments[0].sides[0].map(|r| features.records[r as usize].position);
        f64::from((b - a).length())
    };
    let new = features.split();
    assert_eq!(new.len(), 4 * segments.len(), "two points with two sides each");
    for pair in new.chunks(2) {
        assert_eq!(pair[0].position, pair[1].position);
        let x = pair[0].position.as_dvec3();
        // A cubic with the tangents of the circle is off by the fourth power of the angle.
        let off = (x.x.hypot(x.y) - 0.5).hypot(x.z.abs() - 0.5);
        assert!(off < 2e-3 * length, "{x} is {} of its segment off", off / length);
        let normals = [pair[0].normal, pair[1].normal];
        assert!(normals.iter().any(|n| n.z.abs() > 0.999), "{normals:?}");
        assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
        let ahead = f64::from(pair[0].radius) / (length / 3.0);
        assert!((1.0..1.1).contains(&ahead), "the radius covers {ahead} thirds");
        assert!((f64::from(pair[0].rho) / (length / 2.0) - 1.0).abs() < 1e-3);
    }
}

#[test]
fn pieces_join_to_the_same_curves() {
    let points = cube();
    let mut features = creases(&points);
    let (points_before, before) = (records(&points).len(), features.segments.len());
    for step in 1..=2 {
        let (old, new) = (features.old, features.split());
        assert_eq!(features.records.len(), old + new.len());
        features.commit(points_before + old);
        assert_eq!(features.segments.len(), before * 3usize.pow(step));
        assert_eq!(features.old, features.records.len());
        for (i, record) in features.records.iter().enumerate() {
            assert_eq!(record.segment, NONE);
            for &partner in &record.partners {
                let other = features.records[partner as usize];
                assert!(other.partners.contains(&(i as u32)), "{i} and {partner}");
                assert_eq!(other.normal, record.normal, "along one side");
            }
        }
    }
    assert_eq!(features.counts().corners, 8);
}

#[test]
fn folded_points_have_the_normals_and_the_largest_radius_of_their_sides() {
    let mut points = PointSet::new(vec![Vec3::ZERO; 4], vec![Vec3::Z; 4], vec![1.5; 4]);
    points.positions.iter_mut().zip(0..).for_each(|(x, i)| x.y = i as f32);
    for (name, value) in [("nx2", 1.0), ("ny2", 0.0), ("nz2", 0.0)] {
        let values = Values::F32(vec![value; 4]);
        points.attributes.push(surfine_points::Attribute::new(name, values));
    }
    points.attributes.push(surfine_points::Attribute::new("kind", Values::U8(vec![1; 4])));
    let split = records(&points);
    let mut features = Features::creases(cloud(&split), &split.groups);
    assert_eq!((split.len(), features.segments.len()), (8, 3));
    let new = features.split();
    features.commit(split.len());
    let radii = (0..8 + new.len()).map(|i| 2.0 + i as f32).collect();
    let refined = Refinement {
        positions: split.positions.iter().copied().chain(new.iter().map(|p| p.position)).collect(),
        normals: split.normals.iter().copied().chain(new.iter().map(|p| p.normal)).collect(),
        radii,
        parents: new.iter().map(|p| p.parents).collect(),
        level_sizes: vec![8, 8 + new.len()],
        level_radii: Vec::new(),
    };
    let folded = fold(&points, &split, &features, refined, None);
    assert_eq!(folded.level_sizes, [4, 4 + 6]);
    assert_eq!(folded.points.len(), 10);
    // Records 0 and 4 are the two sides of point 0, with radii 2 and 6; the first new point has records 8 and 9.
    assert_eq!(folded.points.radii[0], 6.0);
    assert_eq!(folded.points.radii[4], 11.0);
    assert_eq!(folded.parents[0], [0, 0, 1], "the nearer end twice");
    let Some(Values::F32(second)) = folded.points.attribute("nx2").map(|a| &a.values) else {
        panic!("nx2 is gone")
    };
    for (normal, second) in folded.points.normals.iter().zip(second).skip(4) {
        let sides = [normal.x, *second];
        assert!((sides[0] + sides[1] - 1.0).abs() < 1e-6, "one side each: {sides:?}");
    }
    assert_eq!(folded.points.attribute("kind").map(|a| &a.values), Some(&Values::U8(vec![1; 10])));
}
