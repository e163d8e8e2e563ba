// Takes natural neighbours back that were removed, in gaps of the ring that are wide open (ours).
// Twin: crates/reference/src/natural.rs
//
// Expects what neighborhood.wgsl declares.

/// A ring gap from 100° on may miss a natural neighbour, radians.
const OPEN_GAP: f32 = 1.7453293;

/// The verdict on members that come back: others are asked about while they are not there yet.
const BACK: u32 = 3u;

/// Takes members back into a ring of that size, and returns its new size.
fn take_back(ring: u32, members: u32) -> u32 {
    // The rest is asked in other words, so rounding may differ: a little less than an open gap counts.
    if members == ring || widest_gap(ring) < OPEN_GAP - 1e-3 {
        return ring;
    }
    for (var i = 0u; i < members; i++) {
        if word(VERDICT, i) != KEPT && is_in_open_gap(i, ring) && is_natural(i, members) {
            set_word(VERDICT, i, BACK);
        }
    }
    for (var i = 0u; i < members; i++) {
        if word(VERDICT, i) == BACK {
            set_word(VERDICT, i, KEPT);
        }
    }
    return sort_ring(members);
}

/// The widest gap of a ring: 2π if it has one member or none.
fn widest_gap(ring: u32) -> f32 {
    if ring < 2u {
        return TAU;
    }
    var before = number(ANGLE, word(ORDER, ring - 1u)) - TAU;
    var widest = 0.0;
    for (var i = 0u; i < ring; i++) {
        let angle = number(ANGLE, word(ORDER, i));
        widest = max(widest, angle - before);
        before = angle;
    }
    return widest;
}

/// Whether the kept members next to member i on both sides leave a gap that may miss a neighbour. Members that
/// come back are not among them.
fn is_in_open_gap(i: u32, ring: u32) -> bool {
    let x = number(X, i);
    let y = number(Y, i);
    var after = TAU;
    var before = TAU;
    for (var k = 0u; k < ring; k++) {
        let j = word(ORDER, k);
        let along = x * number(X, j) + y * number(Y, j);
        let across = x * number(Y, j) - y * number(X, j);
        after = min(after, direction_angle(across, along));
        before = min(before, direction_angle(-across, along));
    }
    return after + before >= OPEN_GAP;
}

/// Whether member i is a natural neighbour of the centre on its tangent plane: whether a piece of their bisector, no
/// farther from its middle than the radius, is nearer to both than to every other member.
fn is_natural(i: u32, members: u32) -> bool {
    let x = number(X, i);
    let y = number(Y, i);
    // Places on the bisector are half of (x, y) + t (-y, x).
    var high = 1.0 / sqrt(x * x + y * y);
    var low = -high;
    for (var j = 0u; j < members; j++) {
        if j == i {
            continue;
        }
        let other = vec2(number(X, j), number(Y, j));
        let along = x * other.x + y * other.y;
        let across = x * other.y - y * other.x;
        let room = 0.5 * ((other.x * other.x + other.y * other.y) - along);
        if across > 0.0 {
            high = min(high, room / across);
        } else if across < 0.0 {
            low = max(low, room / across);
        } else if room < 0.0 {
            return false;
        }
    }
    return low < high;
}
