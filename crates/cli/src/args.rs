//! The command line.

mod bench;
mod common;
mod evaluate;
mod holes;
mod refine;
mod render;
mod variant;

pub(crate) use bench::{BenchArgs, BenchBackend};
use common::{SummaryArgs, ThreadArgs};
pub(crate) use evaluate::EvaluateArgs;
pub(crate) use holes::{FillArgs, FillChoice, HolesArgs};
pub(crate) use refine::RefineArgs;
pub(crate) use render::{ColorChoice, RenderArgs};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use surfine_points::shapes::Shape;

const EXAMPLES: &str = "\
Examples:
  surfine sample torus -n 20000 -o torus.ply    make a cloud to try
  surfine refine torus.ply -o fine.ply          refine it twice: about 9 times the points
  surfine render torus.ply fine.ply -o both.png look at both, side by side
  surfine evaluate fine.ply --truth mesh.ply    measure how far it is from the true surface
  surfine holes torus.ply                       list its holes, for `surfine fill`
  surfine adapters                              show what the GPU backend could use
  surfine bench                                 measure how fast this machine refines
  surfine help refine                           show all options of a command

Exit codes: 0 success, 1 failure (one line on standard error), 2 wrong usage.";

const ADAPTERS_EXAMPLES: &str = "\
Examples:
  surfine adapters
  surfine adapters --json | jq '.adapters[].name'
  WGPU_ADAPTER_NAME=llvmpipe surfine adapters

A software adapter computes on the CPU; `refine --backend auto` takes the CPU backend instead, which is
faster, unless WGPU_ADAPTER_NAME names the adapter. Mode exact: results have the very bytes of the CPU
backend if the driver rounds division and square root correctly, as software drivers do. Mode plain:
results can differ from it in rounding.";

const SAMPLE_EXAMPLES: &str = "\
Examples:
  surfine sample sphere -n 1000 -o sphere.ply
  surfine sample torus -n 50000 -o torus.ply --random --seed 7
  surfine sample plane -n 400 -o plane.ply --ascii

Sizes: sphere of radius 1; torus of radii 1 and 0.4; ellipsoid of semi-axes 1, 0.7 and 0.45; saddle
z = 0.4 (x^2 - y^2) and plane z = 0 over the square |x|, |y| <= 1. Points get exact normals and natural
radii. The same arguments give the same bytes everywhere.";

/// Refines clouds of oriented points on the GPU or the CPU.
#[derive(Debug, Parser)]
#[command(name = "surfine", version, after_help = EXAMPLES)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Refine a cloud: keep its points, insert new ones on the smooth surface through them
    Refine(RefineArgs),
    /// List the boundary loops of a cloud: holes and outer rims
    Holes(HolesArgs),
    /// Fill holes with points as dense as those around them
    Fill(FillArgs),
    /// Draw clouds as splats into a PNG file
    Render(RenderArgs),
    /// Measure how well a cloud shows a true surface
    Evaluate(EvaluateArgs),
    /// List the GPU adapters of this machine
    Adapters(AdaptersArgs),
    /// Measure how fast this machine refines, on the CPU and on the GPU
    Bench(BenchArgs),
    /// Make a cloud on a simple surface
    Sample(SampleArgs),
}

#[derive(Debug, Args)]
#[command(after_help = ADAPTERS_EXAMPLES)]
pub(crate) struct AdaptersArgs {
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = SAMPLE_EXAMPLES)]
pub(crate) struct SampleArgs {
    /// The surface
    #[arg(value_parser = shape())]
    pub(crate) shape: Shape,
    /// Number of points, 0 to 100000000
    #[arg(short = 'n', long = "points", value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=100_000_000))]
    pub(crate) points: u32,
    /// PLY file to write; it appears whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Put each point anywhere, with clusters and gaps, instead of evenly (blue noise: minutes for millions of points)
    #[arg(long)]
    pub(crate) random: bool,
    /// Seed of the random numbers, 0 to 2^64 - 1
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Write decimal text instead of little-endian binary
    #[arg(long)]
    pub(crate) ascii: bool,
}

/// What the user wants to compute with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum BackendChoice {
    /// A hardware GPU if there is one, else the CPU
    #[default]
    Auto,
    /// A GPU adapter, hardware before software ones; fails rather than fall back to the CPU
    Gpu,
    /// The CPU
    Cpu,
}

impl Cli {
    /// Reads the command line; help, version and wrong usage end the program.
    pub(crate) fn from_command_line() -> Self {
        let cli = Self::parse();
        let (command, problem) = match &cli.command {
            Command::Refine(args) => ("refine", args.problem()),
            Command::Render(args) => ("render", args.problem()),
            Command::Bench(args) => ("bench", args.problem()),
            _ => ("", None),
        };
        if let Some(problem) = problem {
            let mut root = Self::command();
            // The usage line of the error is then that of the command.
            root.build();
            let command = root.find_subcommand_mut(command).expect("it was just parsed");
            command.error(ErrorKind::ArgumentConflict, problem).exit();
        }
        cli
    }
}

/// What is wrong with an adapter on a backend without one.
const ADAPTER_ON_CPU: &str = "the argument '--adapter <NAME>' cannot be used with '--backend cpu'";

fn shape() -> impl TypedValueParser<Value = Shape> {
    let names = PossibleValuesParser::new(Shape::ALL.map(Shape::name));
    names.try_map(|name| name.parse::<Shape>())
}

fn number(text: &str) -> Result<f32, String> {
    text.parse().map_err(|_| "it must be a number like 0.5".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definition_is_sound() {
        Cli::command().debug_assert();
    }
}
