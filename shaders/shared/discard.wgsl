// The discard space (section 5, eq. 11). Twin: `discarded_by` in crates/reference/src/insertion.rs
//
// Expects `candidate_positions`, `candidate_normals` and what new_ring.wgsl has.

struct Closest {
    slot: u32,
    squared: f32,
}

/// The new point of Y or N' whose discard sphere (eq. 11) holds the candidate: the closest of them, or NONE.
fn discarded_by(slot: u32) -> u32 {
    var closest = Closest(NONE, 0.0);
    for (var i = 0u; i < ring.outer_size; i++) {
        try_discard(&closest, slot, arena[ring.outer + i]);
    }
    for (var i = 0u; i < ring.size; i++) {
        if !is_bound(slot_at(i)) {
            try_discard(&closest, slot, slot_at(i));
        }
    }
    return closest.slot;
}

fn try_discard(closest: ptr<function, Closest>, slot: u32, h: u32) {
    let d = candidate_positions[slot].xyz - candidate_positions[h].xyz;
    let d2 = dot3(d, d);
    let sphere = params.lambda2 * candidate_positions[h].w;
    let nearer = (*closest).slot == NONE || d2 < (*closest).squared || (d2 == (*closest).squared && h < (*closest).slot);
    let sees = same_side(candidate_normals[slot].xyz, candidate_normals[h].xyz);
    if d2 < sphere * sphere && nearer && sees {
        *closest = Closest(h, d2);
    }
}
