//! What a right implementation shows: numbers of points, evenness, and closeness to the surface.
//!
//! All of it by the paper's text; `rules.rs` shows what the rules beyond it add. "Published" are the numbers of a
//! separate sequential implementation in f64. Differences below .005 in growth and in the variation of nearest
//! distances are noise between orders of the points, and so are .015 at a level of 600 points.

use surfine_points::shapes::{Shape, icosphere};
use surfine_points::{PointSet, Refined};

use crate::clouds::{blue_noise, literal, random, refine, shared, shuffled};
use crate::measure::{
    growths, largest_empty_disc, mean, mean_distance, mean_normal_error, median, nearest_variation,
};

#[test]
fn an_icosphere_of_642_points_grows_to_exactly_17282() {
    let refined = refine(&icosphere(3), &literal(3));
    // A new point for each triangle of a closed triangulation: 2 (n - 2) of them.
    assert_eq!(refined.level_sizes, [642, 1922, 5762, 17282]);
}

#[test]
fn an_even_sphere_grows_almost_threefold_and_stays_even() {
    let runs: Vec<Refined> =
        (1..=3).map(|s| refine(&blue_noise(Shape::Sphere, 1000, s), &literal(4))).collect();
    let growth = mean(runs.iter().flat_map(growths));
    // Published 2.991. Measured 2.988 over 6 seeds (2.986 to 2.989).
    assert!((growth - 2.991).abs() < 0.006, "growth {growth}");
    let variation = mean(runs.iter().map(|r| nearest_variation(&r.points)));
    // Published .143. Measured .1425 over 6 seeds (.139 to .145). It follows the input's: .154 where that was .077
    // instead of .061.
    assert!((variation - 0.143).abs() < 0.01, "variation of nearest distances {variation}");
}

#[test]
fn an_even_sphere_comes_out_round() {
    for seed in 1..=3 {
        let refined = refine(&blue_noise(Shape::Sphere, 1000, seed), &literal(4));
        let distance = mean_distance(&refined, Shape::Sphere);
        // Published 4.2e-6. Measured 4.33e-6 to 4.39e-6 over 6 seeds.
        assert!((2.8e-6..6.3e-6).contains(&distance), "seed {seed}: mean distance {distance:e}");
        let normal = mean_normal_error(&refined, Shape::Sphere);
        // Published .01. Measured .0055 to .0057; the printed coefficient 7 of the normal gives .3.
        assert!(normal < 0.015, "seed {seed}: mean normal error {normal} degrees");
    }
}

#[test]
fn a_sphere_from_another_sampler_grows_alike() {
    let Some(cloud) = shared("analytic", "sphere-600-uniform.ply") else { return };
    let refined = refine(&cloud, &literal(4));
    let variation = nearest_variation(&refined.points);
    // Published .143. Measured .142.
    assert!((variation - 0.143).abs() < 0.005, "variation of nearest distances {variation}");
    for growth in growths(&refined) {
        // Published 2.991. Measured 2.984 to 2.988.
        assert!((growth - 2.991).abs() < 0.012, "growth {growth}");
    }
}

/// Fails unless each level's growth is as near to the expected one as it must be.
#[track_caller]
fn assert_growths(refined: &Refined, expected: &[f64], bounds: &[f64], what: &str) {
    let found = growths(refined);
    assert_eq!(found.len(), expected.len());
    for ((growth, expected), bound) in found.iter().zip(expected).zip(bounds) {
        assert!((growth - expected).abs() <= *bound, "{what}: {found:?}, {expected} at one level");
    }
}

/// Median radius at each level, input first.
fn median_radii(cloud: &PointSet, steps: usize) -> Vec<f32> {
    let mut points = cloud.clone();
    let mut medians = vec![median(&points.radii)];
    for _ in 0..steps {
        points = refine(&points, &literal(1)).points;
        medians.push(median(&points.radii));
    }
    medians
}

/// Fails unless the median radius shrinks with the spacing.
#[track_caller]
fn assert_radii_follow_the_spacing(cloud: &PointSet, what: &str) {
    let medians = median_radii(cloud, 5);
    let ratios: Vec<f32> = medians.windows(2).map(|w| w[0] / w[1]).collect();
    // sqrt(3) = 1.73, once the generous radii of the input are used up: they are 1.25 times the ring, later ones 1.02
    // times. Measured on Igea 1.97 1.86 1.76 1.77 1.75.
    assert!((1.7..2.2).contains(&ratios[0]), "{what}: {ratios:?}");
    assert!(ratios[1..].iter().all(|r| (1.66..1.95).contains(r)), "{what}: {ratios:?}");
}

/// Fails unless the mean ring of the last step has almost 6 neighbours, those of a closed triangulation.
#[track_caller]
fn assert_rings_close(refined: &Refined, what: &str) {
    let report = refined.reports.last().expect("there was a step");
    let ring = report.ring_neighbors as f64 / report.points_in as f64;
    // Published 5.98. Measured 5.977 to 5.982.
    assert!((ring - 5.98).abs() < 0.01, "{what}: mean ring of {ring}");
}

#[test]
fn igea_grows_as_published() {
    let Some(igea) = shared("points", "igea-600-uniform.ply") else { return };
    let expected = [2.960, 2.990, 2.988, 2.991, 2.988];
    let refined = refine(&igea, &literal(5));
    // Measured 2.948 2.988 2.987 2.989 2.986.
    assert_growths(&refined, &expected, &[0.015, 0.006, 0.006, 0.006, 0.006], "Igea");
    // Published 141,796. Measured 140,850.
    assert!((140_000..152_000).contains(&refined.points.len()), "{} points", refined.points.len());
    assert_rings_close(&refined, "Igea");
    assert_radii_follow_the_spacing(&igea, "Igea");
    for seed in 1..=2 {
        let refined = refine(&shuffled(&igea, seed), &literal(5));
        // Over 5 orders level 1 gave 2.960 to 2.975, level 2 2.983 to 2.990, the others 2.984 to 2.991.
        let bounds = [0.018, 0.009, 0.009, 0.009, 0.009];
        assert_growths(&refined, &expected, &bounds, &format!("Igea, order {seed}"));
    }
}

#[test]
fn even_closed_shapes_grow_like_igea() {
    let clouds = [(Shape::Ellipsoid, 1), (Shape::Torus, 1), (Shape::Ellipsoid, 3)];
    let mut sums = [0.0; 5];
    for (shape, seed) in clouds {
        let cloud = blue_noise(shape, 600, seed);
        let refined = refine(&cloud, &literal(5));
        assert_rings_close(&refined, &format!("{shape} {seed}"));
        assert_radii_follow_the_spacing(&cloud, &format!("{shape} {seed}"));
        sums.iter_mut().zip(growths(&refined)).for_each(|(sum, growth)| *sum += growth);
    }
    let found = sums.map(|sum| sum / clouds.len() as f64);
    // Means over these clouds: 2.984 2.989 2.988 2.985 2.982. Single ones of 12 clouds: 2.977 to 2.997 at level 1, then
    // 2.978 to 2.993. Three is the most that there can be.
    for (growth, (expected, bound)) in found.iter().zip([
        (2.985, 0.012),
        (2.988, 0.006),
        (2.988, 0.006),
        (2.987, 0.006),
        (2.985, 0.006),
    ]) {
        let off: f64 = growth - expected;
        assert!(off.abs() < bound, "{found:?}, {expected} at one level");
    }
}

/// Fails unless balls and classes have the sizes of irregular input.
#[track_caller]
fn assert_irregular_sizes(refined: &Refined, what: &str) {
    for report in &refined.reports {
        let ball = report.ball_neighbors as f64 / report.points_in as f64;
        // Published 15 to 20. Measured 15.6 to 20.2.
        assert!((14.0..22.0).contains(&ball), "{what}: mean ball of {ball}");
        // Published 12 to 29. Measured 11 to 40 (one torus), growing with the level.
        assert!((8..=48).contains(&report.classes), "{what}: {} classes", report.classes);
    }
}

#[test]
fn nefertiti_grows_as_published() {
    let Some(nefertiti) = shared("points", "nefertiti-3500-random.ply") else { return };
    // Measured 2.625 2.743 2.732 2.721, in other orders of the points 2.626 to 2.629, 2.745 to 2.747, 2.721 to 2.722,
    // 2.719: up to .018 away.
    for (cloud, order) in [(nefertiti.clone(), "its own"), (shuffled(&nefertiti, 1), "another")] {
        let refined = refine(&cloud, &literal(4));
        let what = format!("Nefertiti in {order} order");
        assert_growths(&refined, &[2.640, 2.746, 2.739, 2.731], &[0.025; 4], &what);
        assert_irregular_sizes(&refined, &what);
    }
}

/// Fails unless a random sample is refined as well as random samples are.
#[track_caller]
fn assert_random_quality(shape: Shape, area: f64, seed: u64) {
    let refined = refine(&random(shape, 2000, seed), &literal(4));
    let what = format!("random {shape}, seed {seed}");
    let growth = mean(growths(&refined));
    // Published 2.70 for the torus. Measured 2.693 to 2.726 on tori, 2.700 to 2.724 on ellipsoids.
    assert!((growth - 2.70).abs() < 0.04, "{what}: mean growth {growth}");
    let variation = nearest_variation(&refined.points);
    // Published .37. Measured .362 to .373, .358 to .371.
    assert!((variation - 0.37).abs() < 0.02, "{what}: variation of nearest distances {variation}");
    // Radius of the largest disc in spacings sqrt(area / points); 100,000 probes are one a point. Published 1.57 of a
    // spacing that is not defined, and 1.6 to 2.1 for other inputs. Measured 1.97 to 2.22, 2.04 to 2.31.
    let spacing = (area / refined.points.len() as f64).sqrt();
    let disc = largest_empty_disc(&refined.points, shape, 100_000) / spacing;
    assert!((1.2..2.6).contains(&disc), "{what}: largest empty disc of {disc} spacings");
    assert_irregular_sizes(&refined, &what);
}

#[test]
fn a_random_torus_is_refined_evenly() {
    let area = 4.0 * std::f64::consts::PI.powi(2) * 0.4;
    (1..=2).for_each(|seed| assert_random_quality(Shape::Torus, area, seed));
}

#[test]
fn a_random_ellipsoid_is_refined_evenly() {
    // The area is that of the half axes 1, .7 and .45 by elliptic integrals.
    assert_random_quality(Shape::Ellipsoid, 6.328_075_230_757, 1);
}
