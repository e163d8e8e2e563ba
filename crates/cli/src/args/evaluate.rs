//! The arguments of `surfine evaluate`.

use super::render::{above_zero, size, view};
use super::{BackendChoice, ThreadArgs};
use clap::Args;
use std::path::PathBuf;
use surfine_render::{Size, View};

const EXAMPLES: &str = "\
Examples:
  surfine evaluate fine.ply --truth mesh.ply
  surfine evaluate fine.ply --truth mesh.ply --input scan.ply
  surfine evaluate fine.ply --truth dense-points.ply --json | jq .evaluation.distance.in_diagonals.mean
  surfine evaluate fine.ply --truth mesh.ply --heatmap error.png --view iso

Every measure is defined in docs/evaluation.md, with its source.";

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct EvaluateArgs {
    /// PLY file of the points to judge: x y z, best with nx ny nz
    #[arg(value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// PLY file of the true surface: a mesh, or dense points, best with nx ny nz
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: PathBuf,
    /// PLY file that OUT was refined from, to check that its points are still there, bit for bit
    #[arg(long, value_name = "FILE")]
    pub(crate) input: Option<PathBuf>,
    /// Number of points to sample on a mesh, 1 to 100000000, to find the places that OUT leaves bare [default: 2 for
    /// each point of OUT, within 100000 and 1000000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub(crate) samples: Option<u32>,
    /// Seed of the samples, 0 to 2^64 - 1
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Edges of the mesh that are sharper than this are creases, above 0 up to 180 degrees
    #[arg(long, value_name = "DEG", default_value = "40", value_parser = crease_angle)]
    pub(crate) crease_angle: f64,
    /// Draw the distance to the truth on the points into a PNG file
    #[arg(long, value_name = "FILE")]
    pub(crate) heatmap: Option<PathBuf>,
    /// Distance at the bright end of the heatmap's scale, in the units of OUT [default: the largest]
    #[arg(long, value_name = "X", value_parser = above_zero, requires = "heatmap")]
    pub(crate) max: Option<f32>,
    /// From where to look at the heatmap
    #[arg(long, value_name = "SIDE", default_value = "front", value_parser = view())]
    #[arg(requires = "heatmap")]
    pub(crate) view: View,
    /// The z axis is up in the heatmap, as in terrain and CAD: the front is then the side of -y
    #[arg(long, requires = "heatmap")]
    pub(crate) z_up: bool,
    /// Width and height of the heatmap, pixels
    #[arg(long, value_name = "WxH", default_value = "800x800", value_parser = size)]
    #[arg(requires = "heatmap")]
    pub(crate) size: Size,
    /// Where to draw the heatmap
    #[arg(long, value_enum, value_name = "WHERE", default_value_t, requires = "heatmap")]
    pub(crate) backend: BackendChoice,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    /// Print neither progress nor why measures are missing; warnings and errors stay
    #[arg(short, long)]
    pub(crate) quiet: bool,
    /// Print the measures as one JSON object, and no progress
    #[arg(long)]
    pub(crate) json: bool,
}

fn crease_angle(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(angle) if angle > 0.0 && angle <= 180.0 => Ok(angle),
        _ => Err("it must be above 0 and at most 180 degrees".into()),
    }
}
