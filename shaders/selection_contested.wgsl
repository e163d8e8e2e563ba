// selection: lists the contested candidates, which some fan of their corners lacks. The others are inserted.
// Twin: `is_contested` in crates/reference/src/contested.rs
// One invocation per candidate.

/// All but their state is read.
@group(0) @binding(2) var<storage, read_write> candidates: array<Candidate>;
@group(0) @binding(3) var<storage, read> fans: array<Fan>;
@group(0) @binding(4) var<storage, read> of_slot: array<u32>;
/// The first candidate that belongs to each point.
@group(0) @binding(5) var<storage, read> first_candidates: array<u32>;
/// The candidates that wait in even rounds, then those that wait in odd ones.
@group(0) @binding(6) var<storage, read_write> waiting: array<u32>;
/// Number of both.
@group(0) @binding(7) var<storage, read_write> rounds: array<atomic<u32>, 2>;
@group(0) @binding(8) var<storage, read_write> counters: Counters;

/// Slots of most fans: the loop over these is unrolled.
const MOST: u32 = 8u;

@compute @workgroup_size(64)
fn selection_contested(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let c = linear_index(id, groups);
    if c >= params.candidates || candidates[c].place.w <= 0.0 {
        return;
    }
    let corners = candidates[c].corners;
    // It belongs to the first of its corners that has it.
    let first = c >= first_candidates[corners.x] & c < first_candidates[corners.x + 1u];
    if first & has(corners.y, c) & has(corners.z, c) {
        candidates[c].state = INSERTED;
    } else {
        candidates[c].state = WAITING;
        waiting[params.candidates + atomicAdd(&rounds[1], 1u)] = c;
    }
    note_cut_loops(corners.x);
}

/// Whether the fan of a point has a candidate.
fn has(p: u32, c: u32) -> bool {
    let block = fans[p].slots;
    let last = block.x + max(block.y, 1u) - 1u;
    var found = false;
    for (var i = 0u; i < MOST; i++) {
        found |= of_slot[min(block.x + i, last)] == c;
    }
    for (var slot = block.x + MOST; slot <= last; slot++) {
        found |= of_slot[slot] == c;
    }
    return found & block.y > 0u;
}
