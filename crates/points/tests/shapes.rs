//! Generated clouds: on their surfaces, even, and the same every time.

use std::f64::consts::PI;

use surfine_points::shapes::{
    Sampling, Shape, hexagonal_grid, icosphere, natural_radii, sample, square_grid,
};
use surfine_points::{DVec3, PointSet, Vec3};

/// The bits of every column, in which the smallest difference shows.
fn bits(cloud: &PointSet) -> Vec<u32> {
    let vectors = cloud.positions.iter().chain(&cloud.normals).flat_map(|v| v.to_array());
    vectors.chain(cloud.radii.iter().copied()).map(f32::to_bits).collect()
}

/// FNV-1a over the bits.
fn digest(cloud: &PointSet) -> u64 {
    let bytes = bits(cloud).into_iter().flat_map(u32::to_le_bytes);
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Left side of the equation of a surface, zero on it, and its gradient, which points outward.
fn equation(shape: Shape, p: Vec3) -> (f64, DVec3) {
    let DVec3 { x, y, z } = p.as_dvec3();
    let axis_distance = x.hypot(y);
    match shape {
        Shape::Sphere => (x * x + y * y + z * z - 1.0, DVec3::new(x, y, z)),
        Shape::Torus => {
            let off = axis_distance - 1.0;
            let radial = off / axis_distance;
            (off * off + z * z - 0.16, DVec3::new(x * radial, y * radial, z))
        }
        Shape::Ellipsoid => {
            (x * x + y * y / 0.49 + z * z / 0.2025 - 1.0, DVec3::new(x, y / 0.49, z / 0.2025))
        }
        Shape::Saddle => (z - 0.4 * (x * x - y * y), DVec3::new(-0.8 * x, 0.8 * y, 1.0)),
        Shape::Plane => (z, DVec3::Z),
    }
}

/// Distance of each point to its nearest other one.
fn nearest(positions: &[Vec3]) -> Vec<f64> {
    let distance = |a: Vec3, b: Vec3| (a.as_dvec3() - b.as_dvec3()).length();
    let others = |i: usize| (0..positions.len()).filter(move |&j| j != i);
    (0..positions.len())
        .map(|i| others(i).map(|j| distance(positions[i], positions[j])).fold(f64::MAX, f64::min))
        .collect()
}

#[test]
fn samples_lie_on_their_surface_with_exact_normals() {
    for shape in Shape::ALL {
        for sampling in Sampling::ALL {
            let cloud = sample(shape, sampling, 400, 5);
            assert_eq!(cloud.len(), 400);
            cloud.validate().expect("a generated cloud is fit for refinement");
            for (&p, &n) in cloud.positions.iter().zip(&cloud.normals) {
                let (value, gradient) = equation(shape, p);
                assert!(value.abs() < 2e-6, "{shape}: {p} misses the equation by {value}");
                assert!(shape.distance(p) < 1e-6, "{shape}: {p} is off by {}", shape.distance(p));
                assert!((n.as_dvec3().length() - 1.0).abs() < 1e-7, "{shape}: normal {n}");
                let exact = gradient.normalize().as_vec3();
                assert!((n - exact).length() < 1e-6, "{shape}: normal {n}, exact {exact}");
                assert!((shape.normal(p) - exact).length() < 1e-6, "{shape}: closest, {exact}");
            }
        }
    }
}

#[test]
fn same_seed_same_bytes_and_other_seed_other_bytes() {
    for shape in Shape::ALL {
        for sampling in Sampling::ALL {
            let cloud = |seed| bits(&sample(shape, sampling, 200, seed));
            assert_eq!(cloud(1), cloud(1), "{shape} {sampling}");
            assert_ne!(cloud(1), cloud(2), "{shape} {sampling}");
        }
    }
}

/// Another digest on another platform means that its arithmetic isn't the one that IEEE 754 prescribes; another digest
/// after a change means that every cloud in documents and benchmarks changes too.
#[test]
fn bytes_are_those_of_every_platform() {
    let digests = Shape::ALL.map(|shape| digest(&sample(shape, Sampling::BlueNoise, 300, 9)));
    let expected = [
        0x50ec_26d4_8b47_5453,
        0x741a_7567_1a8d_ab72,
        0x8e2a_9e67_93b6_c28b,
        0xbc72_ef0c_06fe_536d,
        0x4dcb_ba74_6066_64f3,
    ];
    assert_eq!(digests, expected, "{digests:#x?}");
}

#[test]
fn few_points_work() {
    for shape in Shape::ALL {
        for sampling in Sampling::ALL {
            for n in 0..=8 {
                let cloud = sample(shape, sampling, n, 3);
                assert_eq!(cloud.len(), n);
                cloud.validate().expect("a generated cloud is fit for refinement");
            }
        }
    }
}

#[test]
fn blue_noise_is_even() {
    let areas = [(Shape::Sphere, 4.0 * PI), (Shape::Torus, 1.6 * PI * PI), (Shape::Plane, 4.0)];
    for (shape, area) in areas {
        let n = 1000;
        let distances = nearest(&sample(shape, Sampling::BlueNoise, n, 1).positions);
        let mean = distances.iter().sum::<f64>() / n as f64;
        let variance = distances.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / n as f64;
        let variation = variance.sqrt() / mean;
        let densest = 2.0 * (area / (2.0 * 3f64.sqrt() * n as f64)).sqrt();
        let least = distances.iter().copied().fold(f64::MAX, f64::min) / densest;
        assert!(variation < 0.12, "{shape}: coefficient of variation {variation}");
        assert!(least > 0.6, "{shape}: least distance {least} of the densest packing's");
    }
}

#[test]
fn random_points_are_area_uniform() {
    let share = |shape, inside: fn(Vec3) -> bool| {
        let cloud = sample(shape, Sampling::Random, 20_000, 4);
        cloud.positions.iter().filter(|&&p| inside(p)).count() as f64 / 20_000.0
    };
    // Archimedes: caps of a sphere have area in proportion to their height. Pappus: the outer half of a torus.
    assert!((share(Shape::Sphere, |p| p.z > 0.5) - 0.25).abs() < 0.01);
    let outer = 0.5 + 0.4 / PI;
    assert!((share(Shape::Torus, |p| p.x.hypot(p.y) > 1.0) - outer).abs() < 0.01);
    assert!((share(Shape::Plane, |p| p.x > 0.0 && p.y > 0.5) - 0.125).abs() < 0.01);
}

/// The closest point of a parametrised patch by a search that narrows around the best node of a grid.
fn brute_force(x: Vec3, low: [f64; 2], high: [f64; 2], map: impl Fn(f64, f64) -> DVec3) -> f64 {
    let (mut center, mut reach) = ([0.0; 2], [0.0; 2]);
    for axis in 0..2 {
        center[axis] = 0.5 * (low[axis] + high[axis]);
        reach[axis] = 0.5 * (high[axis] - low[axis]);
    }
    let mut best = f64::MAX;
    for step in 0..40 {
        let nodes = if step == 0 { 300 } else { 12 };
        let at = |axis: usize, k: i32| {
            let share = f64::from(2 * k) / f64::from(nodes) - 1.0;
            (center[axis] + reach[axis] * share).clamp(low[axis], high[axis])
        };
        let mut found = center;
        for i in 0..=nodes {
            for j in 0..=nodes {
                let (u, v) = (at(0, i), at(1, j));
                let distance = (map(u, v) - x.as_dvec3()).length();
                if distance < best {
                    (best, found) = (distance, [u, v]);
                }
            }
        }
        center = found;
        reach = reach.map(|r| if step == 0 { r / 50.0 } else { r * 0.6 });
    }
    best
}

fn brute_force_distance(shape: Shape, x: Vec3) -> f64 {
    let unit = |u: f64, v: f64| DVec3::new(u.cos() * v.cos(), u.sin() * v.cos(), v.sin());
    match shape {
        Shape::Sphere => brute_force(x, [-PI, -PI / 2.0], [PI, PI / 2.0], unit),
        Shape::Torus => brute_force(x, [-PI, -PI], [PI, PI], |u, v| {
            DVec3::new(u.cos(), u.sin(), 0.0) + 0.4 * unit(u, v)
        }),
        Shape::Ellipsoid => brute_force(x, [-PI, -PI / 2.0], [PI, PI / 2.0], |u, v| {
            unit(u, v) * DVec3::new(1.0, 0.7, 0.45)
        }),
        Shape::Saddle => {
            brute_force(x, [-1.0, -1.0], [1.0, 1.0], |u, v| DVec3::new(u, v, 0.4 * (u * u - v * v)))
        }
        Shape::Plane => brute_force(x, [-1.0, -1.0], [1.0, 1.0], |u, v| DVec3::new(u, v, 0.0)),
    }
}

#[test]
fn distances_are_those_of_brute_force() {
    let mut random = fastrand::Rng::with_seed(11);
    let mut coordinate = || 3.0 * random.f32() - 1.5;
    let mut probes: Vec<Vec3> =
        (0..60).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
    // Where closest points are many, or rounding might divide by zero.
    probes.extend([
        Vec3::ZERO,
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::new(0.3, 0.0, 0.0),
        Vec3::new(0.0, 0.3, 0.0),
        Vec3::new(0.0, 0.0, 0.3),
        Vec3::new(0.3, -0.2, 1e-30),
        Vec3::new(-0.6, 0.1, 1e-7),
        Vec3::new(0.9, 0.0, 0.0),
        Vec3::new(1.2, 1.1, 0.0),
    ]);
    for shape in Shape::ALL {
        for &x in &probes {
            let (found, expected) = (f64::from(shape.distance(x)), brute_force_distance(shape, x));
            assert!((found - expected).abs() < 1e-6, "{shape} {x}: {found}, not {expected}");
        }
    }
}

#[test]
fn icospheres_are_whole() {
    for (subdivisions, points) in [(0, 12), (1, 42), (2, 162), (3, 642)] {
        let cloud = icosphere(subdivisions);
        assert_eq!(cloud.len(), points);
        cloud.validate().expect("a generated cloud is fit for refinement");
        assert!(cloud.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
        assert_eq!(cloud.positions, cloud.normals);
        // Edges of the first level are 1.0515 long; halving makes them bulge, so they stay above half.
        let edge = 1.0514 / f64::from(1 << subdivisions);
        let apart = nearest(&cloud.positions);
        assert!(apart.iter().all(|&d| d > edge && d < 1.25 * edge), "{subdivisions}: {apart:?}");
    }
    assert_eq!(bits(&icosphere(3)), bits(&icosphere(3)));
}

#[test]
fn icosphere_radii_are_near_the_mean_edge_and_natural() {
    let cloud = icosphere(3);
    let apart = nearest(&cloud.positions);
    // Every vertex has the six vertices (five at the corners of the icosahedron) within this reach as neighbours.
    let edges: Vec<f64> = (0..642)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .map(|(i, j)| f64::from((cloud.positions[i] - cloud.positions[j]).length()))
        .filter(|&d| d < 1.5 * apart[0])
        .collect();
    assert_eq!(edges.len(), 1920);
    let mean = edges.iter().sum::<f64>() / edges.len() as f64;
    let natural = natural_radii(&cloud.positions, &cloud.normals);
    let mut range = (f64::MAX, 0f64);
    for (&radius, natural) in cloud.radii.iter().zip(natural) {
        let ratio = f64::from(radius) / (1.25 * mean);
        range = (range.0.min(ratio), range.1.max(ratio));
        assert!((radius - natural).abs() < 1e-6, "{radius}, not {natural}");
    }
    // The edges around the corners of the icosahedron are the shortest: 0.92 of the mean.
    assert!(range.0 > 0.9 && range.1 < 1.1, "{range:?}");
}

#[test]
fn lattices_have_their_counts_and_radii() {
    for side in [0, 1, 2, 7] {
        let grid = square_grid(side);
        assert_eq!(grid.len(), side * side);
        assert!(grid.radii.iter().all(|&r| (r - 1.25 * 2f32.sqrt()).abs() < 1e-6));
    }
    for rings in 0..6 {
        let grid = hexagonal_grid(rings);
        assert_eq!(grid.len(), 3 * rings * (rings + 1) + 1);
        assert!(grid.radii.iter().all(|&r| r == 1.25));
        let apart = nearest(&grid.positions);
        assert!(rings == 0 || apart.iter().all(|d| (d - 1.0).abs() < 1e-6));
    }
}

#[test]
fn natural_radii_of_lattices() {
    let hexagonal = hexagonal_grid(10);
    let radii = natural_radii(&hexagonal.positions, &hexagonal.normals);
    for (p, radius) in hexagonal.positions.iter().zip(radii) {
        let exact = if p.length() < 8.0 { 1e-6 } else { 1.0 };
        assert!((radius - 1.25).abs() <= exact, "{p}: {radius}");
    }
    // Diagonal neighbours touch in a corner of the cells and count.
    let square = square_grid(12);
    let radii = natural_radii(&square.positions, &square.normals);
    assert!(radii.iter().all(|&r| (r - 1.25 * 2f32.sqrt()).abs() < 1e-6), "{radii:?}");
}

#[test]
fn natural_radii_follow_scale_and_ignore_the_other_side() {
    let plane = sample(Shape::Plane, Sampling::BlueNoise, 500, 6);
    let scaled: Vec<Vec3> = plane.positions.iter().map(|&p| p * 1024.0).collect();
    let radii = natural_radii(&scaled, &plane.normals);
    assert!(plane.radii.iter().zip(&radii).all(|(&a, &b)| (1024.0 * a - b).abs() < 1e-3 * b));

    let mut both = plane.clone();
    both.positions.extend(plane.positions.iter().map(|&p| p + Vec3::new(0.01, 0.02, -0.001)));
    both.normals.extend(plane.normals.iter().map(|&n| -n));
    let radii = natural_radii(&both.positions, &both.normals);
    // Only at the border can the other side matter: it halves the spacing, which says where border cells end.
    let inner = |i: &usize| plane.positions[*i].abs().max_element() < 0.75;
    for i in (0..500).filter(inner) {
        assert_eq!(radii[i], plane.radii[i], "{}", plane.positions[i]);
    }
}

#[test]
fn natural_radii_of_degenerate_clouds_are_finite_and_positive() {
    let line = |n: usize| (0..n).map(|i| Vec3::X * i as f32).collect::<Vec<_>>();
    let mut cluster: Vec<Vec3> = line(9).into_iter().map(|p| 1e-6 * p).collect();
    cluster.push(Vec3::new(1e6, 2.0, 3.0));
    let clouds = [
        vec![],
        line(1),
        line(2),
        line(3),
        line(50),
        vec![Vec3::ONE; 20],
        cluster,
        vec![Vec3::ZERO, Vec3::new(1e-45, 0.0, 0.0), Vec3::new(1e15, 0.0, 1e15)],
    ];
    for positions in clouds {
        // Across, along and oblique to the line; with one another and opposed; and no direction at all.
        for normal in [Vec3::Z, Vec3::X, Vec3::new(0.6, 0.8, 0.0), Vec3::ZERO] {
            for flip in [1.0, -1.0] {
                let normals: Vec<Vec3> = (0..positions.len())
                    .map(|i| if i % 2 == 0 { normal } else { normal * flip })
                    .collect();
                let radii = natural_radii(&positions, &normals);
                assert_eq!(radii.len(), positions.len());
                assert!(radii.iter().all(|r| r.is_finite() && *r > 0.0), "{positions:?} {radii:?}");
            }
        }
    }
    assert_eq!(natural_radii(&line(1), &[Vec3::Z]), [1.0]);
    assert_eq!(natural_radii(&line(2), &[Vec3::Z, -Vec3::Z]), [1.25, 1.25]);
    assert_eq!(natural_radii(&line(4), &[Vec3::Z; 4]), [1.25; 4]);
}

#[test]
fn names_are_read_back() {
    for shape in Shape::ALL {
        assert_eq!(shape.to_string().parse(), Ok(shape));
    }
    for sampling in Sampling::ALL {
        assert_eq!(sampling.to_string().parse(), Ok(sampling));
    }
    let error = "cube".parse::<Shape>().expect_err("there is no cube");
    assert_eq!(
        error.to_string(),
        "unknown shape \"cube\": use one of sphere, torus, ellipsoid, saddle, plane"
    );
}
