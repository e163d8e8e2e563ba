// The members of a ring in the order of their angles. Twin: `Around` in crates/reference/src/ball.rs
//
// Expects rows ID, ANGLE and ORDER of the members, and `is_kept`, as neighborhood.wgsl has them.

/// Members over which the loop has a constant length, as in fuzzy_planes.wgsl.
const SORTED: u32 = 8u * u32(!IN_ARENA);

/// Sorts the members that are kept by angle, ties by index, and returns their number.
fn sort_ring(members: u32) -> u32 {
    var size = 0u;
    for (var i = 0u; i < members; i++) {
        if is_kept(i) {
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
    for (var j = 0u; j < SORTED; j++) {
        rank += u32(j < members & comes_before(j, id, angle));
    }
    for (var j = SORTED; j < members; j++) {
        rank += u32(comes_before(j, id, angle));
    }
    return rank;
}

fn comes_before(j: u32, id: u32, angle: f32) -> bool {
    let other = number(ANGLE, j);
    return is_kept(j) & (other < angle | (other == angle & word(ID, j) < id));
}
