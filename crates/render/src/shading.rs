//! How light falls: the CPU's twin of `shaders/render/view.wgsl`.

use crate::view::{DATA, NORMAL, Uniform};
use glam::{Vec3, Vec4};

/// From the sRGB encoding of 0 to 1 to light.
pub(crate) fn to_linear(c: Vec3) -> Vec3 {
    let channel = |c: f32| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    c.map(channel)
}

/// From light of 0 to 1 to the sRGB encoding.
pub(crate) fn to_srgb(c: Vec3) -> Vec3 {
    let channel =
        |c: f32| if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    c.map(channel)
}

/// The light that a surface of this colour and normal sends to an eye in direction `to_eye`.
pub(crate) fn shade(view: &Uniform, color: Vec3, normal: Vec3, to_eye: Vec3) -> Vec3 {
    if view.coloring == NORMAL {
        return color;
    }
    let light = Vec3::from(view.light);
    let sky = 0.5 + 0.5 * normal.dot(view.up.into());
    let diffuse = 0.06 + 0.20 * sky + 0.82 * normal.dot(light).max(0.0);
    if view.coloring >= DATA {
        return color * (0.55 + 0.45 * diffuse);
    }
    let halfway = (light + to_eye).normalize();
    let gloss = 0.10 * normal.dot(halfway).max(0.0).powf(50.0);
    color * diffuse + gloss
}

/// A colour of 8 bits a channel as light.
pub(crate) fn unpack(packed: u32) -> Vec3 {
    let [r, g, b, _] = packed.to_le_bytes().map(f32::from);
    to_linear(Vec3::new(r, g, b) / 255.0)
}

/// Light and opacity, premultiplied, as the bytes of a picture.
pub(crate) fn encode(sum: Vec4) -> [u8; 4] {
    let light = (sum.truncate() / sum.w.max(1e-6)).clamp(Vec3::ZERO, Vec3::ONE);
    let byte = |c: f32| (255.0 * c + 0.5) as u8;
    let [r, g, b] = to_srgb(light).to_array().map(byte);
    [r, g, b, byte(sum.w)]
}

/// The light of the background, premultiplied.
pub(crate) fn background(view: &Uniform) -> Vec4 {
    let [r, g, b, opacity] = view.background;
    (to_linear(Vec3::new(r, g, b)) * opacity).extend(opacity)
}

/// The direction from the eye through a place of the picture, −1 to 1 to the right and upwards.
pub(crate) fn ray(view: &Uniform, x: f32, y: f32) -> Vec3 {
    let [right, up, forward] = [view.right, view.up, view.forward].map(Vec3::from);
    forward + x / view.scale[0] * right + y / view.scale[1] * up
}
