// Radii at the next level (section 5, end). Twin: crates/reference/src/new_ring/next_radii.rs
//
// Expects `next_radii` and what new_ring.wgsl and gaps.wgsl have.

/// The centre's radius covers N', those of N' cover the centre and their neighbours there. A point without new
/// neighbours keeps its radius.
fn store_radii() {
    var farthest = 0.0;
    // Each side is between two members: the one before looks back on it.
    var back = 0u;
    if ring.size > 0u {
        back = side_cover(ring.size - 1u);
    }
    for (var i = 0u; i < ring.size; i++) {
        let member = word(ORDER, i);
        let ahead = side_cover(i);
        if !is_bound(word(ID, member)) {
            let d = vector(OFFSET, member);
            farthest = max(farthest, dot3(d, d));
            atomicMax(&next_radii[params.points + word(ID, member)], max(cover(d), max(back, ahead)));
        }
        back = ahead;
    }
    let radius = select(COVER * sqrt(farthest), ring.radius, farthest == 0.0);
    atomicStore(&next_radii[ring.p], bitcast<u32>(radius));
}

/// What covers the side from the member at place i to the next one; 0 where there is none, or one
/// of them only bounds gaps.
fn side_cover(i: u32) -> u32 {
    let a = word(ORDER, i);
    let b = word(ORDER, next_member(i));
    if directed_gap(i) >= PI || is_bound(word(ID, a)) || is_bound(word(ID, b)) {
        return 0u;
    }
    return cover(vector(OFFSET, b) - vector(OFFSET, a));
}
