// insertion: completes the new neighbourhood N' of each point of one class (section 5).
// Twin: crates/reference/src/insertion.rs
// The operations on N' are in shared/new_ring.wgsl, the choice of a candidate in shared/choice.wgsl, eq. 11 is in
// shared/discard.wgsl, the radii in shared/next_radii.wgsl.
// One invocation per point of the class. dispatch: one more than the class, its first member, its size, number of classes.
//
// Only candidates that earlier classes inserted are seen, so it does not matter when the members of one class run.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> ring_starts: array<u32>;
@group(0) @binding(4) var<storage, read> candidate_positions: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> candidate_normals: array<vec4<f32>>;
/// The candidates by cell, then the table of curves: drivers may allow no more than ten buffers.
@group(0) @binding(6) var<storage, read> grid: array<u32>;
/// The first member of each class and one more, then the members by class.
@group(0) @binding(7) var<storage, read> class_members: array<u32>;
@group(0) @binding(8) var<storage, read_write> states: array<atomic<u32>>;
/// Bits of the radii at the next level: of the points, then of the slots.
@group(0) @binding(9) var<storage, read_write> next_radii: array<atomic<u32>>;
@group(0) @binding(10) var<storage, read_write> arena: array<u32>;
@group(0) @binding(11) var<storage, read_write> counters: Counters;

@compute @workgroup_size(64)
fn insertion(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.z {
        return;
    }
    let p = class_members[dispatch.w + 1u + dispatch.y + index];
    open_ring(p);
    if !allocate(p) {
        return;
    }
    gather(p);
    complete(p);
    store_radii(p);
    note_cut_loops(p);
}

/// Takes room in the arena for N', the angles of the candidates and Y, as if all new points around were seen; false if
/// there is too little.
fn allocate(p: u32) -> bool {
    var near_count = 0u;
    var outer_count = 0u;
    let near = ring.near;
    var walk = ball_walk(ring.center, ring.radius);
    for (var slot = next_entry(&walk); slot != NONE; slot = next_entry(&walk)) {
        if !is_inserted(slot) {
            continue;
        }
        let d = offset_of(slot);
        let d2 = dot3(d, d);
        if d2 < ring.radius * ring.radius {
            let is_near = d2 < near * near && is_apart(d2, ring.radius);
            near_count += u32(is_near);
            outer_count += u32(!is_near);
        }
    }
    near_count += 2u * u32(ring.record != NONE);
    // Each candidate can enter N' or bring in one point of Y.
    let own = ring_starts[p + 1u] - ring_starts[p];
    let words = MEMBER_WORDS * (near_count + own) + own + outer_count;
    ring.members = atomicAdd(&counters.arena, words);
    ring.angles = ring.members + MEMBER_WORDS * (near_count + own);
    ring.outer = ring.angles + own;
    atomicMax(&counters.arena_peak, ring.members + words);
    return ring.members + words <= params.arena_words;
}

/// Starts N' with the new points nearer than λ1 r, and Y with the others nearer than r (eq. 10).
fn gather(p: u32) {
    let near = ring.near;
    var walk = ball_walk(ring.center, ring.radius);
    for (var slot = next_entry(&walk); slot != NONE; slot = next_entry(&walk)) {
        if !is_inserted(slot) {
            continue;
        }
        let d = offset_of(slot);
        let d2 = dot3(d, d);
        if d2 >= ring.radius * ring.radius || !visible(slot) {
            continue;
        }
        // A new point in the centre's own place has no direction: it can only discard.
        if d2 < near * near && is_apart(d2, ring.radius) {
            set_member(ring.size, slot, angle_of(slot));
            ring.size += 1u;
        } else {
            arena[ring.outer + ring.outer_size] = slot;
            ring.outer_size += 1u;
        }
    }
    add_bounds();
    sort_members();
    for (var i = 0u; i < ring.size; i++) {
        set_gap(i, measured_gap(i));
    }
    for (var slot = ring_starts[p]; slot < ring_starts[p + 1u]; slot++) {
        arena[ring.angles + slot - ring_starts[p]] = bitcast<u32>(angle_of(slot));
    }
}

/// Splits the widest gap until none is as wide as θ_c or no candidate is left. Each candidate is tried once.
fn complete(p: u32) {
    loop {
        var chosen = NONE;
        if ring.size == 0u {
            chosen = closest_candidate(p);
            if chosen == NONE {
                return;
            }
        } else {
            let widest = widest_gap();
            if gap_of(widest) < params.theta_c {
                return;
            }
            chosen = best_split(p, widest);
            if chosen == NONE {
                set_gap(widest, 0.0);
                continue;
            }
        }
        let h = discarded_by(chosen);
        if h == NONE {
            atomicStore(&states[chosen], dispatch.x + 1u);
            add(chosen);
        } else {
            atomicStore(&states[chosen], USED);
            if can_join(h) {
                add(h);
            }
        }
    }
}

/// Whether an earlier class inserted the candidate.
fn is_inserted(slot: u32) -> bool {
    return atomicLoad(&states[slot]) - 1u < dispatch.x;
}

/// Whether the centre sees a new point.
fn visible(slot: u32) -> bool {
    let normal = candidate_normals[slot].xyz;
    if !same_side(normal, ring.normal) {
        return false;
    }
    let center = Seen(ring.center, ring.normal, ring.record);
    let other = Seen(candidate_positions[slot].xyz, normal, record_of_slot(slot));
    return sees(center, ring.near_curves, ring.radius, other);
}

fn curve_word(at: u32) -> u32 {
    return grid[cell_count() + 1u + params.slots + at];
}
