//! The arguments of `surfine refine`.

use super::variant::{METHOD, VariantArgs};
use super::{ADAPTER_ON_CPU, BackendChoice, FillChoice, SummaryArgs, ThreadArgs, holes, number};
use clap::Args;
use clap::builder::NonEmptyStringValueParser;
use std::path::PathBuf;
use surfine::{Boundary, RefineParams};
use surfine_points::Interpolation;

const EXAMPLES: &str = "\
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
follow level by level. Creases stay sharp where their points have several normals. Both backends give
the same bytes if the adapter's mode is exact and its driver rounds division and square root correctly.
All parameters are free of scale; lengths have the unit of IN.";

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RefineArgs {
    /// PLY file of points with x y z, nx ny nz and radius
    ///
    /// Normals have unit length and point outward. The radius is at least the distance to the farthest natural
    /// neighbor, best about 1.25 times that. Points on creases have further normals nx2 ny2 nz2 and, at corners,
    /// nx3 ny3 nz3 (zero elsewhere), or a record for each normal. More properties are kept.
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
    #[arg(long, value_name = "NAME", value_parser = NonEmptyStringValueParser::new())]
    pub(crate) adapter: Option<String>,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    /// Look for boundaries where a gap between a point's neighbors is wider than this, above 90 and below 360 degrees
    #[arg(long, value_name = "DEG", default_value = "160", value_parser = theta_b)]
    #[arg(allow_negative_numbers = true)]
    boundary_angle: f32,
    /// Look for boundaries among the points with a value other than 0 in this property, and nowhere else
    #[arg(long, value_name = "PROPERTY", conflicts_with = "boundary_angle")]
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    pub(crate) boundary_property: Option<String>,
    /// The surface is closed: look for no boundary
    #[arg(long, conflicts_with_all = ["boundary_angle", "boundary_property"])]
    closed: bool,
    /// Fill holes first: raised, none, all, ids or max-span=X [default: raised; none with --literal]
    ///
    /// raised: those around which radii were raised by hand, to close them; all: all holes, but no outer rims; ids:
    /// the loops that `surfine holes` lists under them, like 1,3; max-span=X: all loops no wider than X, in the units
    /// of IN, but no outer rims.
    #[arg(long, value_name = "WHICH", value_parser = holes::choice)]
    fill_holes: Option<FillChoice>,
    /// How new points get a property: linear, nearest, vote or unit; may be given several times
    ///
    /// linear: the mean of their triangle's corners, as floats and colors without a rule; nearest: the value of the
    /// nearest corner; vote: that of most corners, as other integers without a rule; unit: a direction, for three
    /// properties at once, like tx,ty,tz=unit.
    #[arg(long, value_name = "PROPERTY=RULE", value_parser = attribute_rule)]
    pub(crate) attribute: Vec<(Vec<String>, Interpolation)>,
    /// Write decimal text instead of little-endian binary
    #[arg(long)]
    pub(crate) ascii: bool,
    /// Write where each point comes from: properties level, parent0, parent1, parent2
    #[arg(long)]
    pub(crate) provenance: bool,
    /// Show how radii fall from level to level, and how far neighbors lie off the tangent planes (co-cone angles)
    ///
    /// The GPU backend reads each level back for it.
    #[arg(long)]
    stats: bool,
    /// Write nothing: tell how many points, how much memory, time and disk it would take, and whether that fits
    ///
    /// All figures are estimates; the time is that of a sphere, which is refined for a moment. It is an error if the
    /// refinement surely does not fit.
    #[arg(long)]
    pub(crate) dry_run: bool,
    #[command(flatten)]
    pub(crate) summary: SummaryArgs,
    #[command(flatten)]
    variant: VariantArgs,
    #[command(flatten)]
    paper: PaperArgs,
}

/// The parameters of the paper.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = METHOD)]
struct PaperArgs {
    /// Tolerance angle of the planes behind which neighbors hide others, above 0 up to 90 degrees
    #[arg(long, value_name = "DEG", default_value = "30", value_parser = theta_f)]
    #[arg(allow_negative_numbers = true)]
    theta_f: f32,
    /// Least size of a triangle, as a share of its corners' distances to their farthest neighbors, above 0 up to 1
    ///
    /// The larger a triangle, the sooner it gets its new point and the more room that takes. It means nothing with
    /// --simplified. With `--without largest_first` it is the share of the radius within which a new point is a new
    /// neighbor.
    #[arg(long, value_name = "X", default_value = "0.57735026", value_parser = lambda1)]
    #[arg(allow_negative_numbers = true)]
    lambda1: f32,
    /// Radius that a new point keeps free of others, as a share of its triangle's size, 0 to 1
    ///
    /// With `--without largest_first` it is a share of the distance to the triangle's corners.
    #[arg(long, value_name = "X", default_value = "0.5", value_parser = lambda2)]
    #[arg(allow_negative_numbers = true)]
    lambda2: f32,
    /// Measure the angle between new neighbors straight, not along the curved surface; implies
    /// `--without largest_first`
    #[arg(long)]
    plain_angle: bool,
    /// A new neighborhood is complete without a gap wider than this, above 0 and below 180 degrees; implies
    /// `--without largest_first` [default: 89]
    #[arg(long, value_name = "DEG", value_parser = theta_c)]
    #[arg(allow_negative_numbers = true)]
    theta_c: Option<f32>,
}

impl RefineArgs {
    /// Options that do not go together.
    pub(super) fn problem(&self) -> Option<&'static str> {
        let is_cpu = self.backend == BackendChoice::Cpu;
        (is_cpu && self.adapter.is_some()).then_some(ADAPTER_ON_CPU)
    }

    /// The backend, with what `--adapter` implies.
    pub(crate) fn backend(&self) -> BackendChoice {
        if self.adapter.is_some() { BackendChoice::Gpu } else { self.backend }
    }

    /// Which holes are filled; by the text none are, and raised radii close them.
    pub(crate) fn fill_holes(&self) -> FillChoice {
        let usual = if self.variant.is_literal() { FillChoice::None } else { FillChoice::Raised };
        self.fill_holes.clone().unwrap_or(usual)
    }

    /// Whether the levels are measured: not where nothing would show it.
    pub(crate) fn shows_stats(&self) -> bool {
        self.stats && self.summary.shows_summary()
    }

    /// The parameters; each was checked when it was parsed.
    pub(crate) fn params(&self) -> RefineParams {
        let PaperArgs { theta_f, lambda1, lambda2, plain_angle, theta_c } = self.paper;
        let usual = RefineParams::default();
        let mut params = self.variant.applied_to(RefineParams {
            levels: self.levels,
            theta_f,
            lambda1,
            lambda2,
            plain_angle,
            theta_c: theta_c.unwrap_or(usual.theta_c),
            boundary: self.boundary(),
            keep_radii: self.shows_stats(),
            ..usual
        });
        // Only the paper's loop knows these.
        params.rules.largest_first &= theta_c.is_none() && !plain_angle;
        params
    }

    fn boundary(&self) -> Boundary {
        match &self.boundary_property {
            _ if self.closed => Boundary::None,
            Some(name) => Boundary::Marked(name.clone()),
            None => Boundary::Angle(self.boundary_angle),
        }
    }
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

#[cfg(test)]
mod tests {
    use super::super::{Cli, Command};
    use super::*;
    use clap::Parser;

    #[test]
    fn defaults_are_those_of_the_library() {
        let cli = Cli::parse_from(["surfine", "refine", "in.ply", "-o", "out.ply"]);
        let Command::Refine(args) = cli.command else { panic!("another command was parsed") };
        assert_eq!(args.params(), RefineParams { levels: 2, ..RefineParams::default() });
    }
}
