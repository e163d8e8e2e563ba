// grid: counts the points or candidates of each cell, and notes the cell and the rank of each item there.
// Twin: `Grid::sort` in crates/points/src/grid.rs
// One invocation per item. dispatch: number of items, words of four from one to the next.

/// Position, and a number that is above zero if the item exists: the radius of a point, ρ of a candidate.
@group(0) @binding(2) var<storage, read> items: array<vec4<f32>>;
/// Number of entries of each cell, at the index after its own.
@group(0) @binding(3) var<storage, read_write> grid: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> cells: array<vec2<u32>>;

@compute @workgroup_size(64)
fn grid_count(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = linear_index(id, groups);
    if i >= dispatch.x {
        return;
    }
    let item = items[i * dispatch.y];
    if item.w > 0.0 {
        let cell = cell_index(cell_coordinates(item.xyz));
        cells[i] = vec2(cell, atomicAdd(&grid[cell + 1u], 1u));
    } else {
        cells[i] = vec2(NONE);
    }
}
