// Second half of a counting sort: puts each item at the rank that it has in its cell.
// The order inside a cell is that in which the counts were taken; no result depends on it.
// One invocation per item. dispatch: number of items, number of cells.

@group(0) @binding(2) var<storage, read> cells: array<vec2<u32>>;
/// The first entry of each cell and one more, then the entries.
@group(0) @binding(3) var<storage, read_write> sorted: array<u32>;

@compute @workgroup_size(64)
fn sort_fill(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let item = linear_index(id, groups);
    if item >= dispatch.x {
        return;
    }
    let cell = cells[item];
    if cell.x != NONE {
        sorted[dispatch.y + 1u + sorted[cell.x] + cell.y] = item;
    }
}
