// The ring of a point at the next level, and the radii that it asks for. Twin: `Around` in crates/reference/src/next_ring.rs
//
// Expects what next_ring.wgsl declares.

/// Removes the members that lie behind others. Removal is simultaneous: a removed one still removes.
fn filter_members(around: Around) {
    for (var i = around.first; i < around.first + around.size; i++) {
        if is_behind(around, i) {
            arena[i].w = NONE;
        }
    }
}

fn is_behind(around: Around, i: u32) -> bool {
    let own = plane_vector(around, i);
    let x = bitcast<f32>(arena[i].y);
    let y = bitcast<f32>(arena[i].z);
    var badness = Badness(-2.0, -2.0);
    for (var j = around.first; j < around.first + around.size; j++) {
        // An exactly collinear point counts as successor.
        let succeeds = x * bitcast<f32>(arena[j].z) - y * bitcast<f32>(arena[j].y) >= 0.0;
        if i != j && is_bad(&badness, own, plane_vector(around, j), succeeds) {
            return true;
        }
    }
    return false;
}

/// The vector whose fuzzy plane is tested: q' - p for the accurate neighbourhood, p_i - p for the fuzzy one.
fn plane_vector(around: Around, i: u32) -> vec3<f32> {
    if accurate {
        return vec3(bitcast<f32>(arena[i].y), bitcast<f32>(arena[i].z), 0.0);
    }
    return offset_of(around, arena[i].x) * (1.0 / points[around.p].radius);
}

/// Sorts the members that are left to the front, by angle, then by index; returns their number.
fn sort_ring(first: u32, members: u32) -> u32 {
    var size = 0u;
    for (var i = first; i < first + members; i++) {
        var member = arena[i];
        if member.w == NONE {
            continue;
        }
        let angle = direction_angle(bitcast<f32>(member.z), bitcast<f32>(member.y));
        member.w = bitcast<u32>(angle);
        var at = first + size;
        while at > first && comes_before(member.x, angle, arena[at - 1u]) {
            arena[at] = arena[at - 1u];
            at -= 1u;
        }
        arena[at] = member;
        size += 1u;
    }
    return size;
}

fn comes_before(id: u32, angle: f32, other: vec4<u32>) -> bool {
    return angle < bitcast<f32>(other.w) || (angle == bitcast<f32>(other.w) && id < other.x);
}

/// The point covers the members, they cover it and, over gaps below π, each other.
fn cover_ring(around: Around) {
    for (var i = 0u; i < around.size; i++) {
        let last = i + 1u == around.size;
        let member = arena[around.first + i];
        let next = arena[around.first + select(i + 1u, 0u, last)];
        let d = offset_of(around, member.x);
        cover(around.p, d);
        cover(member.x, d);
        let to = bitcast<f32>(next.w);
        let gap = select(to, to + TAU, last) - bitcast<f32>(member.w);
        if gap < PI && !(last && is_on_curve(around.p)) {
            let side = offset_of(around, next.x) - d;
            cover(member.x, side);
            cover(next.x, side);
        }
    }
}

/// Makes the radius of an old point or a slot at least this long.
fn cover(id: u32, distance: vec3<f32>) {
    let radius = COVER * sqrt(dot3(distance, distance));
    atomicMax(&next_radii[params.points + params.slots + id], bitcast<u32>(radius));
}
