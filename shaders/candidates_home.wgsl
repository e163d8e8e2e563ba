// candidates: to which point the triangle of each slot belongs, that it is one candidate though three fans have it.
// Twins: `find_fan` and `home` in crates/reference/src/triangle_homes.rs, `near_radius` in
// crates/reference/src/candidates.rs
// One invocation per point.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read_write> fans: array<Fan>;
@group(0) @binding(4) var<storage, read> ring_entries: array<vec2<u32>>;
/// The slot to which each slot's triangle belongs; NONE for slots without a triangle.
@group(0) @binding(5) var<storage, read_write> homes: array<u32>;
/// Number of triangles of each point at the index after its own.
@group(0) @binding(6) var<storage, read_write> first_candidates: array<u32>;
@group(0) @binding(7) var<storage, read> curves: array<u32>;

/// Rules beyond the paper: see `Rules` in crates/points/src/params.rs.
override first_radii: bool = true;
override largest_first: bool = true;
/// Whether a selection among all candidates asks for no distances: sizes are ρ.
override simplified: bool = false;

/// Radii exceed the distance to the farthest natural neighbour by this factor.
const NATURAL: f32 = 1.25;

@compute @workgroup_size(64)
fn candidates_home(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let block = fans[p].slots;
    var count = 0u;
    var is_missed = false;
    var begin = first_entry(block);
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let end = entry_after(slot, block);
        let corners = canonical(p, begin.x, end.x);
        var home = NONE;
        if is_triangle(p, begin, end, is_last(slot, block)) {
            home = slot;
            if corners.x != p {
                home = slot_of(corners.x, corners.y, corners.z);
                is_missed |= home == NONE;
            }
        }
        homes[slot] = home;
        count += u32(home == slot);
        begin = end;
    }
    // Rarely: to look for the second corners among the others would cost as much as the others.
    if is_missed {
        count += take_missed(p, block);
    }
    first_candidates[p + 1u] = count;
    fans[p].near = near_radius(p, block);
}

/// Finds to which slots those triangles of a fan belong that the fan of their first corner lacks: to that of their
/// second one, or else to their own. Returns how many the latter are.
fn take_missed(p: u32, block: vec2<u32>) -> u32 {
    var count = 0u;
    var begin = first_entry(block);
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let end = entry_after(slot, block);
        let corners = canonical(p, begin.x, end.x);
        if homes[slot] == NONE && is_triangle(p, begin, end, is_last(slot, block)) {
            var second = NONE;
            if corners.y != p {
                second = slot_of(corners.y, corners.z, corners.x);
            }
            homes[slot] = select(second, slot, second == NONE);
            count += u32(second == NONE);
        }
        begin = end;
    }
    return count;
}

/// The first entry of a ring.
fn first_entry(block: vec2<u32>) -> vec2<u32> {
    if block.y == 0u {
        return vec2(NONE);
    }
    return ring_entries[block.x];
}

/// The entry of a ring that follows a slot's own.
fn entry_after(slot: u32, block: vec2<u32>) -> vec2<u32> {
    return ring_entries[select(slot + 1u, block.x, is_last(slot, block))];
}

fn is_last(slot: u32, block: vec2<u32>) -> bool {
    return slot + 1u == block.x + block.y;
}

/// The slot of the triangle in the fan of p that leads from one corner to the other, or NONE.
fn slot_of(p: u32, begin: u32, end: u32) -> u32 {
    let block = fans[p].slots;
    var found = NONE;
    var angles = vec2(0u);
    let first = first_entry(block);
    var entry = first;
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let is_wrapping = is_last(slot, block);
        var after = first;
        if !is_wrapping {
            after = ring_entries[slot + 1u];
        }
        let is_it = entry.x == begin & after.x == end;
        found = select(found, slot, is_it);
        angles = select(angles, vec2(entry.y, after.y), is_it);
        entry = after;
    }
    if found == NONE {
        return NONE;
    }
    let is_there = is_triangle(p, vec2(begin, angles.x), vec2(end, angles.y), is_last(found, block));
    return select(NONE, found, is_there);
}

/// λ1 r. The radii of the input may be too large, and would take far points for new neighbours: in the first step they
/// count as no more than NATURAL times the distance to the farthest neighbour. A selection among all candidates has no
/// use for radii, and asks for that distance; if simplified for nothing.
fn near_radius(p: u32, block: vec2<u32>) -> f32 {
    let radius = points[p].radius;
    if !largest_first && (!first_radii || params.level > 1u || block.y == 0u) {
        return params.lambda1 * radius;
    }
    if largest_first && simplified {
        return 0.0;
    }
    var farthest = 0.0;
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let d = points[ring_entries[slot].x].position - points[p].position;
        farthest = max(farthest, dot3(d, d));
    }
    if largest_first {
        return params.lambda1 * sqrt(farthest);
    }
    return params.lambda1 * min(radius, NATURAL * sqrt(farthest));
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
