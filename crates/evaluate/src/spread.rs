//! Many numbers in a few.

use rayon::slice::ParallelSliceMut;
use serde::Serialize;

/// How numbers that aren't negative spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// 95th [`percentile`].
    pub p95: f64,
    /// Largest.
    pub max: f64,
}

/// How angles spread, in degrees from 0 to 180.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Angles {
    /// Mean, degrees.
    pub mean: f64,
    /// Root of the mean square, degrees.
    pub rms: f64,
    /// 95th [`percentile`], degrees.
    pub p95: f64,
    /// Largest, degrees.
    pub max: f64,
    /// Share of angles over 30°, 0 to 1.
    pub over_30: f64,
    /// Share of angles over 90°, 0 to 1: normals that point to the other side.
    pub over_90: f64,
}

/// The smallest of the values that no less than this share (0 to 1) of all values are no larger than: the entry of rank
/// `ceil(share * n)` of the sorted values, counted from 1, and the first for a share of 0. Known as the nearest rank.
///
/// # Panics
/// Without values.
pub fn percentile(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted[rank.clamp(1, sorted.len()) - 1]
}

/// Mean of numbers, summed in their order; 0 of none.
pub(crate) fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len();
    if count == 0 { 0.0 } else { values.sum::<f64>() / count as f64 }
}

/// Share of the values for which the condition holds.
pub(crate) fn share(values: &[f64], holds: impl Fn(f64) -> bool) -> f64 {
    values.iter().filter(|&&v| holds(v)).count() as f64 / values.len() as f64
}

/// The values in ascending order.
pub(crate) fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.par_sort_unstable_by(f64::total_cmp);
    values
}

impl Spread {
    /// Of values that aren't negative, one at least.
    pub(crate) fn of(values: &[f64]) -> Self {
        let sorted = sorted(values.to_vec());
        Self {
            mean: mean(values.iter().copied()),
            rms: mean(values.iter().map(|v| v * v)).sqrt(),
            p95: percentile(&sorted, 0.95),
            max: percentile(&sorted, 1.0),
        }
    }

    /// In another unit, `unit` of this one.
    pub(crate) fn per(self, unit: f64) -> Self {
        let Self { mean, rms, p95, max } = self;
        Self { mean: mean / unit, rms: rms / unit, p95: p95 / unit, max: max / unit }
    }
}

impl Angles {
    /// Of angles in degrees; `None` without any.
    pub(crate) fn of(angles: &[f64]) -> Option<Self> {
        if angles.is_empty() {
            return None;
        }
        let Spread { mean, rms, p95, max } = Spread::of(angles);
        let (over_30, over_90) = (share(angles, |a| a > 30.0), share(angles, |a| a > 90.0));
        Some(Self { mean, rms, p95, max, over_30, over_90 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_of_the_nearest_rank() {
        let twenty: Vec<f64> = (1..=20).map(f64::from).collect();
        // 0.95 * 20 is 19 exactly; one value more and the rank is the next.
        assert_eq!(percentile(&twenty, 0.95), 19.0);
        let more: Vec<f64> = (1..=21).map(f64::from).collect();
        assert_eq!(percentile(&more, 0.95), 20.0);
        assert_eq!(percentile(&twenty, 0.0), 1.0);
        assert_eq!(percentile(&twenty, 0.5), 10.0);
        assert_eq!(percentile(&twenty, 1.0), 20.0);
        assert_eq!(percentile(&[7.0], 0.95), 7.0);
    }

    #[test]
    fn spreads_are_those_by_hand() {
        let spread = Spread::of(&[4.0, 0.0, 3.0, 1.0]);
        assert_eq!(spread, Spread { mean: 2.0, rms: 6.5f64.sqrt(), p95: 4.0, max: 4.0 });
        assert_eq!(spread.per(2.0).mean, 1.0);
        let angles = Angles::of(&[30.0, 31.0, 90.0, 180.0]).expect("there are some");
        assert_eq!((angles.over_30, angles.over_90), (0.75, 0.25));
        assert_eq!(Angles::of(&[]), None);
    }
}
