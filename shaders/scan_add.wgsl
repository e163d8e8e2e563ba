// Prefix sum, going down: replaces each value by the sum of all values up to it, itself included.
// One invocation per block of 64. dispatch: first value, number of values.

@group(0) @binding(2) var<storage, read_write> values: array<u32>;
/// Prefix sums of the blocks' sums.
@group(0) @binding(3) var<storage, read> sums: array<u32>;

@compute @workgroup_size(64)
fn scan_add(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let block = linear_index(id, groups);
    let first = block * 64u;
    if first >= dispatch.y {
        return;
    }
    var sum = 0u;
    if block > 0u {
        sum = sums[block - 1u];
    }
    for (var i = first; i < min(first + 64u, dispatch.y); i++) {
        sum += values[dispatch.x + i];
        values[dispatch.x + i] = sum;
    }
}
