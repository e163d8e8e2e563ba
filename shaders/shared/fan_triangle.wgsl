// The triangles of a fan. Twin: `fan_triangle` in crates/reference/src/candidates.rs
//
// Expects `fans`, `ring_entries` and what curves.wgsl has.

/// A fan triangle needs a gap below π(1 - 1e-4) radians: at π the fan has no triangle there.
const WIDEST_GAP: f32 = 3.1412785;
/// A triangle between a point and both its neighbours on a curve has a gap of no more than 150°, but at corners, radians.
const WIDEST_SHEET: f32 = 2.617994;

/// The corners of slot's triangle in the fan of p, smallest index first and orientation kept. NONE if the gap is not below
/// π, or goes around the end of a crease point's sheet.
fn fan_triangle(p: u32, slot: u32) -> vec3<u32> {
    let block = fans[p].slots;
    let last = slot + 1u == block.x + block.y;
    let a = ring_entries[slot];
    let b = ring_entries[select(slot + 1u, block.x, last)];
    var gap = bitcast<f32>(b.y) - bitcast<f32>(a.y);
    if last {
        gap = (bitcast<f32>(b.y) + TAU) - bitcast<f32>(a.y);
    }
    if gap >= WIDEST_GAP {
        return vec3(NONE);
    }
    if is_on_curve(p) && (last || spans_sheet(record_of(p), record_of(a.x), record_of(b.x), gap)) {
        return vec3(NONE);
    }
    if p < a.x && p < b.x {
        return vec3(p, a.x, b.x);
    }
    if a.x < b.x {
        return vec3(a.x, b.x, p);
    }
    return vec3(b.x, p, a.x);
}

/// Whether a triangle lies between a curve's point and both its neighbours there, almost in a line: a sheet does not end so.
fn spans_sheet(record: u32, a: u32, b: u32, gap: f32) -> bool {
    let partners = record_partners(record);
    return record_sides(record) < 3u && gap > WIDEST_SHEET
        && a != NONE && a == partners.x && b != NONE && b == partners.y;
}
