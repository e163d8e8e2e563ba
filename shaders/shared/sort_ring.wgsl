// The members of a ring in the order of their angles. Twin: `Around` in crates/reference/src/ball.rs
//
// Expects rows ID, FATE, ANGLE and ORDER of the members, and MOST, as neighborhood.wgsl has them.

// What becomes of a member.
const KEPT: u32 = 0u;
const REMOVED: u32 = 1u;

/// Members over which loops have a constant length: drivers unroll them, and private rows at constant places cost them little.
const UNROLLED: u32 = MOST * u32(!IN_ARENA);

/// Sorts the members that are kept by angle, ties by index, and returns their number.
fn sort_ring(members: u32) -> u32 {
    var size = 0u;
    for (var i = 0u; i < members; i++) {
        if word(FATE, i) == KEPT {
            set_word(ORDER, rank_of(i, members), i);
            size += 1u;
        }
    }
    return size;
}

/// How many of the members that are kept come before member i.
fn rank_of(i: u32, members: u32) -> u32 {
    let id = word(ID, i);
    let angle = number(ANGLE, i);
    var rank = 0u;
    for (var j = 0u; j < UNROLLED; j++) {
        rank += u32(j < members & comes_before(j, id, angle));
    }
    for (var j = UNROLLED; j < members; j++) {
        rank += u32(comes_before(j, id, angle));
    }
    return rank;
}

fn comes_before(j: u32, id: u32, angle: f32) -> bool {
    let other = number(ANGLE, j);
    return word(FATE, j) == KEPT & (other < angle | (other == angle & word(ID, j) < id));
}
