// The candidate that is tried next (section 5). Twin: crates/reference/src/new_ring/choice.rs
//
// Expects what insertion.wgsl, new_ring.wgsl and gaps.wgsl have. Candidates are those of the row OWN.

/// For an empty N': the candidate closest to the centre, the first of equals.
fn closest_candidate() -> u32 {
    var best = NONE;
    var least = 0.0;
    for (var k = 0u; k < ring.own; k++) {
        let d = vector(OWN_OFFSET, k);
        let d2 = dot3(d, d);
        let closer = best == NONE | d2 * HYSTERESIS < least;
        let chosen = word(OWN, k) != NONE & is_apart(d2, ring.radius) & closer;
        best = select(best, k, chosen);
        least = select(least, d2, chosen);
    }
    return best;
}

/// The candidate strictly inside gap i whose smaller angle to the two ends is the largest: angles are
/// compared by their cosines.
fn best_split(i: u32) -> u32 {
    let begin = word(ORDER, i);
    let end = word(ORDER, next_member(i));
    let begin_angle = number(ANGLE, begin);
    let end_angle = number(ANGLE, end);
    let wraps = i + 1u == ring.size;
    let a = unit(vector(OFFSET, begin));
    let b = unit(vector(OFFSET, end));
    var best = NONE;
    var largest = SMALLEST_SPLIT;
    for (var k = 0u; k < ring.own; k++) {
        let angle = number(OWN_ANGLE, k);
        let after = angle > begin_angle;
        let before = angle < end_angle;
        let inside = (after & before) | (wraps & (after | before));
        let x = vector(OWN_OFFSET, k);
        let cosine = max(dot3(a, x), dot3(b, x)) * number(OWN_INVERSE, k);
        let chosen = word(OWN, k) != NONE & inside & cosine < largest;
        best = select(best, k, chosen);
        largest = select(largest, cosine - LESS, chosen);
    }
    return best;
}
