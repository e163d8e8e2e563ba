// grid: counts the candidates of each cell, and notes the cell and the rank of each candidate there.
// One invocation per slot.

@group(0) @binding(2) var<storage, read> candidate_positions: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> grid: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> cells: array<vec2<u32>>;

@compute @workgroup_size(64)
fn grid_candidates(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let slot = linear_index(id, groups);
    if slot >= params.slots {
        return;
    }
    let candidate = candidate_positions[slot];
    if candidate.w <= 0.0 {
        cells[slot] = vec2(NONE, 0u);
        return;
    }
    let cell = cell_index(cell_coordinates(candidate.xyz));
    cells[slot] = vec2(cell, atomicAdd(&grid[cell + 1u], 1u));
}
