// What radii cover. Twin: `COVER` in crates/reference/src/insertion.rs

/// Radii exceed the distances they must cover by this factor, so that rounding can't lose the farthest ring.
const COVER: f32 = 1.02;

/// Bits of the radius that covers a distance: they are ordered as radii are.
fn cover(distance: vec3<f32>) -> u32 {
    return bitcast<u32>(COVER * sqrt(dot3(distance, distance)));
}
