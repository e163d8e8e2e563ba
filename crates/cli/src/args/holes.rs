//! Options of `holes` and `fill`.

use super::{SummaryArgs, ThreadArgs};
use clap::Args;
use std::path::PathBuf;
pub(crate) use surfine_holes::Choice as FillChoice;

const HOLES_EXAMPLES: &str = "\
Examples:
  surfine holes scan.ply
  surfine holes scan.ply --json | jq '.loops[] | select(.kind == \"hole\")'

A loop is a closed chain of points around a place without points. Lengths are in the units of IN, and in
spacings: the mean distance of the loop's points to their neighbors.
  id         1 for the widest loop, and so on; `fill` takes it
  span       largest distance between two points of the loop
  perimeter  length of the loop
  turning    sum of its bends in degrees: about 360 around a hole in a plane, less around one in a round
             surface, -360 along the outline of a flat piece
  kind       hole if it turns by 90 to 540 degrees, outer rim below -90, else undecided: the end of a tube, half
             of a sphere, a tangle";

const FILL_EXAMPLES: &str = "\
Examples:
  surfine fill scan.ply -o filled.ply                          all holes, no outer rims
  surfine fill scan.ply -o filled.ply --fill-holes 1,3         the loops with these ids, of any kind
  surfine fill scan.ply -o filled.ply --fill-holes max-span=0.2
  surfine fill scan.ply -o filled.ply && surfine refine filled.ply -o fine.ply

The points of IN come first in FILE, in their order and unchanged but for radii along the loops; the new
points follow loop by loop, as dense as those around the loop. They have the id of their loop in the
property hole, all others 0. Radii that were raised by hand to close holes (to more than 4 times the
median and 2.5 times the natural radius) are replaced by natural ones if a hole is filled there.";

#[derive(Debug, Args)]
#[command(after_help = HOLES_EXAMPLES)]
pub(crate) struct HolesArgs {
    /// PLY file of points: x y z, nx ny nz (unit length, outward), radius
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = FILL_EXAMPLES)]
pub(crate) struct FillArgs {
    /// PLY file of points: x y z, nx ny nz (unit length, outward), radius; more properties are kept
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// PLY file to write, not IN; it appears whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Which loops to fill: all (holes, no outer rims), raised (those around which radii were raised by hand, to close
    /// them), none, ids as `surfine holes` lists them, or max-span=X (no wider than X in the units of IN, no outer
    /// rims)
    #[arg(long, value_name = "WHICH", default_value = "all", value_parser = choice)]
    pub(crate) fill_holes: FillChoice,
    /// Write decimal text instead of little-endian binary
    #[arg(long)]
    pub(crate) ascii: bool,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    #[command(flatten)]
    pub(crate) summary: SummaryArgs,
}

/// `all`, `none`, `raised`, `1,3` or `max-span=0.2`.
pub(super) fn choice(text: &str) -> Result<FillChoice, String> {
    let wrong = "it must be all, none, raised, ids like 1,3 or max-span=0.2";
    match text {
        "all" => return Ok(FillChoice::All),
        "none" => return Ok(FillChoice::None),
        "raised" => return Ok(FillChoice::Raised),
        _ => {}
    }
    if let Some(span) = text.strip_prefix("max-span=") {
        return match span.parse::<f32>() {
            Ok(span) if span > 0.0 && span.is_finite() => Ok(FillChoice::MaxSpan(span)),
            _ => Err("the span must be a number above 0".into()),
        };
    }
    let ids: Result<Vec<u32>, _> = text.split(',').map(str::parse).collect();
    ids.map(FillChoice::Ids).map_err(|_| wrong.into())
}
