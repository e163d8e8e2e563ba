// grid: counts the points of each cell, and notes the cell and the rank of each point there.
// One invocation per point.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read_write> grid: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> cells: array<vec2<u32>>;

@compute @workgroup_size(64)
fn grid_points(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let cell = cell_index(cell_coordinates(points[p].position));
    cells[p] = vec2(cell, atomicAdd(&grid[cell + 1u], 1u));
}
