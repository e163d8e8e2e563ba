//! The uniform of a picture: mirror of `View` in `shaders/render/view.wgsl`.

use crate::{Camera, Coloring, Size, Style};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Camera and style as the passes read them; the fields are documented in view.wgsl.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Uniform {
    pub(crate) eye: [f32; 3],
    pub(crate) near: f32,
    pub(crate) right: [f32; 3],
    pub(crate) pixel: f32,
    pub(crate) up: [f32; 3],
    pub(crate) disc_scale: f32,
    pub(crate) forward: [f32; 3],
    pub(crate) dot_radius: f32,
    pub(crate) light: [f32; 3],
    pub(crate) coloring: u32,
    pub(crate) scale: [f32; 2],
    pub(crate) ramp_low: f32,
    pub(crate) ramp_inverse: f32,
    pub(crate) background: [f32; 4],
    pub(crate) supersampling: u32,
    pub(crate) padding: [u32; 7],
}

pub(crate) const MATERIAL: u32 = 0;
pub(crate) const PAINT: u32 = 1;
pub(crate) const NORMAL: u32 = 2;
pub(crate) const DATA: u32 = 3;
pub(crate) const RADIUS: u32 = 4;
pub(crate) const LEVEL: u32 = 5;

/// The near plane lies at this share of the distance to the target.
const NEAR: f32 = 1e-3;

impl Uniform {
    pub(crate) fn new(camera: &Camera, style: &Style, size: Size) -> Self {
        let [right, up, forward] = camera.axes();
        let half = (0.5 * camera.fov).tan();
        let rows = (size.height * style.supersampling) as f32;
        let (coloring, low, high) = match style.coloring {
            Coloring::Shaded => (MATERIAL, 0.0, 1.0),
            Coloring::Paint => (PAINT, 0.0, 1.0),
            Coloring::Data => (DATA, 0.0, 1.0),
            Coloring::Normal => (NORMAL, 0.0, 1.0),
            Coloring::Radius { low, high } => (RADIUS, low, high),
            Coloring::Level { high } => (LEVEL, 0.0, high),
        };
        Self {
            eye: camera.eye.to_array(),
            near: NEAR * camera.eye.distance(camera.target).max(f32::MIN_POSITIVE),
            right: right.to_array(),
            pixel: 2.0 * half / rows,
            up: up.to_array(),
            disc_scale: style.splat_scale,
            forward: forward.to_array(),
            dot_radius: style.dots.map_or(0.0, |radius| radius * style.supersampling as f32),
            light: (0.7 * up - 0.6 * right - 0.8 * forward).normalize_or(Vec3::Z).to_array(),
            coloring,
            scale: [size.height as f32 / size.width as f32 / half, 1.0 / half],
            ramp_low: low,
            // All values alike: the low end.
            ramp_inverse: if high > low { 1.0 / (high - low) } else { 0.0 },
            background: style.background.map(|c| f32::from(c) / 255.0),
            supersampling: style.supersampling,
            padding: [0; 7],
        }
    }
}
