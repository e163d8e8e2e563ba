//! The subpixels of a band: the fragment shaders.

use super::Band;
use super::disc::Disc;
use crate::Size;
use crate::shading::{background, encode, ray, shade};
use crate::view::Uniform;
use glam::{Vec2, Vec3, Vec4};

/// The subpixels of a band.
pub(super) struct Canvas {
    first_row: u32,
    columns: u32,
    /// Distance from the eye up to which discs are seen.
    pub(super) depth: Vec<f32>,
    /// Weighted colour, and the weight.
    color: Vec<Vec4>,
    normal: Vec<Vec3>,
}

/// Depth of the discs that show their fronts, in the whole picture.
pub(super) struct Fronts {
    /// Of all bands but the last.
    pub(super) rows: u32,
    pub(super) columns: u32,
    /// Of each band.
    pub(super) depths: Vec<Vec<f32>>,
}

impl Fronts {
    /// Whether they hide a place: column and row in subpixels, and distance.
    pub(super) fn hide(&self, place: Vec3) -> bool {
        if place.x < 0.0 || place.y < 0.0 || place.x >= self.columns as f32 {
            return false;
        }
        let (column, row) = (place.x as usize, place.y as usize);
        let (band, row) = (row / self.rows as usize, row % self.rows as usize);
        let depth = self.depths.get(band).and_then(|d| d.get(row * self.columns as usize + column));
        depth.is_some_and(|&depth| place.z > depth)
    }
}

impl Canvas {
    pub(super) fn new(band: &Band) -> Self {
        let n = band.rows as usize * band.columns as usize;
        Self {
            first_row: band.first,
            columns: band.columns,
            depth: vec![f32::INFINITY; n],
            color: vec![Vec4::ZERO; n],
            normal: vec![Vec3::ZERO; n],
        }
    }

    /// Calls `f` for the subpixels of the disc: index, place in the disc, distance.
    fn each_subpixel(&mut self, disc: &Disc, mut f: impl FnMut(&mut Self, usize, Vec2, f32)) {
        let rows = self.depth.len() as u32 / self.columns;
        let begin = disc.low[1].max(self.first_row);
        let end = disc.high[1].min(self.first_row + rows);
        for row in begin..end {
            let y = row as f32 + 0.5 - disc.center.y;
            let start = ((row - self.first_row) * self.columns) as usize;
            for column in disc.low[0]..disc.high[0] {
                let x = column as f32 + 0.5 - disc.center.x;
                let v = disc.to_place * Vec3::new(x, y, 1.0);
                let (place, distance) = (v.truncate() / v.z, 1.0 / v.z);
                let ends = disc.ends.map(|end| end.dot(place.extend(1.0)));
                if place.length_squared() <= 1.0 && ends[0].max(ends[1]) <= 0.0 {
                    f(self, start + column as usize, place, distance);
                }
            }
        }
    }

    pub(super) fn visibility(&mut self, disc: &Disc) {
        self.each_subpixel(disc, |canvas, i, place, distance| {
            if place.length_squared() <= disc.solid {
                canvas.depth[i] = canvas.depth[i].min(distance + disc.pushed);
            }
        });
    }

    pub(super) fn attributes(&mut self, disc: &Disc) {
        self.each_subpixel(disc, |canvas, i, place, distance| {
            if distance <= canvas.depth[i] {
                let inside = 1.0 - place.length_squared();
                let weight = 0.01 + inside * inside;
                canvas.color[i] += weight * disc.color.extend(1.0);
                canvas.normal[i] += weight * disc.normal;
            }
        });
    }

    /// The pixels of the band, row by row.
    pub(super) fn resolve(&self, view: &Uniform, size: Size) -> Vec<[u8; 4]> {
        let side = view.supersampling;
        let rows = self.depth.len() as u32 / self.columns / side;
        let pixel = |row: u32, column: u32| {
            let subpixel =
                |i: u32| self.subpixel(view, size, row * side + i / side, column * side + i % side);
            encode((0..side * side).map(subpixel).sum::<Vec4>() / (side * side) as f32)
        };
        (0..rows).flat_map(|row| (0..size.width).map(move |column| pixel(row, column))).collect()
    }

    /// Light and opacity of a subpixel, premultiplied.
    fn subpixel(&self, view: &Uniform, size: Size, row: u32, column: u32) -> Vec4 {
        let i = (row * self.columns + column) as usize;
        let color = self.color[i];
        if self.depth[i] == f32::INFINITY || color.w == 0.0 {
            return background(view);
        }
        let x = (column as f32 + 0.5) / self.columns as f32 * 2.0 - 1.0;
        let rows = (size.height * view.supersampling) as f32;
        let y = 1.0 - ((self.first_row + row) as f32 + 0.5) / rows * 2.0;
        let sum = self.normal[i];
        let is_left = sum.length_squared() > 1e-5 * color.w * color.w;
        let normal = if is_left { sum.normalize() } else { -Vec3::from(view.forward) };
        let to_eye = (-ray(view, x, y)).normalize();
        shade(view, color.truncate() / color.w, normal, to_eye).extend(1.0)
    }
}
