//! The command line.

mod bench;
mod common;
mod evaluate;
mod holes;
mod render;

pub(crate) use bench::{BenchArgs, BenchBackend};
use common::{SummaryArgs, ThreadArgs};
pub(crate) use evaluate::EvaluateArgs;
pub(crate) use holes::{FillArgs, FillChoice, HolesArgs};
pub(crate) use render::{ColorChoice, RenderArgs};

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use surfine::{Boundary, Neighborhood, RefineParams, Rules};
use surfine_points::Interpolation;
use surfine_points::shapes::Shape;

const EXAMPLES: &str = "\
Examples:
  surfine sample torus -n 20000 -o torus.ply    make a cloud to try
  surfine refine torus.ply -o fine.ply          refine it twice: about 9 times the points
  surfine render torus.ply fine.ply -o both.png look at both, side by side
  surfine adapters                              show what the GPU backend could use
  surfine bench                                 measure how fast this machine refines
  surfine help refine                           show all options of a command

Exit codes: 0 success, 1 failure (one line on standard error), 2 wrong usage.";

const REFINE_EXAMPLES: &str = "\
Examples:
  surfine refine scan.ply -o fine.ply
  surfine refine scan.ply -o fine.ply --levels 3 --backend gpu
  surfine refine scan.ply -o fine.ply --ascii --provenance --quiet
  surfine refine scan.ply -o fine.ply --fill-holes all
  surfine refine scan.ply -o fine.ply --attribute intensity=nearest --attribute tx,ty,tz=unit
  surfine refine part.ply -o fine.ply --boundary-property rim
  surfine refine scan.ply -o fine.ply --json | jq .points_per_second
  surfine refine scan.ply -o fine.ply --levels 5 --dry-run   what it would take

The points of IN come first in FILE, in their order and unchanged but for their radii; the new points
follow level by level. Points on creases have further normals
nx2 ny2 nz2 and, at corners, nx3 ny3 nz3 (zero elsewhere), or a record for each normal; creases stay sharp. Both backends give the same bytes if the adapter's mode is exact
and its driver rounds division and square root correctly. All parameters
are free of scale; lengths have the unit of IN.";

const ADAPTERS_EXAMPLES: &str = "\
Examples:
  surfine adapters
  surfine adapters --json | jq '.adapters[].name'
  WGPU_ADAPTER_NAME=llvmpipe surfine adapters

A software adapter computes on the CPU; `refine --backend auto` then takes the CPU backend, which is
faster. Mode exact: the very bytes of the CPU backend if the driver rounds division and square root
correctly, as software drivers do. Mode plain: results can differ in rounding.";

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
#[command(after_help = REFINE_EXAMPLES)]
pub(crate) struct RefineArgs {
    /// PLY file of points: x y z, nx ny nz (unit length, outward), radius; nx2 ny2 nz2 and nx3 ny3 nz3 on creases and
    /// corners; more properties are kept
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// PLY file to write, not IN; it appears whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Number of refinement steps, 0 to 20; each multiplies the points by about 3
    #[arg(long, value_name = "N", default_value = "2", value_parser = levels)]
    levels: u32,
    /// Where to compute
    #[arg(long, value_enum, value_name = "WHERE", default_value_t)]
    backend: BackendChoice,
    /// GPU adapter whose name or driver contains NAME, in any case; implies --backend gpu
    #[arg(long, value_name = "NAME")]
    pub(crate) adapter: Option<String>,
    #[command(flatten)]
    variant: VariantArgs,
    /// Measure the angle between new neighbors straight instead of along the curved surface; implies `--without largest_first`
    #[arg(long)]
    plain_angle: bool,
    /// Tolerance angle of the fuzzy planes, above 0 up to 90 degrees
    #[arg(long, value_name = "DEG", default_value = "30", value_parser = theta_f)]
    #[arg(allow_negative_numbers = true)]
    theta_f: f32,
    /// Largest angle of a complete new neighborhood, above 0 and below 180 degrees; implies `--without largest_first` [default: 89]
    #[arg(long, value_name = "DEG", value_parser = theta_c)]
    #[arg(allow_negative_numbers = true)]
    theta_c: Option<f32>,
    /// Share of the distance to the farthest neighbors that new points count at least as large as, above 0 up to 1 (not with
    /// --simplified); with `--without largest_first` the share of the radius within which a new point is a new neighbor
    #[arg(long, value_name = "X", default_value = "0.57735026", value_parser = lambda1)]
    #[arg(allow_negative_numbers = true)]
    lambda1: f32,
    /// Share of a new point's size, the distance to the corners of its triangle or more, that is kept free of others, 0 to 1
    #[arg(long, value_name = "X", default_value = "0.5", value_parser = lambda2)]
    #[arg(allow_negative_numbers = true)]
    lambda2: f32,
    /// Widest angle between neighbors that is no boundary, above 90 and below 360 degrees
    #[arg(long, value_name = "DEG", default_value = "160", value_parser = theta_b)]
    #[arg(allow_negative_numbers = true)]
    boundary_angle: f32,
    /// Take as boundary points those with a value other than 0 in this property, whatever the angle
    #[arg(long, value_name = "PROPERTY", conflicts_with = "boundary_angle")]
    pub(crate) boundary_property: Option<String>,
    /// The surface is closed: look for no boundary
    #[arg(long, conflicts_with_all = ["boundary_angle", "boundary_property"])]
    closed: bool,
    /// Fill holes first: raised (those with radii raised by hand to close them), none, all (holes, no outer rims), ids as
    /// `surfine holes` lists them, or max-span=X [default: raised; none with --literal]
    #[arg(long, value_name = "WHICH", value_parser = holes::choice)]
    fill_holes: Option<FillChoice>,
    /// How new points get a property: linear, nearest (corner), vote (of the corners) or unit, a direction, for three
    /// properties at once; may be given several times
    #[arg(long, value_name = "PROPERTY=RULE", value_parser = attribute_rule)]
    pub(crate) attribute: Vec<(Vec<String>, Interpolation)>,
    /// Write decimal text instead of little-endian binary
    #[arg(long)]
    pub(crate) ascii: bool,
    /// Write where each point comes from: properties level, parent0, parent1, parent2
    #[arg(long)]
    pub(crate) provenance: bool,
    /// Show how radii and co-cone angles fall from level to level; the GPU backend reads each level back for it
    #[arg(long)]
    pub(crate) stats: bool,
    /// Write nothing: print about how many points, how much memory, time and disk the refinement would take, and whether
    /// that fits; it fails if it surely does not. The time comes from a sphere that is refined for a moment
    #[arg(long)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    #[command(flatten)]
    pub(crate) summary: SummaryArgs,
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
    /// Put each point anywhere, with clusters and gaps, instead of evenly (blue noise)
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
    /// Any GPU adapter, software ones too
    Gpu,
    /// The CPU
    Cpu,
}

/// The variants of the paper.
#[derive(Args, Debug)]
struct VariantArgs {
    /// Which points are neighbors
    #[arg(long, value_enum, value_name = "KIND", default_value_t)]
    neighborhood: NeighborhoodChoice,
    /// Some 1.5 times as fast, for dense smooth clouds: Euclidean distances, no rules for irregular samples, and triangles on which
    /// their corners agree are refined unasked; implies fuzzy
    #[arg(long)]
    simplified: bool,
    /// Keep to the text of the paper: without any rule of --without. Boundaries are still found (see --closed)
    #[arg(long)]
    literal: bool,
    /// Leave out one rule beyond the paper; may be given several times
    #[arg(long, value_name = "RULE", value_parser = rule(), conflicts_with = "literal")]
    without: Vec<String>,
}

impl VariantArgs {
    /// The rules beyond the paper; the names were checked.
    fn rules(&self) -> Rules {
        let mut rules = if self.literal { Rules::LITERAL } else { Rules::ALL };
        for name in &self.without {
            *rules.get_mut(name).expect("the name was checked") = false;
        }
        rules
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum NeighborhoodChoice {
    /// For any sampling
    #[default]
    Accurate,
    /// Faster, for well-sampled clouds
    Fuzzy,
}

impl From<NeighborhoodChoice> for Neighborhood {
    fn from(choice: NeighborhoodChoice) -> Self {
        match choice {
            NeighborhoodChoice::Accurate => Self::Accurate,
            NeighborhoodChoice::Fuzzy => Self::Fuzzy,
        }
    }
}

impl Cli {
    /// Reads the command line; help, version and wrong usage end the program.
    pub(crate) fn from_command_line() -> Self {
        let cli = Self::parse();
        let no_gpu = match &cli.command {
            Command::Refine(args) if args.backend == BackendChoice::Cpu => {
                args.adapter.as_ref().map(|_| "refine")
            }
            Command::Bench(args) if args.backend == BenchBackend::Cpu => {
                args.adapter.as_ref().map(|_| "bench")
            }
            _ => None,
        };
        if let Some(name) = no_gpu {
            let mut root = Self::command();
            // The usage line of the error is then that of the command.
            root.build();
            let command = root.find_subcommand_mut(name).expect("it was just parsed");
            let text = "the argument '--adapter <NAME>' cannot be used with '--backend cpu'";
            command.error(ErrorKind::ArgumentConflict, text).exit();
        }
        cli
    }
}

impl RefineArgs {
    /// The backend, with what `--adapter` implies.
    pub(crate) fn backend(&self) -> BackendChoice {
        if self.adapter.is_some() { BackendChoice::Gpu } else { self.backend }
    }

    /// Which holes are filled; by the text none are, and raised radii close them.
    pub(crate) fn fill_holes(&self) -> FillChoice {
        let usual = if self.variant.literal { FillChoice::None } else { FillChoice::Raised };
        self.fill_holes.clone().unwrap_or(usual)
    }

    /// Whether the levels are measured: not where nothing would show it.
    pub(crate) fn shows_stats(&self) -> bool {
        self.stats && self.summary.shows_summary()
    }

    /// The parameters; each was checked when it was parsed.
    pub(crate) fn params(&self) -> RefineParams {
        let usual = RefineParams::default();
        let mut rules = self.variant.rules();
        // Only the paper's selection knows these.
        rules.largest_first &= self.theta_c.is_none() && !self.plain_angle;
        let boundary = match &self.boundary_property {
            _ if self.closed => Boundary::None,
            Some(name) => Boundary::Marked(name.clone()),
            None => Boundary::Angle(self.boundary_angle),
        };
        let &Self { levels, plain_angle, theta_f, lambda1, lambda2, .. } = self;
        RefineParams {
            levels,
            neighborhood: self.variant.neighborhood.into(),
            simplified: self.variant.simplified,
            plain_angle,
            theta_f,
            theta_c: self.theta_c.unwrap_or(usual.theta_c),
            lambda1,
            lambda2,
            boundary,
            rules,
            keep_radii: self.shows_stats(),
        }
    }
}

fn shape() -> impl TypedValueParser<Value = Shape> {
    let names = PossibleValuesParser::new(Shape::ALL.map(Shape::name));
    names.try_map(|name| name.parse::<Shape>())
}

/// Names of properties and their rule: `label=vote`, `tx,ty,tz=unit`.
fn attribute_rule(text: &str) -> Result<(Vec<String>, Interpolation), String> {
    let wrong = "it must be like label=vote or tx,ty,tz=unit, with linear, nearest, vote or unit";
    let (names, rule) = text.split_once('=').ok_or(wrong)?;
    let names: Vec<String> = names.split(',').map(str::to_owned).collect();
    let named = Interpolation::NAMED.into_iter().find(|(name, _)| *name == rule);
    let (_, rule) = named.ok_or(wrong)?;
    if rule == Interpolation::Unit && names.len() != 3 {
        return Err("a direction has three properties: tx,ty,tz=unit".into());
    }
    if names.iter().any(String::is_empty) { Err(wrong.into()) } else { Ok((names, rule)) }
}

fn rule() -> PossibleValuesParser {
    PossibleValuesParser::new(Rules::ALL.named().map(|(name, _)| name))
}

fn levels(text: &str) -> Result<u32, String> {
    let levels = text.parse().map_err(|_| "it must be a whole number from 0 to 20")?;
    let params = RefineParams { levels, ..RefineParams::default() };
    params.validate().map_err(|e| e.to_string())?;
    Ok(levels)
}

/// An angle in degrees, to radians.
fn theta_f(text: &str) -> Result<f32, String> {
    let theta_f = number(text)?.to_radians();
    let params = RefineParams { theta_f, ..RefineParams::default() };
    params.validate().map_err(|_| "it must be above 0 and at most 90 degrees")?;
    Ok(theta_f)
}

/// An angle in degrees, to radians.
fn theta_c(text: &str) -> Result<f32, String> {
    let theta_c = number(text)?.to_radians();
    let params = RefineParams { theta_c, ..RefineParams::default() };
    params.validate().map_err(|_| "it must be above 0 and below 180 degrees")?;
    Ok(theta_c)
}

/// An angle in degrees, to radians.
fn theta_b(text: &str) -> Result<f32, String> {
    let theta_b = number(text)?.to_radians();
    let params = RefineParams { boundary: Boundary::Angle(theta_b), ..RefineParams::default() };
    params.validate().map_err(|_| "it must be above 90 and below 360 degrees")?;
    Ok(theta_b)
}

fn lambda1(text: &str) -> Result<f32, String> {
    let lambda1 = number(text)?;
    let params = RefineParams { lambda1, ..RefineParams::default() };
    params.validate().map_err(|_| "it must be above 0 and at most 1")?;
    Ok(lambda1)
}

fn lambda2(text: &str) -> Result<f32, String> {
    let lambda2 = number(text)?;
    let params = RefineParams { lambda2, ..RefineParams::default() };
    params.validate().map_err(|_| "it must be 0 to 1")?;
    Ok(lambda2)
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

    #[test]
    fn defaults_are_those_of_the_library() {
        let cli = Cli::parse_from(["surfine", "refine", "in.ply", "-o", "out.ply"]);
        let Command::Refine(args) = cli.command else { panic!("another command was parsed") };
        assert_eq!(args.params(), RefineParams { levels: 2, ..RefineParams::default() });
    }
}
