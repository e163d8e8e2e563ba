//! Overlaps of contested candidates alone (ours, a simplification). Twins: `shaders/selection_contested.wgsl` and
//! `selection_links.wgsl`.
//!
//! Where the surface is well sampled, almost all triangles are in the fans of all three corners, and their candidates
//! stay out of each other's discard spheres. What overlaps are triangles that only some of the fans have: of four
//! points on a circle each pair takes its own diagonal. So only these contested candidates are asked who discards them,
//! and only those in the fans of their corners can.

use crate::Level;
use crate::candidates::Candidates;
use crate::lists::{Lists, TooLong};
use crate::neighborhood::Rings;
use crate::selection::{holds, precedes};
use surfine_points::RefineParams;

/// Whether contested candidates alone are asked. New points on curves, which no fan has, discard
/// others wherever these are.
pub(crate) fn asks_contested_alone(level: &Level, params: &RefineParams) -> bool {
    params.effective_contested() && level.curve_points.is_empty()
}

/// For each contested candidate those whose discard sphere (eq. 11) holds it, of those before it in the fans of
/// its corners; for the others nothing. Uncontested candidates come before all others. A list names those twice
/// that two of the fans have.
pub(crate) fn contested_overlaps(
    rings: &Rings,
    candidates: &Candidates,
    params: &RefineParams,
) -> Result<Lists, TooLong> {
    Lists::make(candidates.len(), |x, list| {
        if !candidates.exists(x) || !is_contested(rings, candidates, x) {
            return;
        }
        for h in candidates.corners[x].iter().flat_map(|&p| candidates.own(rings, p as usize)) {
            if h != x
                && holds(candidates, params, h, x)
                && (precedes(candidates, h, x) || !is_contested(rings, candidates, h))
            {
                list.items.push(h as u32);
            }
        }
    })
}

/// Whether a fan of the three corners lacks the triangle.
fn is_contested(rings: &Rings, candidates: &Candidates, c: usize) -> bool {
    let fan = |p: u32| &candidates.of_slot[rings.slots(p as usize)];
    !candidates.corners[c].iter().all(|&p| fan(p).contains(&(c as u32)))
}
