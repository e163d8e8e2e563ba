// The ring of a point at the next level, and the radii that it asks for. Twin: `cover_ring` in
// crates/reference/src/next_ring.rs
//
// Expects what next_ring.wgsl declares.

/// Radii exceed the distances they must cover by this factor, so that rounding can't lose the farthest ring.
const COVER: f32 = 1.02;

/// Puts a member into its place in a ring of that size, by angle, then by index.
fn sort_in(member: u32, size: u32) {
    let angle = number(ANGLE, member);
    var at = size;
    while at > 0u {
        let before = word(ORDER, at - 1u);
        let other = number(ANGLE, before);
        if other < angle || (other == angle && word(ID, before) < word(ID, member)) {
            break;
        }
        set_word(ORDER, at, before);
        at -= 1u;
    }
    set_word(ORDER, at, member);
}

/// Bits of the radius that covers a distance: they are ordered as radii are.
fn cover(distance: vec3<f32>) -> u32 {
    return bitcast<u32>(COVER * sqrt(dot3(distance, distance)));
}

/// The point covers the members, they cover it and, over gaps below π, each other.
fn cover_ring(p: u32, size: u32) {
    if size == 0u {
        return;
    }
    let own = params.points + params.candidates;
    let ends_here = is_on_curve(p);
    var farthest = 0u;
    // Each side is between two members: the one before looks back on it.
    var back = side_cover(size - 1u, size, ends_here);
    for (var i = 0u; i < size; i++) {
        let member = word(ORDER, i);
        let ahead = side_cover(i, size, ends_here);
        let radius = cover(vector(PLACE, member));
        farthest = max(farthest, radius);
        atomicMax(&next_radii[own + word(ID, member)], max(radius, max(back, ahead)));
        back = ahead;
    }
    atomicMax(&next_radii[own + p], farthest);
}

/// What covers the side from the member at place i to the next one; 0 where there is none.
fn side_cover(i: u32, size: u32, ends_here: bool) -> u32 {
    let last = i + 1u == size;
    let a = word(ORDER, i);
    let b = word(ORDER, select(i + 1u, 0u, last));
    let to = number(ANGLE, b);
    let gap = select(to, to + TAU, last) - number(ANGLE, a);
    if gap >= PI || (last && ends_here) {
        return 0u;
    }
    return cover(vector(PLACE, b) - vector(PLACE, a));
}
