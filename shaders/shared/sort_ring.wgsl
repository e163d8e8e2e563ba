// The members of a ring in the order of their angles. Twin: crates/reference/src/sort_ring.rs
//
// Expects rows ID, ANGLE and ORDER of the members, and `is_kept`, as neighborhood.wgsl has them.

/// Members over which the loop has a constant length, as in fuzzy_planes.wgsl.
const SORTED: u32 = 8u;

/// Sorts the members that are kept by angle, ties by index, and returns their number.
fn sort_ring(members: u32) -> u32 {
    var size = 0u;
    for (var i = 0u; i < members; i++) {
        if is_kept(i) {
            // Long rows keep few of their members. To compare each with all of them would take
            // loops to the driver's limit.
            if IN_ARENA {
                insert(i, size);
            } else {
                set_word(ORDER, rank_of(i, members), i);
            }
            size += 1u;
        }
    }
    return size;
}

/// How many of the members that are kept come before member i.
fn rank_of(i: u32, members: u32) -> u32 {
    var rank = 0u;
    for (var j = 0u; j < SORTED; j++) {
        rank += u32(j < members & is_kept(j) & comes_before(j, i));
    }
    for (var j = SORTED; j < members; j++) {
        rank += u32(is_kept(j) & comes_before(j, i));
    }
    return rank;
}

/// Puts a member into its place among so many that are sorted already.
fn insert(i: u32, size: u32) {
    var at = size;
    while at > 0u && comes_before(i, word(ORDER, at - 1u)) {
        set_word(ORDER, at, word(ORDER, at - 1u));
        at -= 1u;
    }
    set_word(ORDER, at, i);
}

fn comes_before(a: u32, b: u32) -> bool {
    let angle = number(ANGLE, a);
    let other = number(ANGLE, b);
    return angle < other | (angle == other & word(ID, a) < word(ID, b));
}
