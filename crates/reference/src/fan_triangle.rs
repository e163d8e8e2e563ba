//! The triangles of a fan (section 3). Twins: `fan_triangle.wgsl` and `canonical.wgsl` in `shaders/shared`.

use crate::math::TAU;
use crate::neighborhood::Rings;
use crate::{Level, NO_POINT};
use surfine_features::Record;

/// A fan triangle needs a gap below π(1 - 1e-4) radians: at π the fan has no triangle there.
pub const WIDEST_GAP: f32 = surfine_features::STRAIGHT;

/// A triangle between a point and both its neighbours on a curve has a gap of no more than
/// 150°, but at corners, radians.
pub const WIDEST_SHEET: f32 = 2.617_994;

/// The corners of a fan triangle, smallest index first and orientation kept, so that the copies of one triangle in
/// three fans are computed alike. `None` if the gap is not below π, or goes around the end of a crease point's sheet.
// A call for each slot would cost as much as what is done in it.
#[inline(always)]
pub fn fan_triangle(level: &Level, rings: &Rings, p: usize, i: usize) -> Option<[u32; 3]> {
    let ring = rings.ring(p);
    let last = i + 1 == ring.len();
    let (a, b) = (ring[i], if last { ring[0] } else { ring[i + 1] });
    let turn = [0.0, TAU][usize::from(last)];
    let gap = (b.angle + turn) - a.angle;
    if gap >= WIDEST_GAP {
        return None;
    }
    if let Some(record) = level.record(p)
        && (last || spans_sheet(level, record, a.id, b.id, gap))
    {
        return None;
    }
    Some(canonical([p as u32, a.id, b.id]))
}

/// Whether a triangle lies between a curve's point and both its neighbours there, almost in a
/// line: a sheet does not end so.
fn spans_sheet(level: &Level, record: &Record, a: u32, b: u32, gap: f32) -> bool {
    let is_partner = |id: u32, k: usize| {
        let partner = record.partners[k];
        partner != NO_POINT && level.seen(id as usize).record == partner
    };
    record.sides < 3 && gap > WIDEST_SHEET && is_partner(a, 0) && is_partner(b, 1)
}

/// The triangle turned until its smallest index comes first.
#[inline(always)]
fn canonical([a, b, c]: [u32; 3]) -> [u32; 3] {
    debug_assert!(a != NO_POINT && b != NO_POINT && c != NO_POINT);
    // Which corner comes first would be guessed wrong often: a place in a table is none to guess.
    let first = if (a < b) & (a < c) { 0 } else { 2 - usize::from(b < c) };
    let twice = [a, b, c, a, b];
    [twice[first], twice[first + 1], twice[first + 2]]
}
