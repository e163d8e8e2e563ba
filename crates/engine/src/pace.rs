//! How much work fits in a slice of a run, learned from the slices before it.

use std::time::Duration;

/// The part of a budget that is filled: times vary.
const FILLED: f64 = 0.75;
/// What a dispatch takes besides its invocations, in seconds.
const DISPATCH: f64 = 20e-6;
/// What an invocation is believed to take before its kernel was timed, in seconds.
const CAUTIOUS: f64 = 4e-6;
/// What an invocation takes at least, in seconds.
const LEAST_RATE: f64 = 1e-12;
/// What a zeroed word takes, in seconds: that of a slow memory, as it is not timed.
const CLEARED_WORD: f64 = 1e-9;
/// Invocations of the smallest part: a workgroup.
const LEAST: u32 = crate::kernel::WORKGROUP_SIZE;

/// The rates of the kernels, and what is left of the slice.
#[derive(Debug, Default)]
pub(crate) struct Pace {
    /// Seconds that a whole slice may be filled with, and those that are not taken yet.
    whole: f64,
    left: f64,
    rates: Vec<Rate>,
}

#[derive(Debug)]
struct Rate {
    kernel: &'static str,
    /// Seconds of an invocation.
    seconds: f64,
    /// The most invocations that were timed at once.
    largest: f64,
}

impl Pace {
    /// Begins a slice.
    pub(crate) fn refill(&mut self, budget: Duration) {
        self.whole = FILLED * budget.as_secs_f64();
        self.left = self.whole;
    }

    /// Takes what fits of so many invocations from the slice: all of them, or whole workgroups; none if it is full. A
    /// slice that nothing was taken from has room for a workgroup, however small it is.
    pub(crate) fn take(&mut self, kernel: &'static str, wanted: u32) -> u32 {
        let seconds = self.seconds(kernel);
        let fitting = (self.left - DISPATCH).max(0.0) / seconds;
        let least = if self.left == self.whole { LEAST } else { 0 };
        let taken = if f64::from(wanted) <= fitting {
            wanted
        } else {
            // Below `wanted`, so it is no large number.
            (fitting as u32 / LEAST * LEAST).max(least).min(wanted)
        };
        if taken > 0 {
            self.left -= f64::from(taken) * seconds + DISPATCH;
        }
        taken
    }

    /// Takes the time that it takes to zero so many words, which is not cut.
    pub(crate) fn take_clear(&mut self, words: u64) {
        self.left -= words as f64 * CLEARED_WORD;
    }

    /// What a dispatch is expected to take, in seconds.
    pub(crate) fn expected(&self, kernel: &str, invocations: u32) -> f64 {
        f64::from(invocations) * self.seconds(kernel) + DISPATCH
    }

    /// Notes what a dispatch took. Small ones say little about large ones, but what fills a slice counts, whatever
    /// larger ones there were.
    pub(crate) fn learn(&mut self, kernel: &'static str, invocations: u32, seconds: f64) {
        let whole = self.whole;
        let rate = match self.rates.iter().position(|r| r.kernel == kernel) {
            Some(i) => &mut self.rates[i],
            None => {
                self.rates.push(Rate { kernel, seconds: CAUTIOUS, largest: 0.0 });
                self.rates.last_mut().expect("it was just pushed")
            }
        };
        let count = f64::from(invocations.max(1));
        rate.largest = rate.largest.max(count);
        let fitting = whole / rate.seconds;
        let weight = count / (count + rate.largest.min(fitting) / 2.0);
        let measured = ((seconds - DISPATCH) / count).max(LEAST_RATE);
        // A third of the old rate stays, so no part is more than three times as large as the one before.
        let weight = if measured < rate.seconds { weight.min(2.0 / 3.0) } else { weight };
        rate.seconds += (measured - rate.seconds) * weight;
    }

    fn seconds(&self, kernel: &str) -> f64 {
        self.rates.iter().find(|r| r.kernel == kernel).map_or(CAUTIOUS, |r| r.seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: Duration = Duration::from_millis(4);

    fn refilled(pace: &mut Pace) -> &mut Pace {
        pace.refill(BUDGET);
        pace
    }

    #[test]
    fn the_first_part_is_small_and_parts_grow_by_steps() {
        let mut pace = Pace::default();
        let mut before = refilled(&mut pace).take("kernel", u32::MAX);
        assert!((LEAST..=1024).contains(&before), "{before}");
        for _ in 0..30 {
            // A nanosecond each.
            pace.learn("kernel", before, f64::from(before) * 1e-9 + DISPATCH);
            let now = refilled(&mut pace).take("kernel", u32::MAX);
            assert!(now <= 3 * (before + LEAST) && now + LEAST >= before, "{before}, then {now}");
            before = now;
        }
        let ideal = (FILLED * BUDGET.as_secs_f64() - DISPATCH) / 1e-9;
        assert!(f64::from(before) > 0.95 * ideal && f64::from(before) <= ideal, "{before}");
    }

    #[test]
    fn a_slower_kernel_gets_smaller_parts() {
        let mut pace = Pace::default();
        (0..40).for_each(|_| refilled(&mut pace).learn("kernel", 1_000_000, 1e-3));
        let fast = refilled(&mut pace).take("kernel", u32::MAX);
        pace.learn("kernel", fast, 40e-3);
        assert!(refilled(&mut pace).take("kernel", u32::MAX) < fast / 5);
    }

    #[test]
    fn small_dispatches_say_little_of_large_ones() {
        let mut pace = Pace::default();
        (0..40).for_each(|_| refilled(&mut pace).learn("kernel", 100_000, 1e-3));
        let before = pace.seconds("kernel");
        (0..10).for_each(|_| pace.learn("kernel", 1, 2.0 * DISPATCH));
        assert!(pace.seconds("kernel") < 1.5 * before);
    }

    #[test]
    fn a_full_slice_takes_nothing_and_an_empty_one_always_something() {
        let mut pace = Pace::default();
        pace.refill(Duration::ZERO);
        assert_eq!(pace.take("kernel", 1000), LEAST);
        assert_eq!(pace.take("kernel", 1000), 0);
        pace.refill(Duration::ZERO);
        assert_eq!(pace.take("kernel", 10), 10);
        pace.refill(Duration::MAX);
        assert_eq!(pace.take("kernel", u32::MAX), u32::MAX);
    }

    #[test]
    fn parts_are_whole_workgroups_but_for_the_last() {
        let mut pace = Pace::default();
        let taken = refilled(&mut pace).take("kernel", 1_000_000);
        assert_eq!(taken % LEAST, 0);
        assert_eq!(refilled(&mut pace).take("kernel", 65), 65);
    }
}
