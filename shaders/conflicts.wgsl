// conflicts: the points that must not be refined together with each point, as seen from its own balls: λ1 r around it
// and λ2 ρ around its candidates. Twin: crates/reference/src/conflicts.rs
// One invocation per point.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> ring_starts: array<u32>;
@group(0) @binding(4) var<storage, read> candidate_positions: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> owners: array<u32>;
@group(0) @binding(6) var<storage, read> grid: array<u32>;
/// First entry and size of each point's list.
@group(0) @binding(7) var<storage, read_write> conflict_blocks: array<vec2<u32>>;
@group(0) @binding(8) var<storage, read_write> conflict_entries: array<u32>;
@group(0) @binding(9) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn conflicts(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let radius = reach_of_conflicts(p);
    // One entry for each candidate that conflicts: an upper bound of the list, whose points are found repeatedly.
    var bound = 0u;
    var walk = ball_walk(points[p].position, radius);
    for (var y = next_entry(&walk); y != NONE; y = next_entry(&walk)) {
        bound += u32(conflicting(p, y));
    }
    let first = atomicAdd(&counters.conflicts, bound);
    conflict_blocks[p] = vec2(first, 0u);
    if first + bound > params.conflict_entries {
        return;
    }
    var size = 0u;
    walk = ball_walk(points[p].position, radius);
    for (var y = next_entry(&walk); y != NONE; y = next_entry(&walk)) {
        let q = owners[y];
        if !listed(first, size, q) && conflicting(p, y) {
            conflict_entries[first + size] = q;
            size += 1u;
        }
    }
    conflict_blocks[p] = vec2(first, size);
}

/// Radius around p that holds all its balls.
fn reach_of_conflicts(p: u32) -> f32 {
    var reach = params.lambda1 * points[p].radius;
    for (var x = ring_starts[p]; x < ring_starts[p + 1u]; x++) {
        let candidate = candidate_positions[x];
        if candidate.w > 0.0 {
            let d = candidate.xyz - points[p].position;
            reach = max(reach, sqrt(dot3(d, d)) + params.lambda2 * candidate.w);
        }
    }
    return reach;
}

/// Whether candidate y belongs to another point and lies in one of p's balls.
fn conflicting(p: u32, y: u32) -> bool {
    if owners[y] == p {
        return false;
    }
    let position = candidate_positions[y].xyz;
    let near = params.lambda1 * points[p].radius;
    let from_p = position - points[p].position;
    if dot3(from_p, from_p) < near * near {
        return true;
    }
    for (var x = ring_starts[p]; x < ring_starts[p + 1u]; x++) {
        let candidate = candidate_positions[x];
        let d = position - candidate.xyz;
        let sphere = params.lambda2 * candidate.w;
        if candidate.w > 0.0 && dot3(d, d) < sphere * sphere {
            return true;
        }
    }
    return false;
}

fn listed(first: u32, size: u32, q: u32) -> bool {
    for (var i = first; i < first + size; i++) {
        if conflict_entries[i] == q {
            return true;
        }
    }
    return false;
}
