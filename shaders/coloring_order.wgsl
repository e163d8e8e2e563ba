// coloring: counts the points of each range of priorities, and notes the range and the rank of each point there.
// One invocation per point.

/// Size of each range at the index after its own.
@group(0) @binding(2) var<storage, read_write> order: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> cells: array<vec2<u32>>;

@compute @workgroup_size(64)
fn coloring_order(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let range = range_of(p);
    cells[p] = vec2(range, atomicAdd(&order[range + 1u], 1u));
}
