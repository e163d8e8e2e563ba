// conflicts: the candidates that each point may meet, and the points that must not be refined together with it, as
// far as its own side shows.
// Twin: crates/reference/src/conflicts.rs
// One invocation per point. dispatch: first point, number of points.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read_write> fans: array<Fan>;
@group(0) @binding(4) var<storage, read> of_slot: array<u32>;
@group(0) @binding(5) var<storage, read> candidates: array<Candidate>;
@group(0) @binding(6) var<storage, read> grid: array<u32>;
@group(0) @binding(7) var<storage, read> places: array<vec4<u32>>;
/// Lists of candidates around points and of conflicts.
@group(0) @binding(8) var<storage, read_write> around: array<u32>;
@group(0) @binding(9) var<storage, read_write> arena: array<u32>;
@group(0) @binding(10) var<storage, read_write> counters: Counters;
@group(0) @binding(11) var<storage, read> curves: array<u32>;

/// Widens what lists must hold, so that rounding can't lose an entry.
const WIDER: f32 = 1.00001;
/// New neighbourhoods that are longer, or have more candidates around, are left over by insertion.wgsl,
const LONGEST_NEW: u32 = 28u;
/// and those with more members by next_ring.wgsl.
const LONGEST_NEXT: u32 = 48u;

// Rows: a candidate, one within the distance of conflicts, a point in conflict.
const ID: u32 = 0u;
const CLOSE: u32 = 1u;
const FOUND: u32 = 2u;
const ROWS: u32 = 3u;
const CAPACITY: u32 = 64u;

/// How far what bears on a point may be.
struct Reach {
    /// The largest radius that it may have at the next level: that of now, or as far as its own candidates are.
    largest: f32,
    /// Within this distance are the candidates of all points that it is in conflict with, as far as it can see.
    conflicts: f32,
    /// The farthest own candidate.
    own_reach: f32,
    /// Number of its own candidates.
    own: u32,
}

@compute @workgroup_size(64)
fn conflicts(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    if IN_ARENA && fans[p].left_over != CONFLICTS {
        return;
    }
    if !open_rows(p) {
        return;
    }
    let reach = reach_of(p);
    // All, also those in the point's own place.
    let size = list_within(points[p].position, query_radius(p, reach), -1.0);
    if !fits(size + 1u) || !store(p, reach, size) {
        fans[p].left_over = CONFLICTS;
        atomicOr(&counters.left_over, CONFLICTS);
        atomicMax(&counters.longest_row, 3u * size + 1u);
    }
    note_cut_loops(p);
}

fn reach_of(p: u32) -> Reach {
    let slots = fans[p].slots;
    var reach = Reach(0.0, fans[p].near, 0.0, 0u);
    for (var slot = slots.x; slot < slots.x + slots.y; slot++) {
        let c = of_slot[slot];
        if c == NONE {
            continue;
        }
        let place = candidates[c].place;
        if place.w > 0.0 {
            let d = place.xyz - points[p].position;
            let distance = sqrt(dot3(d, d));
            reach.own_reach = max(reach.own_reach, distance);
            reach.conflicts = max(reach.conflicts, distance + params.lambda2 * place.w);
            reach.own += 1u;
        }
    }
    reach.largest = COVER * WIDER * max(points[p].radius, reach.own_reach);
    reach.conflicts = WIDER * reach.conflicts;
    return reach;
}

/// Within which distance a candidate with that discard sphere is of interest: others can neither enter
/// N' nor discard what might.
fn reach_of_candidate(p: u32, reach: Reach, sphere: f32) -> f32 {
    let bears = COVER * WIDER * max(fans[p].near, reach.own_reach + sphere);
    return min(reach.largest, select(bears, reach.largest, reach.own == 0u));
}

/// Within this distance are all candidates that may be listed, or in conflict.
fn query_radius(p: u32, reach: Reach) -> f32 {
    let widest = params.lambda2 * bitcast<f32>(atomicLoad(&counters.widest));
    return max(reach_of_candidate(p, reach, widest), reach.conflicts);
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
