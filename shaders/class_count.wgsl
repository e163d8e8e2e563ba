// coloring: counts the points of each class, and notes the class and the rank of each point there.
// One invocation per point.

/// One more than the class of each point.
@group(0) @binding(2) var<storage, read> classes: array<u32>;
/// Size of each class at the index after its own.
@group(0) @binding(3) var<storage, read_write> class_members: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> cells: array<vec2<u32>>;

@compute @workgroup_size(64)
fn class_count(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let number = classes[p];
    cells[p] = vec2(number - 1u, atomicAdd(&class_members[number], 1u));
}
