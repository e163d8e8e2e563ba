// candidates: to which point the triangle of each slot belongs, that it is one candidate though three fans have it.
// Twin: `homes` in crates/reference/src/candidates.rs
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
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let corners = fan_triangle(p, slot);
        var home = NONE;
        if corners.x == p {
            home = slot;
        } else if corners.x != NONE {
            home = slot_of(corners.x, corners.y, corners.z);
            is_missed |= home == NONE;
        }
        homes[slot] = home;
        count += u32(home == slot);
    }
    // Rarely: to look for the second corners among the others would cost as much as the others.
    if is_missed {
        count += take_missed(p, block);
    }
    first_candidates[p + 1u] = count;
    fans[p].near = near_radius(p, block);
}

/// Finds to which slots those triangles of a fan belong that the fan of their first corner lacks: to that of their second one, or
/// else to their own. Returns how many the latter are.
fn take_missed(p: u32, block: vec2<u32>) -> u32 {
    var count = 0u;
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        let corners = fan_triangle(p, slot);
        if homes[slot] == NONE && corners.x != NONE {
            var second = NONE;
            if corners.y != p {
                second = slot_of(corners.y, corners.z, corners.x);
            }
            homes[slot] = select(second, slot, second == NONE);
            count += u32(second == NONE);
        }
    }
    return count;
}

/// The slot of the triangle in the fan of p that leads from one corner to the other, or NONE.
fn slot_of(p: u32, begin: u32, end: u32) -> u32 {
    let block = fans[p].slots;
    var found = NONE;
    for (var slot = block.x; slot < block.x + block.y; slot++) {
        found = select(found, slot, ring_entries[slot].x == begin);
    }
    if found == NONE {
        return NONE;
    }
    let next = select(found + 1u, block.x, found + 1u == block.x + block.y);
    let is_there = ring_entries[next].x == end && fan_triangle(p, found).x != NONE;
    return select(NONE, found, is_there);
}

/// λ1 r. The radii of the input may be too large, and would take far points for new neighbours: in the first step they
/// count as no more than NATURAL times the distance to the farthest neighbour. A selection among all candidates has no use for
/// radii, and asks for that distance; if simplified for nothing.
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
