//! The times of the stages as the host sees them.

use std::time::{Duration, Instant};
use surfine_points::{Progress, add_stage_time};

/// Times the stages and tells the caller where the run stands.
pub(crate) struct Clock<'a, P> {
    at: Progress,
    progress: &'a mut P,
    times: Vec<(&'static str, Duration)>,
    begin: Instant,
}

impl<'a, P: FnMut(Progress)> Clock<'a, P> {
    /// Begins with no stage.
    pub(crate) fn new(at: Progress, progress: &'a mut P) -> Self {
        Self { at, progress, times: Vec::new(), begin: Instant::now() }
    }

    /// Ends the stage before and begins another one.
    pub(crate) fn start(&mut self, stage: &'static str) {
        self.close();
        self.at.stage = stage;
        (self.progress)(self.at);
    }

    fn close(&mut self) {
        if !self.at.stage.is_empty() {
            add_stage_time(&mut self.times, self.at.stage, self.begin.elapsed());
        }
        self.begin = Instant::now();
    }

    /// Ends the last stage and gives the time of each.
    pub(crate) fn stop(mut self) -> Vec<(&'static str, Duration)> {
        self.close();
        self.times
    }
}
