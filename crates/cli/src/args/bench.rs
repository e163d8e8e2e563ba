//! The arguments of `surfine bench`.

use super::variant::VariantArgs;
use super::{ADAPTER_ON_CPU, ThreadArgs};
use clap::builder::NonEmptyStringValueParser;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;
use surfine::{Boundary, RefineParams};

/// Sizes without `--sizes`: as many of them as a minute for each backend and the memory allow.
const USUAL_SIZES: [usize; 4] = [10_000, 100_000, 1_000_000, 10_000_000];

const EXAMPLES: &str = "\
Examples:
  surfine bench                                 both backends, as large as a minute for each allows
  surfine bench --sizes 100k,1M --runs 5
  surfine bench --backend gpu --adapter nvidia --sizes 10M
  surfine bench --input scan.ply --levels 2     your own cloud
  surfine bench --json | jq '.cases[] | {points_out, same_bytes, gpu}'

The clouds are blue noise on a sphere; those above 50000 points are made by refining smaller ones, since
blue noise of millions takes minutes. Each backend refines each cloud once without being measured (kernels
are compiled, buffers grow), then --runs times; the time is that of the median run. Row `gpu`: the result
stays on the device; row `gpu, read back`: it is copied to the host. Both begin with the copy of the input
to the device. A size is left out, and this is said, if it would take more memory than there is (Linux
only) or, without --sizes, if the backend would then have taken more than a minute in all. Both backends
must give the same bytes on a software adapter in mode exact: if they do not, the command fails.";

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BenchArgs {
    /// Numbers of points that the spheres have when they are refined, about; each 100 to 100M, where k stands for
    /// thousands and M for millions [default: 10k,100k,1M,10M, as many of them as time and memory allow]
    #[arg(long, value_name = "N,...", value_delimiter = ',', value_parser = size)]
    sizes: Option<Vec<usize>>,
    /// PLY file of points to refine instead of spheres, as for `surfine refine`; no holes are filled
    #[arg(long, value_name = "FILE", conflicts_with = "sizes")]
    pub(crate) input: Option<PathBuf>,
    /// Number of refinement steps, 1 to 20; each multiplies the points by about 3
    #[arg(long, value_name = "N", default_value = "3")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=20))]
    levels: u32,
    /// What to measure
    #[arg(long, value_enum, value_name = "WHERE", default_value_t)]
    backend: BenchBackend,
    /// GPU adapter whose name or driver contains NAME, in any case
    #[arg(long, value_name = "NAME", value_parser = NonEmptyStringValueParser::new())]
    pub(crate) adapter: Option<String>,
    /// Measured runs of each size and backend, 1 to 1000
    #[arg(long, value_name = "N", default_value = "3")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(crate) runs: u16,
    /// Also refine on the GPU in slices, as beside an application's frames, and tell how long they take: each is meant
    /// to take MS milliseconds, 0.1 to 1000
    #[arg(long, value_name = "MS", value_parser = budget)]
    pub(crate) slice: Option<Duration>,
    /// The surface is closed: look for no boundary
    #[arg(long)]
    closed: bool,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    /// Print neither progress nor warnings; the tables and errors stay
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Print the tables as one JSON object, and no progress
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    variant: VariantArgs,
}

/// What is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum BenchBackend {
    /// The CPU and, if there is one, a GPU adapter, hardware before software ones
    #[default]
    Both,
    /// What `refine` would take: a hardware GPU if there is one, else the CPU
    Auto,
    /// A GPU adapter, hardware before software ones; fails rather than fall back to the CPU
    Gpu,
    /// The CPU
    Cpu,
}

impl BenchArgs {
    /// Options that do not go together.
    pub(super) fn problem(&self) -> Option<&'static str> {
        let is_cpu = self.backend == BenchBackend::Cpu;
        (is_cpu && self.adapter.is_some()).then_some(ADAPTER_ON_CPU)
    }

    /// What is measured, with what `--adapter` implies.
    pub(crate) fn backend(&self) -> BenchBackend {
        match self.backend {
            BenchBackend::Auto if self.adapter.is_some() => BenchBackend::Gpu,
            backend => backend,
        }
    }

    /// The sizes, rising, and whether the user asked for them.
    pub(crate) fn sizes(&self) -> (Vec<usize>, bool) {
        let mut sizes = self.sizes.clone().unwrap_or(USUAL_SIZES.into());
        sizes.sort_unstable();
        sizes.dedup();
        (sizes, self.sizes.is_some())
    }

    /// The parameters of each run.
    pub(crate) fn params(&self) -> RefineParams {
        let usual = RefineParams::default();
        let boundary = if self.closed { Boundary::None } else { usual.boundary.clone() };
        self.variant.applied_to(RefineParams { levels: self.levels, boundary, ..usual })
    }
}

/// A number of points: 25000, 100k, 2.5M.
fn size(text: &str) -> Result<usize, String> {
    let wrong = "it must be a number of points from 100 to 100M, like 25000, 100k or 2.5M";
    let (digits, unit) = match text.char_indices().last() {
        Some((end, 'k')) => (&text[..end], 1e3),
        Some((end, 'M')) => (&text[..end], 1e6),
        _ => (text, 1.0),
    };
    let points = digits.parse::<f64>().map_err(|_| wrong)? * unit;
    if (100.0..=1e8).contains(&points) { Ok(points.round() as usize) } else { Err(wrong.into()) }
}

/// Milliseconds: 4, 16.7.
fn budget(text: &str) -> Result<Duration, String> {
    let ms = text.parse::<f64>().ok().filter(|ms| (0.1..=1000.0).contains(ms));
    let ms = ms.ok_or("it must be a number of milliseconds from 0.1 to 1000, like 4 or 16.7")?;
    Ok(Duration::from_secs_f64(ms / 1e3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read() {
        let good = [("100", 100), ("10k", 10_000), ("2.5M", 2_500_000), ("100M", 100_000_000)];
        good.iter().for_each(|&(text, points)| assert_eq!(size(text), Ok(points), "{text}"));
        for wrong in ["", "k", "99", "101M", "nan", "-1k", "1G", "1 k", "\u{e9}"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
