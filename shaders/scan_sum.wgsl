// Prefix sum, going up: the sum of each block of 64 values.
// One invocation per block and no barriers, which software drivers pay for dearly.
// dispatch: first value, number of values.

@group(0) @binding(2) var<storage, read> values: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(64)
fn scan_sum(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let block = linear_index(id, groups);
    let first = block * 64u;
    if first >= dispatch.y {
        return;
    }
    var sum = 0u;
    for (var i = first; i < min(first + 64u, dispatch.y); i++) {
        sum += values[dispatch.x + i];
    }
    sums[block] = sum;
}
