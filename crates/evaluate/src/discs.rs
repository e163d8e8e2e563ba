//! The uniform measure of PU-GAN.

use std::f64::consts::PI;

use rayon::prelude::*;
use serde::Serialize;

use crate::cloud::Cloud;
use crate::spread::mean;
use crate::truth::{Closest, Sample, Truth};

/// Areas of the discs, as shares of the whole surface.
const SHARES: [f64; 5] = [0.004, 0.006, 0.008, 0.010, 0.012];
/// Discs of each size.
const SEEDS: usize = 1000;
/// Discs with fewer points are left out, as the authors' program does.
const FEWEST: usize = 5;

/// The uniform measure of R. Li et al., "PU-GAN: a Point Cloud Upsampling Adversarial Network" (ICCV 2019), for discs of
/// one size around 1000 points of the truth. Smaller is more even.
///
/// A disc of the share p of the truth's area A has the radius `r = sqrt(p A / π)` and should hold `n = p N` of the N
/// positions. If it holds the set S, with distances d to the nearest other of S, its value is
///
/// ```text
/// (|S| - n)² / n · mean((d - e)² / e),   e = sqrt(2 π r² / (|S| sqrt 3))
/// ```
///
/// The paper's discs are geodesic. Here a ball of that radius stands for one, without the points at which the truth's
/// normal is turned 90° or more from that at the centre: they belong to another sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Disc {
    /// Area of a disc as a share of the whole surface: p, 0 to 1.
    pub share: f64,
    /// Radius in units of the file.
    pub radius: f64,
    /// Mean over the discs that count; `None` if none does. It has a unit, that of the file: the models of the paper are
    /// about one unit across.
    pub value: Option<f64>,
    /// Discs that were left out because they hold fewer than five positions.
    pub skipped: usize,
}

/// `None` for a truth without an area.
pub(crate) fn measure(
    output: &Cloud<'_>,
    truth: &Truth,
    closest: &[Closest],
    seed: u64,
) -> Option<Vec<Disc>> {
    let area = truth.summary().area?;
    let seeds = truth.samples(SEEDS, seed);
    Some(SHARES.map(|share| disc(output, closest, &seeds, share, area)).to_vec())
}

fn disc(output: &Cloud<'_>, closest: &[Closest], seeds: &[Sample], share: f64, area: f64) -> Disc {
    let radius = (share * area / PI).sqrt();
    let expected = share * output.places.len() as f64;
    let value = |seed: &Sample| {
        let inside = members(output, closest, seed, radius);
        (inside.len() >= FEWEST)
            .then(|| imbalance(&inside, expected) * clutter(output, &inside, radius))
    };
    let values: Vec<Option<f64>> = seeds.par_iter().map(value).collect();
    let counted: Vec<f64> = values.iter().copied().flatten().collect();
    let skipped = seeds.len() - counted.len();
    let value = (!counted.is_empty()).then(|| mean(counted.into_iter()));
    Disc { share, radius, value, skipped }
}

/// Places in the disc, ascending.
fn members(output: &Cloud<'_>, closest: &[Closest], seed: &Sample, radius: f64) -> Vec<u32> {
    let mut inside = output.tree.within(seed.position, radius);
    inside.retain(|&place| {
        let point = output.places.points_at(place as usize)[0] as usize;
        match (seed.normal, closest[point].normal) {
            (Some(center), Some(normal)) => center.dot(normal) > 0.0,
            _ => true,
        }
    });
    inside
}

/// How far the number of places is from what an even cloud has.
fn imbalance(inside: &[u32], expected: f64) -> f64 {
    (inside.len() as f64 - expected).powi(2) / expected
}

/// How far the distances in the disc are from those of a lattice of triangles.
fn clutter(output: &Cloud<'_>, inside: &[u32], radius: f64) -> f64 {
    let count = inside.len() as f64;
    let even = (2.0 * PI * radius * radius / (count * 3f64.sqrt())).sqrt();
    let miss =
        |&place: &u32| (nearest_inside(output, inside, place as usize) - even).powi(2) / even;
    mean(inside.iter().map(miss))
}

/// Distance from a place of the disc to the nearest other one.
fn nearest_inside(output: &Cloud<'_>, inside: &[u32], place: usize) -> f64 {
    let is_inside = |neighbor: &u32| inside.binary_search(neighbor).is_ok();
    if let Some(number) = output.neighbors(place).iter().position(is_inside) {
        return output.neighbor_distance(place, number);
    }
    // On the rim, or where another sheet is near, all known neighbours can be outside.
    let x = output.places.positions[place];
    let others = inside.iter().map(|&other| other as usize).filter(|&other| other != place);
    others.map(|other| x.distance(output.places.positions[other])).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::project;
    use surfine_points::{DVec3, Model};

    /// Two squares from -10 to 10, one at z = 0 that faces up and one below that faces down.
    fn sheets(gap: f64) -> Truth {
        let corner = |x: f64, y: f64, z: f64| DVec3::new(10.0 * x, 10.0 * y, z);
        let sheet =
            |z| [(-1, -1), (1, -1), (1, 1), (-1, 1)].map(|(x, y)| corner(x.into(), y.into(), z));
        let positions = [sheet(0.0), sheet(-gap)].concat();
        let triangles = vec![[0, 1, 2], [0, 2, 3], [6, 5, 4], [7, 6, 4]];
        Truth::new(&Model { positions, triangles, ..Model::default() }).expect("the mesh is fit")
    }

    fn measure_at(center: DVec3, output: &[DVec3], share: f64, area: f64) -> Disc {
        let model = Model { positions: output.to_vec(), ..Model::default() };
        let cloud = Cloud::new(&model).expect("the cloud is fit");
        let closest = project(output, None, &sheets(0.1));
        let seeds = [Sample { position: center, normal: Some(DVec3::Z) }];
        disc(&cloud, &closest, &seeds, share, area)
    }

    /// A point and the six around it at distance 1.
    fn hexagon(z: f64) -> Vec<DVec3> {
        let around = (0..6).map(|k| (f64::from(k) * PI / 3.0).sin_cos());
        let around = around.map(|(y, x)| DVec3::new(x, y, z));
        std::iter::once(DVec3::new(0.0, 0.0, z)).chain(around).collect()
    }

    #[test]
    fn a_disc_has_the_value_by_hand() {
        // Seven of ten positions in a disc of radius 1.5 that should hold half of them.
        let mut output = hexagon(0.0);
        output.extend([4.0, 5.0, 6.0].map(|x| DVec3::new(x, 0.0, 0.0)));
        let found = measure_at(DVec3::ZERO, &output, 0.5, 2.0 * PI * 2.25);
        approx::assert_relative_eq!(found.radius, 1.5, max_relative = 1e-14);
        let even = (2.0 * PI * 2.25 / (7.0 * 3f64.sqrt())).sqrt();
        let expected = (7.0 - 5.0) * (7.0 - 5.0) / 5.0 * (1.0 - even) * (1.0 - even) / even;
        approx::assert_relative_eq!(found.value.unwrap(), expected, max_relative = 1e-12);
        assert_eq!(found.skipped, 0);
    }

    #[test]
    fn discs_with_fewer_than_five_positions_do_not_count() {
        let four = hexagon(0.0)[..4].to_vec();
        let found = measure_at(DVec3::ZERO, &four, 0.5, 2.0 * PI * 2.25);
        assert_eq!((found.value, found.skipped), (None, 1));
        let five = hexagon(0.0)[..5].to_vec();
        assert_eq!(measure_at(DVec3::ZERO, &five, 0.5, 2.0 * PI * 2.25).skipped, 0);
    }

    #[test]
    fn the_other_sheet_is_left_out() {
        // So many points below that the eight nearest of each are all there.
        let mut random = fastrand::Rng::with_seed(2);
        let mut place = |z| DVec3::new(4.0 * random.f64() - 2.0, 4.0 * random.f64() - 2.0, z);
        let above: Vec<DVec3> = (0..40).map(|_| place(0.0)).collect();
        let below: Vec<DVec3> = (0..4000).map(|_| place(-0.1)).collect();
        let radius = 1.2;
        let found = measure_at(DVec3::ZERO, &[above.clone(), below].concat(), 0.01, PI * 144.0);
        approx::assert_relative_eq!(found.radius, radius, max_relative = 1e-14);

        let inside: Vec<DVec3> = above.into_iter().filter(|p| p.length() <= radius).collect();
        let count = inside.len() as f64;
        let even = (2.0 * PI * radius * radius / count / 3f64.sqrt()).sqrt();
        let nearest = |p: &DVec3| {
            let others = inside.iter().filter(|&q| q != p).map(|q| q.distance(*p));
            others.fold(f64::INFINITY, f64::min)
        };
        let clutter =
            inside.iter().map(|p| (nearest(p) - even).powi(2) / even).sum::<f64>() / count;
        let expected = (count - 40.4).powi(2) / 40.4 * clutter;
        approx::assert_relative_eq!(found.value.unwrap(), expected, max_relative = 1e-9);
    }
}
