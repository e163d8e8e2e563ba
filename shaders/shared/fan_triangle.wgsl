// The triangles of a fan. Twin: crates/reference/src/fan_triangle.rs
//
// Expects what curves.wgsl has.

/// A fan triangle needs a gap below π(1 - 1e-4) radians: at π the fan has no triangle there.
const WIDEST_GAP: f32 = 3.1412785;
/// A triangle between a point and both its neighbours on a curve has a gap of no more than
/// 150°, but at corners, radians.
const WIDEST_SHEET: f32 = 2.617994;

/// Whether the fan of p has a triangle between two entries of its ring that follow each other, the second of which may
/// be the first of all: not if the gap is not below π, or goes around the end of a crease point's sheet.
fn is_triangle(p: u32, a: vec2<u32>, b: vec2<u32>, wraps: bool) -> bool {
    let gap = (bitcast<f32>(b.y) + select(0.0, TAU, wraps)) - bitcast<f32>(a.y);
    if is_on_curve(p) && (wraps || spans_sheet(record_of(p), record_of(a.x), record_of(b.x), gap)) {
        return false;
    }
    return gap < WIDEST_GAP;
}

/// Whether a triangle lies between a curve's point and both its neighbours there, almost in a
/// line: a sheet does not end so.
fn spans_sheet(record: u32, a: u32, b: u32, gap: f32) -> bool {
    let partners = record_partners(record);
    return record_sides(record) < 3u && gap > WIDEST_SHEET
        && a != NONE && a == partners.x && b != NONE && b == partners.y;
}
