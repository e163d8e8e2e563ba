// neighborhood: copies the rings out of the arena, one after the other.
// One invocation per point. dispatch: first point, number of points.

@group(0) @binding(2) var<storage, read> arena: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> blocks: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> ring_starts: array<u32>;
/// Neighbour and bits of its angle.
@group(0) @binding(5) var<storage, read_write> ring_entries: array<vec2<u32>>;

@compute @workgroup_size(64)
fn neighborhood_store(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    let start = ring_starts[p];
    let size = ring_starts[p + 1u] - start;
    // Too small a buffer is seen by the host in the last start, and the stage runs again.
    if start + size > params.ring_entries {
        return;
    }
    for (var i = 0u; i < size; i++) {
        let entry = arena[blocks[p].x + i];
        ring_entries[start + i] = entry.xw;
    }
}
