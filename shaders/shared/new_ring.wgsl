// The new neighbourhood N' of one point while it is refined. Twin: `Fan` in crates/reference/src/insertion.rs
//
// Expects `candidate_positions`, `candidate_normals`, `arena` and what curves.wgsl has.

/// Whether angles between new neighbours are straight instead of curved.
override plain_angle: bool = false;
/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override curve_bounds: bool = true;

/// A gap or an angle must be wider by this factor to be preferred to an earlier one: regular grids tie.
const HYSTERESIS: f32 = 1.00001;
/// A candidate nearer than this to an end of its gap, radians, does not split it.
const SMALLEST_SPLIT: f32 = 1e-3;
/// A member of N' in the arena: slot, or for a point that only bounds gaps its index after the last slot; bits of its
/// angle on the tangent plane; bits of the gap to the next member.
const MEMBER_WORDS: u32 = 3u;

struct NewRing {
    center: vec3<f32>,
    radius: f32,
    normal: vec3<f32>,
    /// Within this distance new points are new neighbours.
    near: f32,
    e1: vec3<f32>,
    inverse_radius: f32,
    e2: vec3<f32>,
    /// Number of members of N'.
    size: u32,
    /// First arena words of N', of the candidates' angles and of Y.
    members: u32,
    angles: u32,
    outer: u32,
    outer_size: u32,
    /// The centre's record, or NONE, and whether there are curves around.
    record: u32,
    near_curves: bool,
}

var<private> ring: NewRing;

fn open_ring(p: u32) {
    let frame = frame_of(p);
    ring.record = NONE;
    if with_curves {
        ring.record = record_of(p);
    }
    ring.near_curves = is_near_curves(points[p].position, points[p].radius);
    ring.center = points[p].position;
    ring.radius = points[p].radius;
    ring.inverse_radius = 1.0 / points[p].radius;
    ring.normal = points[p].normal;
    ring.near = near_radius(p);
    ring.e1 = frame.e1;
    ring.e2 = frame.e2;
    ring.size = 0u;
    ring.outer_size = 0u;
}

/// Whether a member is no new point and only bounds gaps.
fn is_bound(slot: u32) -> bool {
    return with_curves && slot >= params.slots;
}

/// A member relative to the centre.
fn offset_of(slot: u32) -> vec3<f32> {
    if is_bound(slot) {
        return points[slot - params.slots].position - ring.center;
    }
    return candidate_positions[slot].xyz - ring.center;
}

fn normal_of(slot: u32) -> vec3<f32> {
    if is_bound(slot) {
        return points[slot - params.slots].normal;
    }
    return candidate_normals[slot].xyz;
}

/// Where a step keeps the curves, the neighbours of a point along them bound its gaps, though they are not new.
fn add_bounds() {
    if ring.record == NONE || !curve_bounds || params.slots > params.fan_slots {
        return;
    }
    let partners = record_partners(ring.record);
    for (var k = 0u; k < 2u; k++) {
        if partners[k] != NONE {
            let slot = params.slots + record_point(partners[k]);
            set_member(ring.size, slot, angle_of(slot));
            ring.size += 1u;
        }
    }
}

fn angle_of(slot: u32) -> f32 {
    let d = offset_of(slot);
    return direction_angle(dot3(d, ring.e2), dot3(d, ring.e1));
}

fn slot_at(i: u32) -> u32 {
    return arena[ring.members + MEMBER_WORDS * i];
}

fn angle_at(i: u32) -> f32 {
    return bitcast<f32>(arena[ring.members + MEMBER_WORDS * i + 1u]);
}

fn gap_of(i: u32) -> f32 {
    return bitcast<f32>(arena[ring.members + MEMBER_WORDS * i + 2u]);
}

fn set_gap(i: u32, gap: f32) {
    arena[ring.members + MEMBER_WORDS * i + 2u] = bitcast<u32>(gap);
}

fn next_member(i: u32) -> u32 {
    return select(i + 1u, 0u, i + 1u == ring.size);
}

/// Whether a new point is not yet in N' and not in the centre's own place.
fn can_join(slot: u32) -> bool {
    for (var i = 0u; i < ring.size; i++) {
        if slot_at(i) == slot {
            return false;
        }
    }
    let d = offset_of(slot);
    return is_apart(dot3(d, d), ring.radius);
}

/// Directed angle on the tangent plane from member i to the next one, in [0, 2π]. A sheet that ends at the centre has no
/// next one after the last.
fn directed_gap(i: u32) -> f32 {
    if ring.record != NONE && i + 1u == ring.size {
        return TAU;
    }
    if i + 1u == ring.size {
        return (angle_at(0u) + TAU) - angle_at(i);
    }
    return angle_at(i + 1u) - angle_at(i);
}

/// Angle from member i to the next one: curved (eq. 5), or plain; directed from π on.
fn measured_gap(i: u32) -> f32 {
    if ring.record != NONE && i + 1u == ring.size {
        return 0.0;
    }
    let directed = directed_gap(i);
    if directed >= PI {
        return directed;
    }
    let a = slot_at(i);
    let b = slot_at(next_member(i));
    let from_a = offset_of(a) * ring.inverse_radius;
    let from_b = offset_of(b) * ring.inverse_radius;
    if plain_angle {
        return angle_between(from_a, from_b);
    }
    return curved_angle(Corner(from_a, normal_of(a)), Corner(from_b, normal_of(b)));
}

fn set_member(i: u32, slot: u32, angle: f32) {
    arena[ring.members + MEMBER_WORDS * i] = slot;
    arena[ring.members + MEMBER_WORDS * i + 1u] = bitcast<u32>(angle);
}

/// Whether a new point comes before member i: by angle, ties by slot.
fn precedes(slot: u32, angle: f32, i: u32) -> bool {
    return angle < angle_at(i) || (angle == angle_at(i) && slot < slot_at(i));
}

/// Puts N' in order: a heap sort, since balls that reach across a hole hold hundreds.
fn sort_members() {
    for (var i = ring.size / 2u; i > 0u; i--) {
        sift_down(i - 1u, ring.size);
    }
    for (var end = ring.size; end > 1u; end--) {
        let slot = slot_at(end - 1u);
        let angle = angle_at(end - 1u);
        set_member(end - 1u, slot_at(0u), angle_at(0u));
        set_member(0u, slot, angle);
        sift_down(0u, end - 1u);
    }
}

fn sift_down(root: u32, size: u32) {
    let slot = slot_at(root);
    let angle = angle_at(root);
    var at = root;
    for (var child = 2u * at + 1u; child < size; child = 2u * at + 1u) {
        if child + 1u < size && precedes(slot_at(child), angle_at(child), child + 1u) {
            child += 1u;
        }
        if !precedes(slot, angle, child) {
            break;
        }
        set_member(at, slot_at(child), angle_at(child));
        at = child;
    }
    set_member(at, slot, angle);
}

/// Puts a new point into its place in N' and returns that.
fn place(slot: u32, angle: f32) -> u32 {
    var at = ring.size;
    while at > 0u && precedes(slot, angle, at - 1u) {
        set_member(at, slot_at(at - 1u), angle_at(at - 1u));
        set_gap(at, gap_of(at - 1u));
        at -= 1u;
    }
    set_member(at, slot, angle);
    ring.size += 1u;
    return at;
}

/// Adds a new point to N' and measures the two gaps that it makes.
fn add(slot: u32) {
    let at = place(slot, angle_of(slot));
    let before = select(at - 1u, ring.size - 1u, at == 0u);
    set_gap(before, measured_gap(before));
    set_gap(at, measured_gap(at));
}

/// The first of the widest gaps.
fn widest_gap() -> u32 {
    var widest = 0u;
    for (var i = 1u; i < ring.size; i++) {
        if gap_of(i) > gap_of(widest) * HYSTERESIS {
            widest = i;
        }
    }
    return widest;
}
