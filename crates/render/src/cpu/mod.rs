//! The same picture without a GPU: the passes of `shaders/render` on the CPU, in bands of rows.

mod canvas;
mod disc;

use crate::shading::unpack;
use crate::style::packed_ramp;
use crate::view::Uniform;
use crate::{Camera, Error, Picture, Size, Splats, Style};
use canvas::{Canvas, Fronts};
use disc::Disc;
use glam::Vec3;
use rayon::prelude::*;

pub(crate) use disc::PUSH;

/// Pixel rows of a band.
const BAND: u32 = 16;
/// Checks that a picture has pixels, and not too many.
///
/// # Errors
/// It has none, or too many.
pub fn check(size: Size, supersampling: u32) -> Result<(), Error> {
    size.check(supersampling, LIMIT)
}

/// More subpixels a side than any GPU draws.
const LIMIT: u32 = 1 << 15;

/// Draws a cloud on the CPU, in parallel; any number of threads gives the same bytes.
///
/// A disc that reaches behind the eye is left out.
///
/// # Errors
/// The picture has no pixels, or too many.
pub fn draw(splats: &Splats, camera: &Camera, style: &Style, size: Size) -> Result<Picture, Error> {
    check(size, style.supersampling)?;
    let view = Uniform::new(camera, style, size, splats.bounds);
    let ramp: Vec<Vec3> = packed_ramp().into_iter().map(unpack).collect();
    let project = |i| Disc::project(&view, &ramp, splats, i, size);
    let discs: Vec<Disc> = (0..splats.len()).into_par_iter().filter_map(project).collect();
    let bands = Band::all(size, style.supersampling);
    let members = members(&discs, &bands);
    let fronts = |(band, members): (&Band, &Vec<&Disc>)| {
        let mut canvas = Canvas::new(band);
        let fronts = members.iter().filter(|disc| !disc.shows_back);
        fronts.for_each(|disc| canvas.visibility(disc));
        canvas.depth
    };
    let depths: Vec<Vec<f32>> = bands.par_iter().zip(&members).map(fronts).collect();
    let fronts = Fronts {
        rows: bands.first().map_or(1, |b| b.rows),
        columns: size.width * style.supersampling,
        depths,
    };
    let picture = |(i, members): (usize, &Vec<&Disc>)| {
        let mut canvas = Canvas::new(&bands[i]);
        canvas.depth.clone_from(&fronts.depths[i]);
        let seen =
            |disc: &&&Disc| !(disc.shows_back && (disc.is_far_side || fronts.hide(disc.center)));
        let seen: Vec<&Disc> = members.iter().filter(seen).copied().collect();
        let backs = seen.iter().filter(|disc| disc.shows_back);
        backs.for_each(|disc| canvas.visibility(disc));
        seen.iter().for_each(|disc| canvas.attributes(disc));
        canvas.resolve(&view, size)
    };
    let pixels: Vec<Vec<[u8; 4]>> =
        members.par_iter().enumerate().map(|(i, m)| picture((i, m))).collect();
    Ok(Picture { size, pixels: pixels.concat() })
}

/// Rows of subpixels.
struct Band {
    first: u32,
    rows: u32,
    columns: u32,
}

impl Band {
    /// The bands of a picture, all but the last of one height.
    fn all(size: Size, side: u32) -> Vec<Self> {
        let band = |first: u32| Self {
            first: first * side,
            rows: BAND.min(size.height - first) * side,
            columns: size.width * side,
        };
        (0..size.height).step_by(BAND as usize).map(band).collect()
    }
}

/// The discs that reach into each band, in their order.
fn members<'a>(discs: &'a [Disc], bands: &[Band]) -> Vec<Vec<&'a Disc>> {
    let mut members = vec![Vec::new(); bands.len()];
    let rows = bands[0].rows;
    for disc in discs {
        for band in disc.low[1] / rows..=(disc.high[1] - 1) / rows {
            members[band as usize].push(disc);
        }
    }
    members
}
