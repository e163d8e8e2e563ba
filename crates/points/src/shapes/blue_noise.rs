//! Weighted sample elimination: even but irregular points chosen from many random ones.
//!
//! C. Yuksel, "Sample Elimination for Generating Poisson Disk Sample Sets", Computer Graphics Forum 34(2), 2015. Each
//! sample weighs the sum of a falling function of the distance over the samples near it; the heaviest is dropped until
//! as many as wanted are left. Distances are Euclidean, not geodesic: at the densities used here the sheets of a
//! surface are farther apart than the samples.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::Vec3;

use crate::{Grid, GridShape};

/// Samples that are not dropped yet, and their weights.
struct Samples<'a> {
    positions: &'a [Vec3],
    grid: Grid,
    /// Twice the largest radius that equal discs around all samples can have: farther samples don't weigh.
    reach: f32,
    weights: Vec<f64>,
    alive: Vec<bool>,
}

/// Indices, ascending, of the `n` positions that are left of a random sample of a surface of this area.
pub(super) fn thin(positions: &[Vec3], n: usize, area: f64) -> Vec<usize> {
    thin_around(positions, 0, n, area)
}

/// The same with the first `fixed` positions among those that are left, whatever they weigh.
pub(super) fn thin_around(positions: &[Vec3], fixed: usize, n: usize, area: f64) -> Vec<usize> {
    let mut samples = Samples::new(positions, n, area);
    // Weights only fall. So the heaviest sample is the top of the heap as soon as its entry holds its present weight;
    // an older entry is put back with the present one. Bits of numbers that aren't negative sort as the numbers do.
    let entry = |i: u32, weight: f64| (weight.to_bits(), Reverse(i));
    let mut heap: BinaryHeap<_> =
        (0u32..).zip(&samples.weights).skip(fixed).map(|(i, &weight)| entry(i, weight)).collect();
    let mut excess = positions.len().saturating_sub(n);
    while excess > 0 {
        let Some((bits, Reverse(i))) = heap.pop() else { break };
        let weight = samples.weights[i as usize];
        if bits == weight.to_bits() {
            samples.drop_sample(i);
            excess -= 1;
        } else {
            heap.push(entry(i, weight));
        }
    }
    (0..positions.len()).filter(|&i| samples.alive[i]).collect()
}

impl<'a> Samples<'a> {
    fn new(positions: &'a [Vec3], n: usize, area: f64) -> Self {
        // The densest packing of discs in the plane is hexagonal.
        let r_max = (area / (2.0 * 3f64.sqrt() * n.max(1) as f64)).sqrt();
        let reach = (2.0 * r_max) as f32;
        let low = positions.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO);
        let shape = GridShape::with_cell(low, reach, positions.len());
        let grid = Grid::build(shape, (0u32..).zip(positions.iter().copied()));
        let alive = vec![true; positions.len()];
        let mut samples = Self { positions, grid, reach, weights: Vec::new(), alive };
        samples.weights = (0..positions.len() as u32).map(|i| samples.total_weight(i)).collect();
        samples
    }

    fn total_weight(&self, i: u32) -> f64 {
        let mut total = 0.0;
        self.visit_near(i, |_, weight| total += weight);
        total
    }

    /// Drops a sample and takes its share from the weights of those near it.
    fn drop_sample(&mut self, i: u32) {
        self.alive[i as usize] = false;
        let mut weights = std::mem::take(&mut self.weights);
        self.visit_near(i, |j, weight| {
            let left = &mut weights[j as usize];
            // Rounding must not make a sum of positive shares negative.
            *left = (*left - weight).max(0.0);
        });
        self.weights = weights;
    }

    /// Calls `visit` with every other sample within reach and the weight of the pair.
    fn visit_near(&self, i: u32, mut visit: impl FnMut(u32, f64)) {
        let center = self.positions[i as usize];
        self.grid.visit_ball(center, self.reach, |j, _| {
            if j == i || !self.alive[j as usize] {
                return;
            }
            let distance = (self.positions[j as usize] - center).length();
            if distance < self.reach {
                visit(j, pair_weight(f64::from(distance) / f64::from(self.reach)));
            }
        });
    }
}

/// Weight of two samples at this share of the reach, 0 to 1: the paper's `(1 - d / (2 r_max))^8`, with its limit for
/// close pairs (section 4.4), without which a few very close ones outweigh everything around them.
fn pair_weight(share: f64) -> f64 {
    // 0.65 (1 - (n / m)^1.5) for n of m = 8 n samples.
    const CLOSEST: f64 = 0.621;
    let square = |v: f64| v * v;
    square(square(square(1.0 - share.max(CLOSEST))))
}
