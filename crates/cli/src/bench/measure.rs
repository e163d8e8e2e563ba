//! Timed runs of one cloud on one backend.

use super::slices::Sliced;
use std::time::{Duration, Instant};
use surfine::{Error, LevelReport, PointSet, RefineParams, Refined, Refiner};
use surfine_points::add_stage_time;

/// What is run, and how often it is measured.
pub(super) struct Plan<'a> {
    pub(super) points: &'a PointSet,
    pub(super) params: &'a RefineParams,
    pub(super) runs: u16,
    /// Hears which run begins: `warm-up`, `run 2 of 3`.
    pub(super) tell: &'a dyn Fn(&str),
}

/// One run.
pub(super) struct Run {
    pub(super) time: Duration,
    /// Sums over the levels.
    pub(super) stages: Vec<(&'static str, Duration)>,
}

/// What a backend took for a cloud.
pub(super) struct Measured {
    pub(super) refined: Refined,
    /// The runs from the fastest to the slowest. On a GPU the result stayed there.
    pub(super) runs: Vec<Run>,
    /// On a GPU, runs that read the result back.
    pub(super) read_back: Option<Vec<Run>>,
    /// On a GPU, runs in slices, if they are wanted.
    pub(super) sliced: Vec<Sliced>,
}

impl Measured {
    /// Of all runs, those in slices too, if that before them took no longer: it may have compiled kernels, which larger
    /// clouds won't.
    pub(super) fn time(&self) -> Duration {
        let runs = self.runs.iter().chain(self.read_back.iter().flatten()).map(|run| run.time);
        let sliced = self.sliced.iter().map(Sliced::time);
        median(&self.runs).time + runs.chain(sliced).sum::<Duration>()
    }
}

/// The median, or the faster of two in the middle: it is a run that took place, so its stages fit its time.
pub(super) fn median(runs: &[Run]) -> &Run {
    &runs[(runs.len() - 1) / 2]
}

pub(super) fn on_cpu(plan: &Plan<'_>) -> Result<Measured, surfine_reference::Error> {
    let refine = || surfine_reference::refine(plan.points, plan.params);
    (plan.tell)("warm-up");
    refine()?;
    let mut refined = Refined::default();
    let runs = timed(plan, "", || {
        // The last result goes first: two are not needed at once, and freeing it is not measured.
        refined = Refined::default();
        let begin = Instant::now();
        refined = refine()?;
        Ok::<_, surfine_reference::Error>(run(begin, &refined.reports))
    })?;
    Ok(Measured { refined, runs, read_back: None, sliced: Vec::new() })
}

pub(super) fn on_gpu(plan: &Plan<'_>, refiner: &mut Refiner) -> Result<Measured, Error> {
    (plan.tell)("warm-up");
    refiner.refine_on_device(plan.points, plan.params, &mut |_| ())?;
    let runs = timed(plan, "", || {
        let begin = Instant::now();
        let result = refiner.refine_on_device(plan.points, plan.params, &mut |_| ())?;
        // The last commands may still run when a result that stays on the device is there.
        refiner.gpu().wait()?;
        Ok::<_, Error>(run(begin, &result.reports))
    })?;
    let mut refined = Refined::default();
    let read_back = timed(plan, " with the result read back", || {
        refined = Refined::default();
        let begin = Instant::now();
        refined = refiner.refine(plan.points, plan.params)?;
        Ok::<_, Error>(run(begin, &refined.reports))
    })?;
    Ok(Measured { refined, runs, read_back: Some(read_back), sliced: Vec::new() })
}

/// Runs as often as planned, and sorts by time.
fn timed<E>(
    plan: &Plan<'_>,
    how: &str,
    mut work: impl FnMut() -> Result<Run, E>,
) -> Result<Vec<Run>, E> {
    let mut runs = Vec::new();
    for number in 1..=plan.runs {
        (plan.tell)(&format!("run {number} of {}{how}", plan.runs));
        runs.push(work()?);
    }
    runs.sort_by_key(|run| run.time);
    Ok(runs)
}

fn run(begin: Instant, reports: &[LevelReport]) -> Run {
    let time = begin.elapsed();
    let mut stages = Vec::new();
    for &(stage, time) in reports.iter().flat_map(|report| &report.stages) {
        add_stage_time(&mut stages, stage, time);
    }
    Run { time, stages }
}

/// Milliseconds.
pub(super) fn ms(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_that_of_all_runs() {
        let run = |ms| Run { time: Duration::from_millis(ms), stages: Vec::new() };
        let sliced =
            |ms| Sliced::new(Duration::from_millis(4), vec![[Duration::from_millis(ms); 2]]);
        let measured = Measured {
            refined: Refined::default(),
            runs: vec![run(1), run(2), run(30)],
            read_back: Some(vec![run(400)]),
            sliced: vec![sliced(5000), sliced(60_000)],
        };
        let ms = |ms| Duration::from_millis(ms);
        assert_eq!(median(&measured.runs).time, ms(2));
        assert_eq!(measured.time(), ms(2 + 33 + 400 + 65_000));
    }
}
