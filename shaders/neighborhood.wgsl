// neighborhood: the one-ring of each point (sections 3 and 4). Twin: crates/reference/src/neighborhood.rs
// The Euclidean neighbourhood is in shared/ball.wgsl, the fuzzy planes in shared/fuzzy_planes.wgsl, members that come
// back in shared/natural.wgsl.
// One invocation per point. dispatch: first point, number of points.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> grid: array<u32>;
@group(0) @binding(4) var<storage, read> places: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read_write> fans: array<Fan>;
/// Neighbour and bits of its angle.
@group(0) @binding(6) var<storage, read_write> ring_entries: array<vec2<u32>>;
@group(0) @binding(7) var<storage, read_write> arena: array<u32>;
@group(0) @binding(8) var<storage, read_write> counters: Counters;
@group(0) @binding(9) var<storage, read> curves: array<u32>;

/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override natural_neighbors: bool = true;

// Rows: a member's index, the verdict on it, its angle, its place on the tangent plane, its height over it (of the
// fuzzy neighbourhood), and the members of the ring in order.
const ID: u32 = 0u;
const VERDICT: u32 = 1u;
const ANGLE: u32 = 2u;
const X: u32 = 3u;
const Y: u32 = 4u;
const HEIGHT: u32 = 5u;
const ORDER: u32 = 6u;
const ROWS: u32 = 7u;
/// Words of a row that is private.
const CAPACITY: u32 = 40u;
/// Members of most neighbourhoods: loops over these are unrolled.
const MOST: u32 = 8u;

// Verdicts on a member. Doubtful ones may lie on another sheet.
const KEPT: u32 = 0u;
const REMOVED: u32 = 1u;
const DOUBT: u32 = 2u;

@compute @workgroup_size(64)
fn neighborhood(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    if IN_ARENA && fans[p].left_over != NEIGHBORHOOD {
        return;
    }
    if !open_rows(p) {
        return;
    }
    let size = gather_ball(p);
    // One word more, as some are written before it is known that they stay.
    if !fits(size + 1u) {
        fans[p].left_over = NEIGHBORHOOD;
        atomicOr(&counters.left_over, NEIGHBORHOOD);
        atomicMax(&counters.longest_row, size + 1u);
        return;
    }
    count_ball(size);
    let members = keep_consistent(p, size);
    for (var i = 0u; i < members; i++) {
        if word(VERDICT, i) == KEPT && is_behind(i, members) {
            set_word(VERDICT, i, REMOVED);
        }
    }
    for (var i = 0u; i < members; i++) {
        set_number(ANGLE, i, direction_angle(number(Y, i), number(X, i)));
    }
    var ring = sort_ring(members);
    if natural_neighbors {
        ring = take_back(ring, members);
    }
    store_ring(p, ring);
    note_cut_loops(p);
}

fn is_kept(j: u32) -> bool {
    return word(VERDICT, j) == KEPT;
}

/// Whether a member hides nobody.
fn is_left_out(j: u32) -> bool {
    return word(VERDICT, j) == DOUBT;
}

fn count_ball(size: u32) {
    let before = atomicAdd(&counters.ball_low, size);
    if before + size < before {
        atomicAdd(&counters.ball_high, 1u);
    }
}

/// Writes the ring. Too small a buffer is seen by the host in the counters, and the stage runs again.
fn store_ring(p: u32, size: u32) {
    let first = atomicAdd(&counters.slots, size);
    fans[p].slots = vec2(first, size);
    fans[p].left_over = 0u;
    if size == 0u {
        atomicAdd(&counters.isolated, 1u);
    }
    if first + size > params.ring_entries {
        return;
    }
    for (var i = 0u; i < size; i++) {
        let member = word(ORDER, i);
        ring_entries[first + i] = vec2(word(ID, member), word(ANGLE, member));
    }
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
