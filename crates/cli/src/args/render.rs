//! The arguments of `surfine render`.

use super::{ADAPTER_ON_CPU, BackendChoice, ThreadArgs, number};
use clap::builder::{NonEmptyStringValueParser, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use surfine_points::DVec3;
use surfine_render::{Size, View};

const EXAMPLES: &str = "\
Examples:
  surfine render fine.ply -o fine.png
  surfine render scan.ply fine.ply -o both.png --view iso
  surfine render fine.ply -o error.png --color error --truth mesh.ply
  surfine render fine.ply -o turn.png --turntable 36          one animated PNG
  surfine render fine.ply -o turn-##.png --turntable 36       turn-00.png to turn-35.png

Several inputs are drawn side by side by the same camera. Each point is a disc (splat), colors blend where
discs overlap. Of a mesh the vertices are drawn. Points without a normal are dots; missing radii are made
up from the neighbors. The back of a disc is orange: where you see it, normals point the wrong way. At
sharp edges of coarse meshes a little orange is no error: one normal for a vertex can't fit both sides.
Axes: x to the right, y up, z towards the viewer of `--view front`; see --z-up.";

#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RenderArgs {
    /// PLY files of points or meshes: x y z, best with nx ny nz and radius
    #[arg(value_name = "IN", required = true)]
    pub(crate) inputs: Vec<PathBuf>,
    /// PNG file to write; it appears whole or not at all. With --turntable, a row of # in its name gives each frame a
    /// file: the number takes its place
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Width and height of each input's picture, pixels
    #[arg(long, value_name = "WxH", default_value = "800x800", value_parser = size)]
    pub(crate) size: Size,
    /// From where to look
    #[arg(long, value_name = "SIDE", default_value = "front", value_parser = view())]
    pub(crate) view: View,
    /// The z axis is up, as in terrain and CAD: the front is then the side of -y
    #[arg(long, conflicts_with_all = ["eye", "up"])]
    pub(crate) z_up: bool,
    /// Place of the camera, in the units of IN
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, conflicts_with = "view")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) eye: Option<DVec3>,
    /// What the camera looks at [default: the middle of the clouds]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, requires = "eye")]
    #[arg(allow_hyphen_values = true)]
    pub(crate) target: Option<DVec3>,
    /// Direction that is upright in the picture [default: that of the view, else 0,1,0]
    #[arg(long, value_name = "X,Y,Z", value_parser = direction)]
    #[arg(allow_hyphen_values = true)]
    pub(crate) up: Option<DVec3>,
    /// Move the camera along its line of sight until everything is just seen, as is always done without --eye
    #[arg(long)]
    pub(crate) fit: bool,
    /// What colors show
    #[arg(long, value_enum, value_name = "WHAT", default_value_t)]
    pub(crate) color: ColorChoice,
    /// The true surface, for --color error alone: PLY file of a mesh or of dense points
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
    /// Value at the bright end of the color scale for radius, level and error; the other end is then 0 [default: the
    /// largest value]
    #[arg(long, value_name = "X", value_parser = above_zero)]
    pub(crate) max: Option<f32>,
    /// Draw raw points instead of splats
    #[arg(long)]
    pub(crate) points: bool,
    /// Radius of raw points, 0.001 to 1000 pixels
    #[arg(long, value_name = "X", default_value = "1.5", value_parser = size_factor)]
    #[arg(requires = "points")]
    pub(crate) point_size: f32,
    /// Draw splats so many times as large, 0.001 to 1000
    #[arg(long, value_name = "X", default_value = "1", value_parser = size_factor)]
    #[arg(conflicts_with = "points")]
    pub(crate) splat_scale: f32,
    /// Color behind the clouds: RRGGBB, RRGGBBAA or none
    #[arg(long, value_name = "COLOR", default_value = "ffffff", value_parser = color)]
    pub(crate) background: [u8; 4],
    /// Average N x N subpixels for each pixel, 1 to 8
    #[arg(long, value_name = "N", default_value = "2")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=8))]
    pub(crate) supersampling: u32,
    /// Text under each input's picture, one for each input [default, for several: name and number of points]
    #[arg(long, value_name = "TEXT")]
    pub(crate) caption: Vec<String>,
    /// Leave out text and color scale
    #[arg(long, conflicts_with = "caption")]
    pub(crate) no_captions: bool,
    /// Draw N frames, 2 to 3600, of a whole turn of the cloud about the direction of --up [default: y, with --z-up z]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=3600))]
    pub(crate) turntable: Option<u32>,
    /// Frames a second of an animated PNG, 1 to 100
    #[arg(long, value_name = "N", default_value = "15", requires = "turntable")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=100))]
    pub(crate) fps: u16,
    /// Where to draw
    #[arg(long, value_enum, value_name = "WHERE", default_value_t)]
    pub(crate) backend: BackendChoice,
    /// GPU adapter whose name or driver contains NAME, in any case; implies --backend gpu
    #[arg(long, value_name = "NAME", value_parser = NonEmptyStringValueParser::new())]
    pub(crate) adapter: Option<String>,
    #[command(flatten)]
    pub(crate) threads: ThreadArgs,
    /// Print neither progress nor summary; warnings and errors stay
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

impl RenderArgs {
    /// An option that would do nothing.
    pub(super) fn problem(&self) -> Option<&'static str> {
        let has_scale =
            matches!(self.color, ColorChoice::Radius | ColorChoice::Level | ColorChoice::Error);
        if self.truth.is_some() && self.color != ColorChoice::Error {
            Some("the argument '--truth <FILE>' needs '--color error'")
        } else if self.max.is_some() && !has_scale {
            Some("the argument '--max <X>' needs '--color radius', 'level' or 'error'")
        } else if self.adapter.is_some() && self.backend == BackendChoice::Cpu {
            Some(ADAPTER_ON_CPU)
        } else {
            None
        }
    }
}

/// What the colours of a picture show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorChoice {
    /// The shape alone, lit
    #[default]
    Shaded,
    /// The normal, x y z as red green blue
    Normal,
    /// The properties red green blue
    Rgb,
    /// The radius
    Radius,
    /// The property level, as `refine --provenance` writes it
    Level,
    /// The distance to the surface of --truth
    Error,
}

pub(super) fn view() -> impl TypedValueParser<Value = View> {
    PossibleValuesParser::new(View::ALL.map(View::name)).try_map(|name| name.parse::<View>())
}

pub(super) fn size(text: &str) -> Result<Size, String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match sides {
        Some((width @ 1..=32768, height @ 1..=32768)) => Ok(Size { width, height }),
        _ => Err("it must be two whole numbers from 1 to 32768 like 800x600".into()),
    }
}

/// A place within the limits of files.
fn vector(text: &str) -> Result<DVec3, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) if [x, y, z].iter().all(|c: &f64| c.abs() <= 1e15) => {
            Ok(DVec3::new(x, y, z))
        }
        _ => Err("it must be three numbers within ±1e15 like 0,0.5,-2".into()),
    }
}

fn direction(text: &str) -> Result<DVec3, String> {
    let vector = vector(text)?;
    // Its square must not underflow.
    if vector.length() > 0.0 { Ok(vector) } else { Err("it must not be zero".into()) }
}

/// A factor or a number of pixels.
fn size_factor(text: &str) -> Result<f32, String> {
    match number(text)? {
        value if (1e-3..=1e3).contains(&value) => Ok(value),
        _ => Err("it must be 0.001 to 1000".into()),
    }
}

pub(super) fn above_zero(text: &str) -> Result<f32, String> {
    let value = number(text)?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("it must be above 0".into()) }
}

fn color(text: &str) -> Result<[u8; 4], String> {
    if text == "none" {
        return Ok([255, 255, 255, 0]);
    }
    let digits = text.strip_prefix('#').unwrap_or(text);
    let value = u32::from_str_radix(digits, 16).ok().filter(|_| !digits.starts_with('+'));
    match (value, digits.len()) {
        (Some(value), 6) => Ok((value << 8 | 255).to_be_bytes()),
        (Some(value), 8) => Ok(value.to_be_bytes()),
        _ => Err("it must be 6 or 8 hexadecimal digits like ffffff, or none".into()),
    }
}
