// Angles between the members of N' that follow each other (section 5, eq. 5).
// Twin: crates/reference/src/new_ring/gaps.rs
//
// Expects what insertion.wgsl and new_ring.wgsl have.

/// Whether angles between new neighbours are straight instead of curved.
override plain_angle: bool = false;

fn next_member(i: u32) -> u32 {
    return select(i + 1u, 0u, i + 1u == ring.size);
}

/// Directed angle on the tangent plane from the member at place i to the next one, in [0, 2π]. A sheet that ends at the
/// centre has no next one after the last.
fn directed_gap(i: u32) -> f32 {
    let last = i + 1u == ring.size;
    if last && ring.record != NONE {
        return TAU;
    }
    let to = number(ANGLE, word(ORDER, next_member(i)));
    return select(to, to + TAU, last) - number(ANGLE, word(ORDER, i));
}

/// Angle from the member at place i to the next one: curved (eq. 5), or plain; directed from π on.
fn measured_gap(i: u32) -> f32 {
    if ring.record != NONE && i + 1u == ring.size {
        return 0.0;
    }
    let directed = directed_gap(i);
    if directed >= PI {
        return directed;
    }
    let a = word(ORDER, i);
    let b = word(ORDER, next_member(i));
    let from_a = vector(OFFSET, a) * ring.inverse_radius;
    let from_b = vector(OFFSET, b) * ring.inverse_radius;
    if plain_angle {
        return angle_between(from_a, from_b);
    }
    return curved_angle(Corner(from_a, vector(NORMAL, a)), Corner(from_b, vector(NORMAL, b)));
}

/// The first of the widest gaps.
fn widest_gap() -> u32 {
    var widest = 0u;
    for (var i = 1u; i < ring.size; i++) {
        if number(GAP, i) > number(GAP, widest) * HYSTERESIS {
            widest = i;
        }
    }
    return widest;
}
