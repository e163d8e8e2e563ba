// commit: marks the inserted candidates, at the index after their own. One invocation per slot.

@group(0) @binding(2) var<storage, read> states: array<u32>;
@group(0) @binding(3) var<storage, read_write> new_indices: array<u32>;

@compute @workgroup_size(64)
fn commit_count(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let slot = linear_index(id, groups);
    if slot >= params.slots {
        return;
    }
    let state = states[slot];
    new_indices[slot + 1u] = u32(state != FREE && state < USED);
}
