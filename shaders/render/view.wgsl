// What the passes of a picture share: the camera, the style, and how light falls.
// Mirrored by crates/render/src/view.rs; the CPU's twin of the formulas is crates/render/src/shading.rs.

struct View {
    eye: vec3<f32>,
    /// Distance of the near plane.
    near: f32,
    /// The camera's axes, unit length.
    right: vec3<f32>,
    /// Width of a subpixel at distance 1.
    pixel: f32,
    up: vec3<f32>,
    /// Factor of the size of all discs.
    disc_scale: f32,
    forward: vec3<f32>,
    /// Radius in subpixels of a raw point; 0 draws discs.
    dot_radius: f32,
    /// Unit vector to the light.
    light: vec3<f32>,
    coloring: u32,
    /// Reciprocals of half the width and half the height of the picture at distance 1.
    scale: vec2<f32>,
    /// The value at the low end of the ramp, and the reciprocal of the ramp's length.
    ramp_low: f32,
    ramp_inverse: f32,
    background: vec4<f32>,
    /// Subpixels along the side of a pixel.
    supersampling: u32,
    padding: vec3<u32>,
}

const MATERIAL: u32 = 0u;
const PAINT: u32 = 1u;
const NORMAL: u32 = 2u;
/// Colours of this number and above stand for values: lit softly, so that they can be read off.
const DATA: u32 = 3u;
const RADIUS: u32 = 4u;
const LEVEL: u32 = 5u;

@group(0) @binding(0) var<uniform> view: View;

/// From the sRGB encoding of 0 to 1 to light.
fn to_linear(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

/// From light of 0 to 1 to the sRGB encoding.
fn to_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3(0.0031308));
}

/// The light that a surface of this colour and normal sends to an eye in direction `to_eye`.
fn shade(color: vec3<f32>, normal: vec3<f32>, to_eye: vec3<f32>) -> vec3<f32> {
    if view.coloring == NORMAL {
        return color;
    }
    let sky = 0.5 + 0.5 * dot(normal, view.up);
    let diffuse = 0.06 + 0.20 * sky + 0.82 * max(dot(normal, view.light), 0.0);
    if view.coloring >= DATA {
        return color * (0.55 + 0.45 * diffuse);
    }
    let halfway = normalize(view.light + to_eye);
    let gloss = 0.10 * pow(max(dot(normal, halfway), 0.0), 50.0);
    return color * diffuse + gloss;
}
