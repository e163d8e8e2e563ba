//! How a picture looks.

/// What the colour of a point shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Coloring {
    /// The shape alone: one material under a light at the viewer's left shoulder.
    #[default]
    Shaded,
    /// The colour given for each point ([`Splats::new`](crate::Splats::new)), lit.
    Paint,
    /// The same for colours that stand for values: lit softly, so that they can be read off.
    Data,
    /// The normal, x y z as red green blue, from 0 at −1 to full at 1. Not lit.
    Normal,
    /// The radius on the ramp, lit softly.
    Radius {
        /// The radius at the low end of the ramp, in the unit of the [`Splats`](crate::Splats).
        low: f32,
        /// The radius at its high end.
        high: f32,
    },
    /// The refinement step that inserted the point, on the ramp, lit softly.
    Level {
        /// The step at the high end of the ramp.
        high: f32,
    },
}

/// How a picture looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// What the colour of a point shows.
    pub coloring: Coloring,
    /// Factor of the size of the discs: 1 covers a surface whose points have radii that reach their natural neighbours.
    pub splat_scale: f32,
    /// Draws raw points with this radius in pixels instead of discs.
    pub dots: Option<f32>,
    /// Red, green, blue and opacity behind the cloud.
    pub background: [u8; 4],
    /// Side of the square of subpixels that are averaged for each pixel, 1 to 8.
    pub supersampling: u32,
}

impl Default for Style {
    fn default() -> Self {
        Self {
            coloring: Coloring::Shaded,
            splat_scale: 1.0,
            dots: None,
            background: [255; 4],
            supersampling: 2,
        }
    }
}

/// Radius of a disc for each unit of a point's radius, which reaches the neighbours or a little beyond: 0.577 would just
/// cover an equilateral triangle. These discs decide what is seen.
pub(crate) const SOLID: f32 = 0.65;

/// The same for colours and normals: they reach farther, so that they blend smoothly where triangles are long, while
/// outlines stay as tight as the smaller discs.
pub(crate) const SOFT: f32 = 0.95;

/// The colour at a place from 0 to 1 of the ramp: viridis, which stays ordered in grey and for colour-blind eyes.
pub fn ramp(place: f64) -> [u8; 3] {
    let color = colorous::VIRIDIS.eval_continuous(place.clamp(0.0, 1.0));
    [color.r, color.g, color.b]
}

/// The ramp in 256 steps, packed as the shaders unpack it.
pub(crate) fn packed_ramp() -> Vec<u32> {
    (0..256).map(|i| pack(ramp(f64::from(i) / 255.0))).collect()
}

/// Red in the lowest byte.
pub(crate) fn pack([r, g, b]: [u8; 3]) -> u32 {
    u32::from_le_bytes([r, g, b, 255])
}
