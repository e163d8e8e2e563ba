// The candidate that is tried next (section 5). Twins: `closest` and `best_split` in crates/reference/src/insertion.rs
//
// Expects `states`, `ring_starts` and what new_ring.wgsl has.

/// For an empty N': the candidate closest to the centre, the first of equals.
fn closest_candidate(p: u32) -> u32 {
    var best = NONE;
    var least = 0.0;
    for (var slot = ring_starts[p]; slot < ring_starts[p + 1u]; slot++) {
        if atomicLoad(&states[slot]) != FREE {
            continue;
        }
        let d = offset_of(slot);
        let d2 = dot3(d, d);
        let closer = best == NONE || d2 * HYSTERESIS < least;
        if is_apart(d2, ring.radius) && closer {
            best = slot;
            least = d2;
        }
    }
    return best;
}

/// The candidate strictly inside gap i whose smaller angle to the two ends is the largest.
fn best_split(p: u32, i: u32) -> u32 {
    let from_angle = angle_at(i);
    let to_angle = angle_at(next_member(i));
    let wraps = i + 1u == ring.size;
    let a = offset_of(slot_at(i)) * ring.inverse_radius;
    let b = offset_of(slot_at(next_member(i))) * ring.inverse_radius;
    var best = NONE;
    var widest = SMALLEST_SPLIT;
    for (var slot = ring_starts[p]; slot < ring_starts[p + 1u]; slot++) {
        let angle = bitcast<f32>(arena[ring.angles + slot - ring_starts[p]]);
        let after = angle > from_angle;
        let before = angle < to_angle;
        let inside = select(after && before, after || before, wraps);
        if !inside || atomicLoad(&states[slot]) != FREE {
            continue;
        }
        let x = offset_of(slot) * ring.inverse_radius;
        let split = min(angle_between(a, x), angle_between(x, b));
        if split > widest * HYSTERESIS {
            best = slot;
            widest = split;
        }
    }
    return best;
}
