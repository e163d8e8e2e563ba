// grid: puts each item at the rank that it has in its cell.
// The order inside a cell is that in which the counts were taken; no result depends on it.
// One invocation per item. dispatch: number of items, words of four from one to the next.

@group(0) @binding(2) var<storage, read> items: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> cells: array<vec2<u32>>;
/// The first entry of each cell, and one more.
@group(0) @binding(4) var<storage, read> grid: array<u32>;
/// Bits of the position of each entry, and the item's index.
@group(0) @binding(5) var<storage, read_write> places: array<vec4<u32>>;

@compute @workgroup_size(64)
fn grid_fill(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = linear_index(id, groups);
    if i >= dispatch.x {
        return;
    }
    let cell = cells[i];
    if cell.x != NONE {
        places[grid[cell.x] + cell.y] = vec4(bitcast<vec3<u32>>(items[i * dispatch.y].xyz), i);
    }
}
