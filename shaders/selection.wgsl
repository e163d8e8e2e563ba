// selection: one round of the selection of new points, the largest triangles first.
// Twin: `select` in crates/reference/src/selection.rs
// One invocation per candidate in round 0, then one per candidate that waits. dispatch: number of the round.
//
// A candidate is inserted unless one before it that discards it was. So what is inserted is what a sequential loop
// would insert, whatever rounds it takes. Most candidates are linked to nobody.

@group(0) @binding(2) var<storage, read_write> candidates: array<SharedCandidate>;
@group(0) @binding(3) var<storage, read> heads: array<u32>;
@group(0) @binding(4) var<storage, read> links: array<vec2<u32>>;
/// The candidates that wait in even rounds, then those that wait in odd ones.
@group(0) @binding(5) var<storage, read_write> waiting: array<u32>;
/// Number of both.
@group(0) @binding(6) var<storage, read_write> rounds: array<atomic<u32>, 2>;
@group(0) @binding(7) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn selection(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let i = linear_index(id, groups);
    let parity = dispatch.x & 1u;
    var c = i;
    if dispatch.x > 0u {
        if i >= atomicLoad(&rounds[parity]) {
            return;
        }
        c = waiting[parity * params.candidates + i];
    }
    if c >= params.candidates || atomicLoad(&candidates[c].state) != WAITING {
        return;
    }
    let state = state_of(c);
    if state == WAITING {
        let at = atomicAdd(&rounds[1u - parity], 1u);
        waiting[(1u - parity) * params.candidates + at] = c;
    } else {
        atomicStore(&candidates[c].state, state);
    }
    note_cut_loops(candidates[c].corners.x);
}
