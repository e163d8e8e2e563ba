// The ring of a point at the next level, and the radii that it asks for. Twin: `cover_ring` in
// crates/reference/src/next_ring.rs
//
// Expects what next_ring.wgsl declares.

/// The point covers the members, they cover it and, over gaps below π, each other.
fn cover_ring(p: u32, size: u32) {
    if size == 0u {
        return;
    }
    let center = points[p].position;
    let ends_here = is_on_curve(p);
    var farthest = 0u;
    // Each side is between two members: the one before looks back on it.
    let first = word(ORDER, 0u);
    let last = word(ORDER, size - 1u);
    var member = first;
    var offset = place_of(first) - center;
    let is_closed = number(ANGLE, first) + TAU - number(ANGLE, last) < PI && !ends_here;
    var back = select(0u, cover(offset - (place_of(last) - center)), is_closed);
    for (var i = 0u; i < size; i++) {
        let is_last = i + 1u == size;
        let after = word(ORDER, select(i + 1u, 0u, is_last));
        let offset_after = place_of(after) - center;
        let is_open = select(number(ANGLE, after) - number(ANGLE, member) >= PI, !is_closed, is_last);
        let ahead = select(cover(offset_after - offset), 0u, is_open);
        let radius = cover(offset);
        farthest = max(farthest, radius);
        raise(word(ID, member), max(radius, max(back, ahead)));
        back = ahead;
        member = after;
        offset = offset_after;
    }
    raise(p, farthest);
}

/// Raises the radius of a point or, after these, of a candidate. Most are large enough: to look
/// costs less than to write.
fn raise(id: u32, radius: u32) {
    let at = select(id, id + params.points + params.candidates, id < params.points);
    if atomicLoad(&next_radii[at]) < radius {
        atomicMax(&next_radii[at], radius);
    }
}
