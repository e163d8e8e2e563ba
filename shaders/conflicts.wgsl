// conflicts: the points that must not be refined together with each point, as seen from its own balls: λ1 r around it
// and λ2 ρ around its candidates. Twin: crates/reference/src/conflicts.rs
// One invocation per point.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> ring_starts: array<u32>;
@group(0) @binding(4) var<storage, read> candidate_positions: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> candidate_normals: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> owners: array<u32>;
@group(0) @binding(7) var<storage, read> grid: array<u32>;
/// First entry and size of each point's list.
@group(0) @binding(8) var<storage, read_write> conflict_blocks: array<vec2<u32>>;
@group(0) @binding(9) var<storage, read_write> conflict_entries: array<u32>;
@group(0) @binding(10) var<storage, read_write> counters: Counters;

/// What a point brings along: its centre, the square of λ1 r and its slots.
struct Own {
    p: u32,
    first: u32,
    after: u32,
    near_squared: f32,
    center: vec3<f32>,
}

@compute @workgroup_size(64)
fn conflicts(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let near = near_radius(p);
    let own = Own(p, ring_starts[p], ring_starts[p + 1u], near * near, points[p].position);
    let radius = reach_of_conflicts(own, near);
    // Beyond it no ball reaches, whatever the rounding.
    let reach_squared = radius * radius * 1.001;
    var size = 0u;
    var walk = ball_walk(own.center, radius);
    for (var y = next_entry(&walk); y != NONE; y = next_entry(&walk)) {
        size += u32(first_conflicting(own, y, reach_squared));
    }
    let first = atomicAdd(&counters.conflicts, size);
    conflict_blocks[p] = vec2(first, 0u);
    if first + size > params.conflict_entries {
        return;
    }
    conflict_blocks[p] = vec2(first, size);
    var next = first;
    walk = ball_walk(own.center, radius);
    for (var y = next_entry(&walk); y != NONE; y = next_entry(&walk)) {
        if first_conflicting(own, y, reach_squared) {
            conflict_entries[next] = owners[y];
            next += 1u;
        }
    }
    note_cut_loops(p);
}

/// Radius around the centre that holds all balls: λ1 r around it, λ2 ρ around its candidates.
fn reach_of_conflicts(own: Own, near: f32) -> f32 {
    var reach = near;
    for (var x = own.first; x < own.after; x++) {
        let candidate = candidate_positions[x];
        if candidate.w > 0.0 {
            let d = candidate.xyz - own.center;
            reach = max(reach, sqrt(dot3(d, d)) + params.lambda2 * candidate.w);
        }
    }
    return reach;
}

/// Whether candidate y lies in one of the balls.
fn conflicting(own: Own, y: u32, reach_squared: f32) -> bool {
    let position = candidate_positions[y].xyz;
    let from_center = position - own.center;
    let squared = dot3(from_center, from_center);
    if squared < own.near_squared {
        return true;
    }
    if squared > reach_squared {
        return false;
    }
    for (var x = own.first; x < own.after; x++) {
        let candidate = candidate_positions[x];
        let d = position - candidate.xyz;
        let sphere = params.lambda2 * candidate.w;
        if candidate.w > 0.0 && dot3(d, d) < sphere * sphere {
            return true;
        }
    }
    return false;
}

/// Whether candidate y conflicts and is the first one of its owner that does: so each point is listed once.
fn first_conflicting(own: Own, y: u32, reach_squared: f32) -> bool {
    let q = owners[y];
    // New points on creases and boundaries are there before all others: nobody has them.
    if q == NONE || q == own.p || !conflicting(own, y, reach_squared) {
        return false;
    }
    for (var earlier = ring_starts[q]; earlier < y; earlier++) {
        if candidate_positions[earlier].w > 0.0 && conflicting(own, earlier, reach_squared) {
            return false;
        }
    }
    return true;
}
