// next_ring: radii that cover the next level's rings (ours). Twin: crates/reference/src/next_ring.rs
// One invocation per point. dispatch: first point, number of points.
//
// The members of the old ring and the inserted candidates within the new radius go through the filter of section 4;
// what is left must be within the radii, of the point and of the members alike. The filter and the radii are in
// shared/ahead.wgsl.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> ring_starts: array<u32>;
@group(0) @binding(4) var<storage, read> ring_entries: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> candidate_positions: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> candidate_normals: array<vec4<f32>>;
/// The candidates by cell, then the table of curves: drivers may allow no more than ten buffers.
@group(0) @binding(7) var<storage, read> grid: array<u32>;
@group(0) @binding(8) var<storage, read> states: array<u32>;
/// Bits of the radii at the next level: of the points, then of the slots, by the insertion; then the same by this kernel.
@group(0) @binding(9) var<storage, read_write> next_radii: array<atomic<u32>>;
/// Members: old points by index, then slots; bits of x and y on the tangent plane; bits of the angle, or NONE.
@group(0) @binding(10) var<storage, read_write> arena: array<vec4<u32>>;
@group(0) @binding(11) var<storage, read_write> counters: Counters;

/// The accurate neighbourhood N^g, or else the fuzzy one N^f.
override accurate: bool = true;

/// Radii exceed the distances they must cover by this factor, so that rounding can't lose the farthest ring.
const COVER: f32 = 1.02;

/// A point and its members in the arena.
struct Around {
    p: u32,
    first: u32,
    size: u32,
    center: vec3<f32>,
    normal: vec3<f32>,
    frame: TangentFrame,
    near_curves: bool,
}

@compute @workgroup_size(64)
fn next_ring(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    let radius = bitcast<f32>(atomicLoad(&next_radii[p]));
    let center = points[p];
    let near_curves = is_near_curves(center.position, radius);
    var around = Around(p, 0u, 0u, center.position, center.normal, frame_of(p), near_curves);
    let own = ring_starts[p + 1u] - ring_starts[p];
    let most = own + count_new(around, radius);
    around.first = atomicAdd(&counters.arena, 4u * most) / 4u;
    atomicMax(&counters.arena_peak, 4u * (around.first + most));
    if 4u * (around.first + most) > params.arena_words {
        return;
    }
    for (var slot = ring_starts[p]; slot < ring_starts[p + 1u]; slot++) {
        add(&around, ring_entries[slot].x);
    }
    var walk = ball_walk(around.center, radius);
    for (var slot = next_entry(&walk); slot != NONE; slot = next_entry(&walk)) {
        if is_near(around, slot, radius) {
            add(&around, params.points + slot);
        }
    }
    filter_members(around);
    around.size = sort_ring(around.first, around.size);
    cover_ring(around);
    note_cut_loops(p);
}

/// Whether an inserted candidate is within the radius, where the centre sees it.
fn is_near(around: Around, slot: u32, radius: f32) -> bool {
    let d = candidate_positions[slot].xyz - around.center;
    let inserted = states[slot] - 1u < USED - 1u;
    let normal = candidate_normals[slot].xyz;
    if !inserted || dot3(d, d) > radius * radius || !same_side(normal, around.normal) {
        return false;
    }
    let center = Seen(around.center, around.normal, record_of(around.p));
    let other = Seen(candidate_positions[slot].xyz, normal, record_of_slot(slot));
    return sees(center, around.near_curves, radius, other);
}

fn count_new(around: Around, radius: f32) -> u32 {
    var count = 0u;
    var walk = ball_walk(around.center, radius);
    for (var slot = next_entry(&walk); slot != NONE; slot = next_entry(&walk)) {
        count += u32(is_near(around, slot, radius));
    }
    return count;
}

/// An old point or a slot relative to the centre.
fn offset_of(around: Around, id: u32) -> vec3<f32> {
    if id < params.points {
        return points[id].position - around.center;
    }
    return candidate_positions[id - params.points].xyz - around.center;
}

fn normal_of(id: u32) -> vec3<f32> {
    if id < params.points {
        return points[id].normal;
    }
    return candidate_normals[id - params.points].xyz;
}

/// Adds a member, unless it has no direction on the tangent plane.
fn add(around: ptr<function, Around>, id: u32) {
    let radius = points[(*around).p].radius;
    let d = offset_of(*around, id);
    let d2 = dot3(d, d);
    let x = dot3(d, (*around).frame.e1);
    let y = dot3(d, (*around).frame.e2);
    let q2 = x * x + y * y;
    if !is_apart(d2, radius) || q2 <= 1e-12 * d2 {
        return;
    }
    let inverse = 1.0 / radius;
    var scale = inverse;
    if accurate {
        scale = (geodesic_distance(d, (*around).normal, normal_of(id)) * inverse) / sqrt(q2);
    }
    arena[(*around).first + (*around).size] = vec4(id, bitcast<u32>(x * scale), bitcast<u32>(y * scale), 0u);
    (*around).size += 1u;
}

fn curve_word(at: u32) -> u32 {
    return grid[cell_count() + 1u + params.slots + at];
}
