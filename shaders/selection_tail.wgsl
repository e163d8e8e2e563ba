// selection: the last rounds, when few candidates wait: one workgroup goes through them in less time than
// a dispatch for each takes.
// Twin: `select` in crates/reference/src/selection.rs
// One workgroup. dispatch: number of the first of these rounds.

@group(0) @binding(2) var<storage, read_write> candidates: array<SharedCandidate>;
@group(0) @binding(3) var<storage, read> heads: array<u32>;
@group(0) @binding(4) var<storage, read> links: array<vec2<u32>>;
/// The candidates that wait in even rounds, then those that wait in odd ones.
@group(0) @binding(5) var<storage, read_write> waiting: array<u32>;
/// Number of both.
@group(0) @binding(6) var<storage, read_write> rounds: array<u32, 2>;
@group(0) @binding(7) var<storage, read_write> counters: Counters;

/// If more candidates wait, they are left to dispatches of many workgroups.
const FEW: u32 = 512u;
/// The most rounds: eight candidates of a lane in each, of a hundred links, are a fifth of the iterations after which
/// some drivers cut loops short.
const ROUNDS: u32 = 16u;

/// The candidates that wait in this round, and those that will in the next one.
var<workgroup> lists: array<u32, 1024>;
/// Number of the latter, and of the former.
var<workgroup> listed: atomic<u32>;
var<workgroup> size: u32;

@compute @workgroup_size(64)
fn selection_tail(@builtin(local_invocation_index) lane: u32) {
    let block = (dispatch.x & 1u) * params.candidates;
    if lane == 0u {
        size = rounds[dispatch.x & 1u];
    }
    var count = workgroupUniformLoad(&size);
    if count > FEW {
        return;
    }
    for (var i = lane; i < count; i += 64u) {
        lists[i] = waiting[block + i];
    }
    var now = 0u;
    for (var round = 0u; round < ROUNDS && count > 0u; round++) {
        decide(lane, now, count);
        now = FEW - now;
        if lane == 0u {
            size = atomicExchange(&listed, 0u);
        }
        count = workgroupUniformLoad(&size);
    }
    for (var i = lane; i < count; i += 64u) {
        waiting[block + i] = lists[now + i];
    }
    if lane == 0u {
        rounds[dispatch.x & 1u] = count;
    }
}

/// One round: candidates of the list that begins there get their states, or are put on the other list.
fn decide(lane: u32, now: u32, count: u32) {
    workgroupBarrier();
    for (var i = lane; i < count; i += 64u) {
        let c = lists[now + i];
        let state = state_of(c);
        if state == WAITING {
            lists[FEW - now + atomicAdd(&listed, 1u)] = c;
        } else {
            atomicStore(&candidates[c].state, state);
        }
        note_cut_loops(candidates[c].corners.x);
    }
    // The next round reads states and the list.
    storageBarrier();
    workgroupBarrier();
}
