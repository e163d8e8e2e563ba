//! The nearest of many points.

use std::num::NonZeroUsize;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use surfine_points::DVec3;

/// A k-d tree of positions in 64 bits.
pub(crate) struct Tree {
    tree: ImmutableKdTree<f64, 3>,
}

impl Tree {
    /// Sorts positions into a tree. There must be one at least, and fewer than 2^32.
    pub(crate) fn new(positions: &[DVec3]) -> Self {
        let entries: Vec<[f64; 3]> = positions.iter().map(|p| p.to_array()).collect();
        let tree = ImmutableKdTree::new_from_slice(&entries);
        Self { tree: tree.expect("models of 2^32 points are turned away when they are checked") }
    }

    /// Index of the nearest position, and its squared distance.
    pub(crate) fn nearest(&self, x: DVec3) -> (usize, f64) {
        let found = self.tree.query(&x.to_array()).nearest_one::<SquaredEuclidean<f64>>().execute();
        (found.item as usize, found.distance)
    }

    /// Indices of the `count` nearest positions, or of all if there are fewer, the nearest first.
    pub(crate) fn nearest_n(&self, x: DVec3, count: usize) -> Vec<u32> {
        let Some(count) = NonZeroUsize::new(count) else { return Vec::new() };
        let query = x.to_array();
        let found = self.tree.query(&query).nearest_n::<SquaredEuclidean<f64>>(count).execute();
        found.into_iter().map(|f| f.item).collect()
    }

    /// Indices of all positions no farther than `radius`, ascending.
    pub(crate) fn within(&self, x: DVec3, radius: f64) -> Vec<u32> {
        let query = x.to_array();
        let ball = self.tree.query(&query).within::<SquaredEuclidean<f64>>(radius * radius);
        let mut found: Vec<u32> = ball.unsorted().execute().into_iter().map(|f| f.item).collect();
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random points, many of them in one plane and on a lattice: equal coordinates are what trees trip over.
    fn positions() -> Vec<DVec3> {
        let mut random = fastrand::Rng::with_seed(3);
        let lattice =
            (0..40).flat_map(|y| (0..40).map(move |x| DVec3::new(x.into(), y.into(), 0.0)));
        let scattered = (0..600).map(|_| DVec3::from_array([(); 3].map(|()| 40.0 * random.f64())));
        lattice.chain(scattered).collect()
    }

    #[test]
    fn answers_are_those_of_brute_force() {
        let positions = positions();
        let tree = Tree::new(&positions);
        let mut random = fastrand::Rng::with_seed(4);
        for round in 0..400 {
            let x = DVec3::from_array([(); 3].map(|()| 44.0 * random.f64() - 2.0));
            let x = if round % 2 == 0 { x } else { x.with_z(0.0).round() };
            let squared = |i: u32| (positions[i as usize] - x).length_squared();
            let mut all: Vec<u32> = (0..positions.len() as u32).collect();
            all.sort_by(|&a, &b| squared(a).total_cmp(&squared(b)));

            let (nearest, distance) = tree.nearest(x);
            approx::assert_relative_eq!(distance, squared(all[0]), max_relative = 1e-14);
            approx::assert_relative_eq!(squared(nearest as u32), distance, max_relative = 1e-14);

            let found: Vec<f64> = tree.nearest_n(x, 9).into_iter().map(squared).collect();
            let expected: Vec<f64> = all[..9].iter().map(|&i| squared(i)).collect();
            assert_eq!(found.len(), 9);
            for (found, expected) in found.into_iter().zip(expected) {
                approx::assert_relative_eq!(found, expected, max_relative = 1e-14);
            }

            // A radius that no distance equals.
            let mut inside: Vec<u32> = all.into_iter().filter(|&i| squared(i) < 12.34567).collect();
            inside.sort_unstable();
            assert_eq!(tree.within(x, 12.34567f64.sqrt()), inside);
        }
    }

    #[test]
    fn many_points_in_one_place_make_a_tree() {
        let mut positions = vec![DVec3::ONE; 500];
        positions.push(DVec3::X);
        let tree = Tree::new(&positions);
        assert_eq!(tree.nearest(DVec3::X), (500, 0.0));
        assert_eq!(tree.nearest(DVec3::new(1.0, 1.0, 2.0)).1, 1.0);
        assert_eq!(tree.within(DVec3::ONE, 0.5).len(), 500);
    }

    #[test]
    fn fewer_points_than_asked_for_are_all_given() {
        let tree = Tree::new(&[DVec3::ZERO, DVec3::X]);
        assert_eq!(tree.nearest_n(DVec3::X, 9), [1, 0]);
    }
}
