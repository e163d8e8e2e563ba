// candidates: the candidate of each slot, that of the slot to which its triangle belongs. One invocation per slot.
// Twin: `number` in crates/reference/src/triangle_homes.rs

@group(0) @binding(2) var<storage, read> numbers: array<u32>;
/// The slot to which each slot's triangle belongs, or NONE; becomes the candidate of each slot, or NONE.
@group(0) @binding(3) var<storage, read_write> of_slot: array<u32>;

@compute @workgroup_size(64)
fn candidates_link(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let slot = linear_index(id, groups);
    if slot >= params.slots {
        return;
    }
    let home = of_slot[slot];
    if home != NONE {
        of_slot[slot] = numbers[home];
    }
}
