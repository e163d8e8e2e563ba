//! Options that several commands have.

use crate::watch::Watch;
use crate::{Failure, print, print_json};
use clap::Args;
use serde::Serialize;
use std::fmt::Display;

#[derive(Args, Debug)]
pub(crate) struct ThreadArgs {
    /// Number of CPU threads, 1 to 1024 [default: all cores, or `RAYON_NUM_THREADS`]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// Gives the CPU its threads; without a wish, those of `RAYON_NUM_THREADS` or one a core.
    pub(crate) fn start(&self) -> Result<(), Failure> {
        let by_variable = std::env::var("RAYON_NUM_THREADS").ok().and_then(|n| n.parse().ok());
        // So many would take for ever to start.
        if let (None, Some(many @ 1025usize..)) = (self.threads, by_variable) {
            return Err(Failure(format!(
                "RAYON_NUM_THREADS is {many}: set it to 1024 at the most"
            )));
        }
        let threads = self.threads.unwrap_or(0).into();
        let failed =
            |e| Failure(format!("threads cannot be started: {e}: ask for fewer (--threads)"));
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(failed)
    }
}

/// What a command that writes a cloud prints.
#[derive(Args, Debug)]
pub(crate) struct SummaryArgs {
    /// Print neither progress nor summary; warnings and errors stay
    #[arg(short, long)]
    quiet: bool,
    /// Print the summary as one JSON object, and no progress
    #[arg(long)]
    json: bool,
}

impl SummaryArgs {
    /// The progress, as far as the user wants to see it.
    pub(crate) fn watch(&self) -> Watch {
        Watch::new(self.quiet || self.json)
    }

    /// Whether [`SummaryArgs::print`] prints anything.
    pub(crate) fn shows_summary(&self) -> bool {
        self.json || !self.quiet
    }

    /// Prints a summary, as far as the user wants to know.
    pub(crate) fn print(&self, summary: &(impl Serialize + Display)) -> Result<(), Failure> {
        if self.json {
            print_json(summary)
        } else if self.quiet {
            Ok(())
        } else {
            print(&summary.to_string())
        }
    }
}
