// insertion: completes the new neighbourhood N' of each point of one class (section 5).
// Twin: crates/reference/src/insertion.rs
// N' is in shared/new_ring.wgsl, what it starts with in shared/gather.wgsl, the gaps between its members in
// shared/gaps.wgsl, the choice of a candidate in shared/choice.wgsl, eq. 11 in shared/discard.wgsl, the radii
// in shared/next_radii.wgsl.
// One invocation per point of the class. dispatch: the class from 1, its first member, its size, number of classes.
//
// Only candidates that earlier classes inserted are seen, so it does not matter when the members of one class run.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> fans: array<Fan>;
@group(0) @binding(4) var<storage, read> of_slot: array<u32>;
@group(0) @binding(5) var<storage, read_write> candidates: array<SharedCandidate>;
/// Lists of candidates around points and of conflicts.
@group(0) @binding(6) var<storage, read> around: array<u32>;
/// The first member of each class and one more, then the members by class.
@group(0) @binding(7) var<storage, read> class_members: array<u32>;
/// Bits of the radii at the next level: of the points, then of the candidates.
@group(0) @binding(8) var<storage, read_write> next_radii: array<atomic<u32>>;
@group(0) @binding(9) var<storage, read_write> arena: array<u32>;
@group(0) @binding(10) var<storage, read_write> counters: Counters;
@group(0) @binding(11) var<storage, read> curves: array<u32>;

// Rows of N': candidates, and after the last one the points of the level that only bound gaps; angle on the
// tangent plane; place relative to the centre; normal; radius of the discard sphere. Then its members in order,
// and the gaps between them.
const ID: u32 = 0u;
const ANGLE: u32 = 1u;
const OFFSET: u32 = 2u;
const NORMAL: u32 = 5u;
const SPHERE: u32 = 8u;
const ORDER: u32 = 9u;
const GAP: u32 = 10u;
// Rows of Y: candidates, places, radii of the discard spheres.
const OUTER: u32 = 11u;
const OUTER_OFFSET: u32 = 12u;
const OUTER_SPHERE: u32 = 15u;
// Rows of the fan's candidates: NONE once it was tried; angle; place; one over the distance; the one of Y that discards
// it, or NONE, and the squared distance to that.
const OWN: u32 = 16u;
const OWN_ANGLE: u32 = 17u;
const OWN_OFFSET: u32 = 18u;
const OWN_INVERSE: u32 = 21u;
const OWN_OUTER: u32 = 22u;
const OWN_SQUARED: u32 = 23u;
const ROWS: u32 = 24u;
/// As conflicts.wgsl counts on.
const CAPACITY: u32 = 28u;

@compute @workgroup_size(64)
fn insertion(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.z {
        return;
    }
    let p = class_members[dispatch.w + 1u + dispatch.y + index];
    if IN_ARENA != ((fans[p].left_over & INSERTION) != 0u) || !open_rows(p) {
        return;
    }
    open_ring(p);
    gather(p);
    gather_own(fans[p].slots, fans[p].near);
    // Where all candidates are in N', nothing more can be.
    if ring.own > 0u {
        complete();
    }
    store_radii();
    note_cut_loops(p);
}

/// How many words the rows must hold.
fn count_members(p: u32) -> u32 {
    // Each candidate can enter N' or bring in one point of Y, and curves bound gaps.
    return fans[p].around.y + fans[p].slots.y + 3u;
}

/// Splits the widest gap until none is as wide as θ_c or no candidate is left. Each candidate is tried once.
fn complete() {
    for (var i = 0u; i < ring.size; i++) {
        set_number(GAP, i, measured_gap(i));
    }
    loop {
        var chosen = NONE;
        if ring.size == 0u {
            chosen = closest_candidate();
            if chosen == NONE {
                return;
            }
        } else {
            let widest = widest_gap();
            if number(GAP, widest) < params.theta_c {
                return;
            }
            chosen = best_split(widest);
            if chosen == NONE {
                set_number(GAP, widest, 0.0);
                continue;
            }
        }
        let c = word(OWN, chosen);
        let h = discarded_by(chosen);
        set_word(OWN, chosen, NONE);
        if h == NONE {
            atomicStore(&candidates[c].state, dispatch.x);
        }
        let joins = select(h, c, h == NONE);
        if h == NONE || can_join(h) {
            add(joins);
        }
    }
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
