// next_ring: radii that cover the next level's rings (ours). Twin: crates/reference/src/next_ring.rs
// One invocation per point. dispatch: first point, number of points.
//
// The members of the old ring and of N' (by the paper's loop all inserted candidates within the new radius) go
// through the filter of section 4; what is left must be within the radii, of the point and of the members alike. The
// radii are in shared/ahead.wgsl.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> fans: array<Fan>;
@group(0) @binding(4) var<storage, read> ring_entries: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> candidates: array<Candidate>;
/// The members of N'; by the paper's loop lists of candidates around points and of conflicts.
@group(0) @binding(6) var<storage, read> around: array<u32>;
/// Bits of the radii at the next level: of the points, then of the candidates; then of the points by this kernel,
/// which reads the first ones.
@group(0) @binding(7) var<storage, read_write> next_radii: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read_write> arena: array<u32>;
@group(0) @binding(9) var<storage, read_write> counters: Counters;
@group(0) @binding(10) var<storage, read> curves: array<u32>;

/// The accurate neighbourhood N^g, or else the fuzzy one N^f.
override accurate: bool = true;

/// Whether the lists hold N' alone, by the selection.
override largest_first: bool = true;

// Rows: old points by index, then candidates; their angles; their places on the tangent plane; their heights over it
// (of the fuzzy neighbourhood); the members of the ring in order.
const ID: u32 = 0u;
const ANGLE: u32 = 1u;
const X: u32 = 2u;
const Y: u32 = 3u;
const HEIGHT: u32 = 4u;
const ORDER: u32 = 5u;
const ROWS: u32 = 6u;
/// As conflicts.wgsl counts on.
const CAPACITY: u32 = 48u;
/// Members of most neighbourhoods: loops over these are unrolled.
const MOST: u32 = 12u;

/// The centre of a ring.
struct Center {
    position: vec3<f32>,
    radius: f32,
    normal: vec3<f32>,
    frame: TangentFrame,
    /// Number of members that were added.
    members: u32,
}

@compute @workgroup_size(64)
fn next_ring(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    if IN_ARENA != ((fans[p].left_over & NEXT_RING) != 0u) || !open_rows(p) {
        return;
    }
    let members = gather(p);
    // Those that are kept come first, with their angles; their places stay where they are, for the others.
    var size = 0u;
    for (var i = 0u; i < members; i++) {
        set_word(ID, size, word(ID, i));
        set_number(ANGLE, size, direction_angle(number(Y, i), number(X, i)));
        size += u32(!is_behind(i, members));
    }
    cover_ring(p, sort_ring(size));
    note_cut_loops(p);
}

/// Those that are not kept are not sorted.
fn is_kept(j: u32) -> bool {
    return true;
}

/// Whether a member hides nobody.
fn is_left_out(j: u32) -> bool {
    return false;
}

/// How many words the rows must hold.
fn count_members(p: u32) -> u32 {
    return fans[p].slots.y + fans[p].around.y + 1u;
}

/// Lists the members of the old ring, and of N' or the new points within the new radius.
fn gather(p: u32) -> u32 {
    let point = points[p];
    var center = Center(point.position, point.radius, point.normal, frame_of(p), 0u);
    let slots = fans[p].slots;
    for (var slot = slots.x; slot < slots.x + slots.y; slot++) {
        let q = ring_entries[slot].x;
        add(&center, q, points[q].position - center.position, points[q].normal);
    }
    let list = fans[p].around;
    if largest_first {
        for (var i = list.x; i < list.x + list.y; i++) {
            let c = around[i];
            add(&center, params.points + c, candidates[c].place.xyz - center.position, candidates[c].normal);
        }
        return center.members;
    }
    let radius = bitcast<f32>(atomicLoad(&next_radii[p]));
    // First the new points are listed, then projected: loops over few are cheaper than branches.
    var size = 0u;
    for (var i = list.x; i < list.x + list.y; i++) {
        let c = around[i];
        let d = candidates[c].place.xyz - center.position;
        set_word(ORDER, size, c);
        size += u32(candidates[c].state != FREE & dot3(d, d) <= radius * radius);
    }
    for (var i = 0u; i < size; i++) {
        let c = word(ORDER, i);
        add(&center, params.points + c, candidates[c].place.xyz - center.position, candidates[c].normal);
    }
    return center.members;
}

/// Adds a member, unless it has no direction on the tangent plane.
fn add(center: ptr<function, Center>, id: u32, d: vec3<f32>, normal: vec3<f32>) {
    let d2 = dot3(d, d);
    let x = dot3(d, (*center).frame.e1);
    let y = dot3(d, (*center).frame.e2);
    let q2 = x * x + y * y;
    let inverse = 1.0 / (*center).radius;
    var scale = inverse;
    if accurate {
        scale = (geodesic_distance(d, (*center).normal, normal) * inverse) / sqrt(q2);
    }
    let i = (*center).members;
    set_word(ID, i, id);
    set_number(X, i, x * scale);
    set_number(Y, i, y * scale);
    if !accurate {
        set_number(HEIGHT, i, dot3(d, (*center).normal) * inverse);
    }
    (*center).members += u32(is_apart(d2, (*center).radius) & q2 > 1e-12 * d2);
}

/// The place of a member.
fn place_of(member: u32) -> vec3<f32> {
    let id = word(ID, member);
    if id < params.points {
        return points[id].position;
    }
    return candidates[id - params.points].place.xyz;
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
