// neighborhood: sorts what is left of N^E around each point: its one-ring.
// Twin: `one_ring` in crates/reference/src/neighborhood.rs
// One invocation per point. dispatch: first point, number of points.

@group(0) @binding(2) var<storage, read> blocks: array<vec2<u32>>;
/// As in neighborhood_natural. In the end the ring comes first, with bits of its angles as last words.
@group(0) @binding(3) var<storage, read_write> arena: array<vec4<u32>>;
/// Size of each ring at the index after its point's.
@group(0) @binding(4) var<storage, read_write> ring_starts: array<u32>;
@group(0) @binding(5) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn neighborhood_ring(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    let size = sort_ring(blocks[p].x, blocks[p].y);
    ring_starts[p + 1u] = size;
    if size == 0u {
        atomicAdd(&counters.isolated, 1u);
    }
    note_cut_loops(p);
}

/// Sorts the members that are not removed to the front, by angle, distance and index; returns their number.
fn sort_ring(first: u32, members: u32) -> u32 {
    var size = 0u;
    for (var i = first; i < first + members; i++) {
        var member = arena[i];
        if (member.w & REMOVED) != 0u && member.w != BACK {
            continue;
        }
        member.w = bitcast<u32>(direction_angle(bitcast<f32>(member.z), bitcast<f32>(member.y)));
        var at = first + size;
        while at > first && comes_before(member, arena[at - 1u]) {
            arena[at] = arena[at - 1u];
            at -= 1u;
        }
        arena[at] = member;
        size += 1u;
    }
    return size;
}

fn comes_before(a: vec4<u32>, b: vec4<u32>) -> bool {
    let angle_a = bitcast<f32>(a.w);
    let angle_b = bitcast<f32>(b.w);
    if angle_a != angle_b {
        return angle_a < angle_b;
    }
    let ax = bitcast<f32>(a.y);
    let ay = bitcast<f32>(a.z);
    let bx = bitcast<f32>(b.y);
    let by = bitcast<f32>(b.z);
    let distance_a = ax * ax + ay * ay;
    let distance_b = bx * bx + by * by;
    if distance_a != distance_b {
        return distance_a < distance_b;
    }
    return a.x < b.x;
}
