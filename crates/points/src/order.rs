//! An order of points in which those near each other in space are near each other in memory.
//!
//! The refinement runs on points in this order: neighbours then share cache lines, at all levels, since new points come in the order of
//! their triangles. What it returns is in the order of the input again.

use crate::{PointSet, Refined};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Bits of a coordinate in a Morton code.
const BITS: u32 = 21;

/// A cloud in spatial order.
#[derive(Clone, Debug)]
pub struct Ordered {
    /// The points in that order.
    pub points: PointSet,
    /// For each of them its index in the input.
    pub order: Vec<u32>,
}

impl Ordered {
    /// Sorts the points by the Morton code of their position (Morton 1966), those of one code by position, then by index.
    pub fn new(points: &PointSet) -> Self {
        let order = spatial_order(&points.positions);
        Self { points: points.select(&order), order }
    }

    /// Gives a result that was computed from these points the order of the input. New points stay where they are.
    pub fn restore(&self, input: &PointSet, refined: &mut Refined) {
        let count = self.order.len();
        let Refined { points, parents, level_radii, .. } = refined;
        points.positions[..count].copy_from_slice(&input.positions);
        points.normals[..count].copy_from_slice(&input.normals);
        for radii in std::iter::once(&mut points.radii).chain(level_radii) {
            let sorted = radii[..count].to_vec();
            self.order.iter().zip(sorted).for_each(|(&i, radius)| radii[i as usize] = radius);
        }
        for (new, old) in points.attributes.iter_mut().zip(&input.attributes) {
            new.values.copy_start(&old.values);
        }
        parents.par_iter_mut().for_each(|corners| {
            let [a, b, c] = corners.map(|p| self.order.get(p as usize).copied().unwrap_or(p));
            // The smallest index comes first again, but for new points on curves, which have one corner twice.
            *corners = match a.min(b).min(c) {
                least if a == b || least == a => [a, b, c],
                least if least == b => [b, c, a],
                _ => [c, a, b],
            };
        });
    }
}

/// Indices of the points in spatial order.
fn spatial_order(positions: &[Vec3]) -> Vec<u32> {
    let low = positions.iter().copied().reduce(Vec3::min).unwrap_or(Vec3::ZERO).as_dvec3();
    let high = positions.iter().copied().reduce(Vec3::max).unwrap_or(Vec3::ZERO).as_dvec3();
    let scale = f64::from((1 << BITS) - 1) / (high - low).max_element().max(f64::MIN_POSITIVE);
    let mut keys: Vec<(u64, u32)> = (0..positions.len() as u32)
        .into_par_iter()
        .map(|i| (morton((positions[i as usize].as_dvec3() - low) * scale), i))
        .collect();
    let place = |i: u32| positions[i as usize].to_array().map(f32::to_bits);
    keys.par_sort_unstable_by(|a, b| {
        a.0.cmp(&b.0).then_with(|| place(a.1).cmp(&place(b.1))).then(a.1.cmp(&b.1))
    });
    keys.into_iter().map(|(_, i)| i).collect()
}

/// The bits of three coordinates in turn.
fn morton(x: DVec3) -> u64 {
    // The quotient of tiny extents may be anything; a cast brings it into range.
    x.to_array()
        .into_iter()
        .rev()
        .fold(0, |code, v| code << 1 | spread((v as u64).min((1 << BITS) - 1)))
}

/// Two zero bits between the bits of a coordinate.
fn spread(v: u64) -> u64 {
    let mut x = v;
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_interleave_the_bits_of_the_coordinates() {
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..1000 {
            let v: [u64; 3] = std::array::from_fn(|_| random.u64(0..1 << BITS));
            let code = morton(DVec3::new(v[0] as f64, v[1] as f64, v[2] as f64));
            for bit in 0..BITS {
                for axis in 0..3 {
                    assert_eq!(code >> (3 * bit + axis) & 1, v[axis as usize] >> bit & 1);
                }
            }
        }
    }

    #[test]
    fn the_order_of_the_input_does_not_matter() {
        let mut random = fastrand::Rng::with_seed(6);
        let mut positions: Vec<Vec3> =
            (0..500).map(|_| Vec3::new(random.f32(), 0.0, random.f32())).collect();
        let places = |positions: &[Vec3]| {
            let order = spatial_order(positions);
            order.into_iter().map(|i| positions[i as usize]).collect::<Vec<_>>()
        };
        let sorted = places(&positions);
        random.shuffle(&mut positions);
        assert_eq!(sorted, places(&positions));
        // Neighbours in the list are near each other: a random order has steps of half the extent.
        let steps: f32 = sorted.windows(2).map(|pair| (pair[1] - pair[0]).length()).sum();
        assert!(steps / 499.0 < 0.1, "mean step {}", steps / 499.0);
    }

    #[test]
    fn clouds_without_extent_have_an_order() {
        for positions in [vec![], vec![Vec3::ONE], vec![Vec3::ONE; 3]] {
            let expected: Vec<u32> = (0..positions.len() as u32).collect();
            assert_eq!(spatial_order(&positions), expected);
        }
    }
}
