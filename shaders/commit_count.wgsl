// commit: marks the inserted candidates, at the index after their own. One invocation per candidate.

@group(0) @binding(2) var<storage, read> candidates: array<Candidate>;
@group(0) @binding(3) var<storage, read_write> new_indices: array<u32>;

@compute @workgroup_size(64)
fn commit_count(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let c = linear_index(id, groups);
    if c < params.candidates {
        new_indices[c + 1u] = u32(candidates[c].state != FREE);
    }
}
