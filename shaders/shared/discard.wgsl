// The discard space (section 5, eq. 11). Twin: crates/reference/src/new_ring/discard.rs
//
// Expects what insertion.wgsl and new_ring.wgsl have.

/// The new point whose discard sphere holds a candidate, the closest of them, or NONE.
struct Closest {
    c: u32,
    squared: f32,
}

/// The one of Y, which stays as it is, for a candidate of the row OWN.
fn discarded_by_outer(k: u32) -> Closest {
    let x = vector(OWN_OFFSET, k);
    let c = word(OWN, k);
    var closest = Closest(NONE, 0.0);
    for (var i = 0u; i < ring.outer_size; i++) {
        closest = closer(closest, word(OUTER, i), x - vector(OUTER_OFFSET, i), number(OUTER_SPHERE, i), c);
    }
    return closest;
}

/// The one of Y or N'.
fn discarded_by(k: u32) -> u32 {
    let x = vector(OWN_OFFSET, k);
    let c = word(OWN, k);
    var closest = Closest(word(OWN_OUTER, k), number(OWN_SQUARED, k));
    for (var i = 0u; i < ring.size; i++) {
        // Members that only bound gaps have no sphere.
        closest = closer(closest, word(ID, i), x - vector(OFFSET, i), number(SPHERE, i), c);
    }
    return closest.c;
}

/// The closer one of what is known and h, at a distance d from candidate c.
fn closer(closest: Closest, h: u32, d: vec3<f32>, sphere: f32, c: u32) -> Closest {
    let d2 = dot3(d, d);
    let nearer = closest.c == NONE | d2 < closest.squared | (d2 == closest.squared & h < closest.c);
    var discards = d2 < sphere * sphere & nearer;
    if discards {
        discards = same_side(candidates[c].normal, candidates[h].normal);
    }
    return Closest(select(closest.c, h, discards), select(closest.squared, d2, discards));
}
