//! Runs in slices, each slice timed until the device has finished it.

use super::measure::{Plan, ms};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::time::{Duration, Instant};
use surfine::{Error, Gpu, Refiner, Slices};

/// What the slices of a run took, in milliseconds.
#[derive(Clone, Serialize)]
pub(super) struct Sliced {
    budget_ms: f64,
    slices: usize,
    /// From the call until the device has finished.
    mean_ms: f64,
    /// What one slice of a hundred exceeds.
    percentile_99_ms: f64,
    longest_ms: f64,
    /// Until the call returned.
    longest_call_ms: f64,
    whole_ms: f64,
}

/// Refines the cloud twice in slices: how long kernels take is not known before the first run, but before the second.
/// The refiner comes back in any case.
pub(super) fn in_slices(
    mut refiner: Refiner,
    plan: &Plan<'_>,
    budget: Duration,
) -> (Refiner, Result<Vec<Sliced>, Error>) {
    let mut all = Vec::new();
    for number in 1..=2 {
        (plan.tell)(&format!("run {number} of 2 in slices"));
        let gpu = refiner.gpu().clone();
        let mut run = refiner.begin(plan.points.clone(), plan.params.clone());
        let times = drive(&mut run, &gpu, budget);
        refiner = run.into_refiner();
        match times {
            Ok(times) => all.push(Sliced::new(budget, times)),
            Err(error) => return (refiner, Err(error)),
        }
    }
    (refiner, Ok(all))
}

/// The time of each call, and that until the device had finished.
fn drive(run: &mut Slices, gpu: &Gpu, budget: Duration) -> Result<Vec<[Duration; 2]>, Error> {
    let mut times = Vec::new();
    loop {
        let begin = Instant::now();
        let result = run.advance(budget)?;
        let call = begin.elapsed();
        gpu.wait()?;
        times.push([call, begin.elapsed()]);
        if result.is_some() {
            return Ok(times);
        }
    }
}

impl Sliced {
    /// Of the whole run.
    pub(super) fn time(&self) -> Duration {
        Duration::from_secs_f64(self.whole_ms / 1e3)
    }

    pub(super) fn new(budget: Duration, times: Vec<[Duration; 2]>) -> Self {
        let longest_call_ms = times.iter().map(|t| ms(t[0])).fold(0.0, f64::max);
        let mut slices: Vec<f64> = times.iter().map(|t| ms(t[1])).collect();
        slices.sort_by(f64::total_cmp);
        let whole_ms: f64 = slices.iter().sum();
        let last = slices.len() - 1;
        Self {
            budget_ms: ms(budget),
            slices: slices.len(),
            mean_ms: whole_ms / slices.len() as f64,
            percentile_99_ms: slices[last * 99 / 100],
            longest_ms: slices[last],
            longest_call_ms,
            whole_ms,
        }
    }
}

impl Display for Sliced {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { budget_ms, slices, mean_ms, longest_ms, longest_call_ms, whole_ms, .. } = self;
        write!(f, "{slices} slices of {budget_ms} ms: mean {mean_ms:.1} ms, ")?;
        write!(f, "99 % within {:.1} ms, longest {longest_ms:.1} ms, ", self.percentile_99_ms)?;
        write!(f, "longest call {longest_call_ms:.1} ms, all {whole_ms:.1} ms")
    }
}
