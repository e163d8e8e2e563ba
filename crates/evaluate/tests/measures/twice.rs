//! Everything computed a second time, all pairs and all triangles, by other formulas.

use approx::assert_relative_eq;
use surfine_evaluate::{Evaluation, Options, Spread, Truth, TruthKind, errors, evaluate};
use surfine_points::shapes::{Sampling, Shape};
use surfine_points::{DVec3, Model, Vec3};

use crate::scenes;

/// Coordinates from -1 to 1.
fn anywhere(random: &mut fastrand::Rng) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| 2.0 * random.f64() - 1.0))
}

fn to_segment(x: DVec3, a: DVec3, b: DVec3) -> f64 {
    let share = ((x - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    x.distance(a + (b - a) * share)
}

/// The foot on the plane solves two linear equations; where it is outside, a side is closest.
fn to_triangle(x: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (u, v, w) = (b - a, c - a, x - a);
    let (uu, uv, vv, wu, wv) = (u.dot(u), u.dot(v), v.dot(v), w.dot(u), w.dot(v));
    let determinant = uu * vv - uv * uv;
    let (s, t) = ((vv * wu - uv * wv) / determinant, (uu * wv - uv * wu) / determinant);
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        return x.distance(a + u * s + v * t);
    }
    to_segment(x, a, b).min(to_segment(x, b, c)).min(to_segment(x, c, a))
}

fn to_mesh(x: DVec3, mesh: &Model) -> f64 {
    let triangles = mesh.triangles.iter().map(|t| t.map(|c| mesh.positions[c as usize]));
    triangles.map(|corners| to_triangle(x, corners)).fold(f64::INFINITY, f64::min)
}

fn to_points(x: DVec3, points: &[DVec3]) -> f64 {
    points.iter().map(|p| p.distance(x)).fold(f64::INFINITY, f64::min)
}

/// Indices of the others, nearest first.
fn others(points: &[DVec3], of: usize) -> Vec<usize> {
    let mut others: Vec<usize> = (0..points.len()).filter(|&i| i != of).collect();
    let distance = |i: &usize| points[*i].distance(points[of]);
    others.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    others
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn max(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn degrees(a: DVec3, b: DVec3) -> f64 {
    a.normalize().dot(b.normalize()).clamp(-1.0, 1.0).acos().to_degrees()
}

#[track_caller]
fn assert_spread(found: Spread, mut values: Vec<f64>) {
    assert_relative_eq!(found.mean, mean(&values), max_relative = 1e-9);
    let squares: Vec<f64> = values.iter().map(|v| v * v).collect();
    assert_relative_eq!(found.rms, mean(&squares).sqrt(), max_relative = 1e-9);
    assert_relative_eq!(found.max, max(&values), max_relative = 1e-9);
    values.sort_by(f64::total_cmp);
    let rank = (1..=values.len()).find(|&r| r as f64 >= 0.95 * values.len() as f64);
    assert_relative_eq!(found.p95, values[rank.unwrap() - 1], max_relative = 1e-9);
}

/// A smooth closed mesh, an open one, and triangles of all shapes without order.
fn meshes() -> [Model; 3] {
    let mut random = fastrand::Rng::with_seed(11);
    let soup: Vec<DVec3> = (0..300).map(|_| anywhere(&mut random)).collect();
    let triangles = (0..100).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let open = scenes::grid(9, 9, |u, v| DVec3::new(u, v, 0.3 * (5.0 * u).sin() * v) - 0.5);
    [scenes::torus(24, 12), open, scenes::mesh(soup, triangles)]
}

#[test]
fn distances_to_meshes_are_those_of_all_triangles() {
    let mut random = fastrand::Rng::with_seed(12);
    for mesh in meshes() {
        let truth = scenes::truth(&mesh);
        assert_eq!(truth.summary().kind, TruthKind::Mesh);
        let output = scenes::cloud((0..500).map(|_| 1.5 * anywhere(&mut random)).collect());
        let expected: Vec<f64> = output.positions.iter().map(|&x| to_mesh(x, &mesh)).collect();
        let found = errors(&output, &truth).expect("the output is fit");
        for (&found, &expected) in found.iter().zip(&expected) {
            assert_relative_eq!(found, expected, epsilon = 1e-12);
        }
        for (&x, &expected) in output.positions.iter().zip(&expected) {
            let closest = truth.nearest(x, None);
            assert_relative_eq!(closest.position.distance(x), expected, epsilon = 1e-12);
            assert!(to_mesh(closest.position, &mesh) < 1e-12, "{closest:?} is off the mesh");
        }
        let distance = scenes::measure(&output, &truth).distance;
        assert_spread(distance.absolute, expected.clone());
        let (low, high) = mesh.bounds().expect("there are vertices");
        let diagonal = (high - low).length();
        assert_spread(distance.in_diagonals, expected.iter().map(|d| d / diagonal).collect());
    }
}

#[test]
fn distances_to_a_mesh_far_from_the_origin_keep_their_digits() {
    let far = DVec3::new(4.5e6, -5.2e6, 3.1e3);
    let (near, mut moved) = (scenes::torus(24, 12), scenes::torus(24, 12));
    moved.positions.iter_mut().for_each(|p| *p += far);
    let truth = scenes::truth(&moved);
    let output = scenes::points(Shape::Torus, Sampling::Random, 200, 3);
    for &x in &output.positions {
        let found = truth.nearest(x + far, None).distance;
        assert_relative_eq!(found, to_mesh(x, &near), epsilon = 2e-9);
    }
}

#[test]
fn smooth_meshes_have_their_vertex_normals() {
    let mesh = scenes::torus(48, 24);
    let truth = scenes::truth(&mesh);
    assert_eq!(truth.summary().sharp_edges, 0);
    // The seams are doubled in the file: their sums are those of both copies.
    let split = mesh.vertex_normals();
    let same = |a: DVec3, b: DVec3| a.distance(b) < 1e-9;
    for (&position, &normal) in mesh.positions.iter().zip(&split) {
        let copies = mesh.positions.iter().filter(|&&p| same(p, position)).count();
        if copies == 1 {
            let found = truth.nearest(position, None).normal.expect("meshes have normals");
            assert_relative_eq!(found.dot(normal), 1.0, epsilon = 1e-12);
        }
    }
    // Inside a triangle: the mean of its corners', weighted.
    let t = mesh.triangles[300].map(|c| c as usize);
    let weights = [0.2, 0.5, 0.3];
    let blend = |of: &[DVec3]| (0..3).map(|i| of[t[i]] * weights[i]).sum::<DVec3>();
    let found = truth.nearest(blend(&mesh.positions), None).normal.expect("meshes have normals");
    assert_relative_eq!(found.dot(blend(&split).normalize()), 1.0, epsilon = 1e-12);
}

/// An output whose points and normals are off the truth, and the truth.
fn rough_pair() -> (Model, Model) {
    let mut random = fastrand::Rng::with_seed(13);
    let truth = scenes::points(Shape::Ellipsoid, Sampling::BlueNoise, 500, 1);
    let mut output = scenes::points(Shape::Ellipsoid, Sampling::Random, 300, 2);
    output.positions.iter_mut().for_each(|p| *p += 0.03 * anywhere(&mut random));
    for normal in output.normals.iter_mut().flatten() {
        // Of no unit length: measures normalise.
        *normal = 3.0 * *normal + anywhere(&mut random).as_vec3();
    }
    (output, truth)
}

/// The index of the point that is nearest to `x`.
fn nearest(x: DVec3, points: &[DVec3]) -> usize {
    let distance = |i: usize| points[i].distance(x);
    (0..points.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap()
}

/// The rough pair with its neighbours, found among all pairs, and what is measured of it.
struct Pairs {
    output: Vec<DVec3>,
    truth: Vec<DVec3>,
    output_normals: Vec<DVec3>,
    truth_normals: Vec<DVec3>,
    /// For each point of the output the one of the truth that is nearest.
    nearest: Vec<usize>,
    /// For each point of the output the other ones, nearest first.
    others: Vec<Vec<usize>>,
    found: Evaluation,
}

impl Pairs {
    fn new() -> Self {
        let (output, truth) = rough_pair();
        let found = scenes::measure(&output, &scenes::truth(&truth));
        let directions = |m: &Model| -> Vec<DVec3> {
            m.normals.iter().flatten().map(|n| n.as_dvec3().normalize()).collect()
        };
        let (p, g) = (&output.positions, &truth.positions);
        Self {
            output_normals: directions(&output),
            truth_normals: directions(&truth),
            nearest: p.iter().map(|&x| nearest(x, g)).collect(),
            others: (0..p.len()).map(|i| others(p, i)).collect(),
            found,
            output: output.positions,
            truth: truth.positions,
        }
    }

    /// The distances to the nearest other points of the output.
    fn to_others(&self, i: usize) -> impl Iterator<Item = f64> {
        self.others[i].iter().map(move |&j| self.output[i].distance(self.output[j]))
    }

    /// The angles between the normals of the points of the output and others, degrees.
    fn turns(&self, normal: impl Fn(usize) -> DVec3, other: impl Fn(usize) -> DVec3) -> Vec<f64> {
        (0..self.output.len()).map(|i| degrees(normal(i), other(i))).collect()
    }

    /// The same from the mean of the eight neighbours' normals.
    fn bends(&self, normal: impl Fn(usize) -> DVec3) -> Vec<f64> {
        let around = |i: usize| self.others[i][..8].iter().map(|&j| normal(j)).sum();
        self.turns(&normal, around)
    }
}

#[test]
fn distances_to_the_planes_of_a_cloud_are_those_of_all_pairs() {
    let Pairs { output, truth, truth_normals, nearest, found, .. } = Pairs::new();
    let planes = nearest.iter().zip(&output).map(|(&j, &x)| (x - truth[j]).dot(truth_normals[j]));
    assert_eq!(found.truth.kind, TruthKind::TangentPlanes);
    assert_spread(found.distance.absolute, planes.map(f64::abs).collect());
}

#[test]
fn gaps_and_spacings_are_those_of_all_pairs() {
    let pairs = Pairs::new();
    let Pairs { output, truth, found, .. } = &pairs;
    let spacing = |i: usize| pairs.to_others(i).take(6).sum::<f64>() / 6.0;
    let spacings: Vec<f64> = (0..output.len()).map(spacing).collect();
    assert_relative_eq!(found.output.spacing, mean(&spacings), max_relative = 1e-9);
    let ratio = |&x: &DVec3| {
        let i = nearest(x, output);
        output[i].distance(x) / spacings[i]
    };
    let mut ratios: Vec<f64> = truth.iter().map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    assert_eq!(found.coverage.samples, 500);
    assert_relative_eq!(found.coverage.max, ratios[499], max_relative = 1e-9);
    // 0.999 * 500 is 499.5: the last of 500.
    assert_relative_eq!(found.coverage.p999, ratios[499], max_relative = 1e-9);
    let over_1 = ratios.iter().filter(|&&r| r > 1.0).count();
    assert!(over_1 > 0, "this cloud shows nothing");
    assert_eq!(found.coverage.over_1, over_1 as f64 / 500.0);
}

#[test]
fn uniformity_is_that_of_all_pairs() {
    let pairs = Pairs::new();
    let distances: Vec<f64> =
        (0..pairs.output.len()).flat_map(|i| pairs.to_others(i).take(1)).collect();
    let squares: Vec<f64> = distances.iter().map(|d| d * d).collect();
    let deviation = (mean(&squares) - mean(&distances).powi(2)).sqrt();
    let uniformity = pairs.found.uniformity;
    assert_relative_eq!(uniformity.nn_cv, deviation / mean(&distances), max_relative = 1e-9);
    assert_eq!(uniformity.discs, None);
}

#[test]
fn normals_are_compared_as_by_all_pairs() {
    let pairs = Pairs::new();
    let of_output = |i: usize| pairs.output_normals[i];
    let of_truth = |i: usize| pairs.truth_normals[pairs.nearest[i]];
    let smoothness = pairs.found.smoothness.expect("the output has normals");
    let bends = pairs.bends(of_output);
    assert_relative_eq!(smoothness.output.mean, mean(&bends), max_relative = 1e-6);
    assert_relative_eq!(smoothness.output.max, max(&bends), max_relative = 1e-6);
    let of_its_truth = smoothness.truth.expect("the truth has normals");
    assert_relative_eq!(of_its_truth.mean, mean(&pairs.bends(of_truth)), max_relative = 1e-6);

    let normals = pairs.found.normals.expect("both have normals");
    let angles = pairs.turns(of_output, of_truth);
    assert_relative_eq!(normals.all.mean, mean(&angles), max_relative = 1e-6);
    assert_relative_eq!(normals.all.max, max(&angles), max_relative = 1e-6);
    assert_eq!((normals.points, normals.away_from_creases), (300, None));
}

#[test]
fn chamfer_and_hausdorff_distances_are_those_of_all_pairs() {
    let (output, truth) = rough_pair();
    let found = scenes::measure(&output, &scenes::truth(&truth)).chamfer;
    assert_eq!(found.truth_points, 500);
    let (p, g) = (output.positions, truth.positions);
    let ways = |p: &[DVec3], g: &[DVec3]| -> [Vec<f64>; 2] {
        let there = p.iter().map(|&x| to_points(x, g)).collect();
        [there, g.iter().map(|&x| to_points(x, p)).collect()]
    };
    let [there, back] = ways(&p, &g);
    assert_relative_eq!(found.plain.chamfer, mean(&there) + mean(&back), max_relative = 1e-9);
    assert_relative_eq!(found.plain.hausdorff, max(&there).max(max(&back)), max_relative = 1e-9);

    let unit = |cloud: &[DVec3]| -> Vec<DVec3> {
        let center = cloud.iter().sum::<DVec3>() / cloud.len() as f64;
        let size = cloud.iter().map(|x| (*x - center).length()).fold(0.0, f64::max);
        cloud.iter().map(|x| (*x - center) / size).collect()
    };
    let squared = |way: Vec<f64>| -> Vec<f64> { way.into_iter().map(|d| d * d).collect() };
    let [there, back] = ways(&unit(&p), &unit(&g)).map(squared);
    assert_relative_eq!(found.pu.chamfer, mean(&there) + mean(&back), max_relative = 1e-9);
    assert_relative_eq!(found.pu.hausdorff, max(&there) + max(&back), max_relative = 1e-9);
}

#[test]
fn a_cloud_without_normals_is_met_at_its_points() {
    let (output, mut truth) = rough_pair();
    truth.normals = None;
    let truth_of_points = scenes::truth(&truth);
    assert_eq!(truth_of_points.summary().kind, TruthKind::Points);
    let found = scenes::measure(&output, &truth_of_points);
    let expected = output.positions.iter().map(|&x| to_points(x, &truth.positions)).collect();
    assert_spread(found.distance.absolute, expected);
    assert_eq!(found.normals, None);
    assert_eq!(found.smoothness.expect("the output has normals").truth, None);
}

#[test]
fn normals_without_direction_are_counted_and_left_out() {
    let (mut output, mut truth) = rough_pair();
    let whole = scenes::measure(&output, &scenes::truth(&truth));
    let normals = output.normals.as_mut().unwrap();
    (normals[3], normals[8]) = (Vec3::ZERO, Vec3::NAN);
    let found = scenes::measure(&output, &scenes::truth(&truth));
    assert_eq!(found.output.bad_normals, 2);
    assert_eq!(found.normals.unwrap().points, whole.normals.unwrap().points - 2);
    assert_eq!(found.smoothness.unwrap().points, 298);
    assert!(found.normals.unwrap().all.mean.is_finite());

    truth.normals.as_mut().unwrap()[0] = Vec3::ZERO;
    let truth = Truth::new(&truth).expect("a bad normal is no reason to stop");
    assert_eq!(truth.summary().bad_normals, 1);
    let options = Options::default();
    let found = evaluate(&output, &truth, None, &options, &mut |_| ()).expect("fit");
    assert!(found.normals.unwrap().points <= 298);
}
