//! The line on standard error that shows where a long computation stands.

use crate::warn;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;
use surfine::Progress;

/// Shows progress if somebody looks.
pub(crate) struct Watch {
    bar: ProgressBar,
}

impl Watch {
    /// Shows nothing where standard error is no terminal, or where the user wants silence.
    pub(crate) fn new(quiet: bool) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden() };
        }
        let bar = ProgressBar::new_spinner();
        let style = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}");
        bar.set_style(style.expect("the template is sound"));
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar }
    }

    /// A step before or after the refinement.
    pub(crate) fn step(&self, text: String) {
        self.bar.set_message(text);
    }

    /// A stage of the refinement.
    pub(crate) fn at(&self, at: Progress) {
        let Progress { level, levels, stage, points } = at;
        self.step(format!("level {level}/{levels}, {points} points: {stage}"));
    }

    /// Does something without the progress in its way.
    pub(crate) fn suspend<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    /// A line that stays, above the progress.
    pub(crate) fn warn(&self, message: &str) {
        self.bar.suspend(|| warn(message));
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
