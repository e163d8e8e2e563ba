// The new neighbourhood N' of one point while it is refined. Twin: crates/reference/src/new_ring.rs
//
// Expects what insertion.wgsl declares. Members keep their number; the row ORDER sorts them by angle.

/// A gap or an angle must be wider by this factor to be preferred to an earlier one: regular grids tie.
const HYSTERESIS: f32 = 1.00001;
/// A candidate nearer than 1e-3 radians to an end of its gap, here its cosine, does not split it.
const SMALLEST_SPLIT: f32 = 0.9999995;
/// A cosine must be less by this to be preferred to an earlier one.
const LESS: f32 = 1e-5;

struct NewRing {
    p: u32,
    center: vec3<f32>,
    radius: f32,
    inverse_radius: f32,
    e1: vec3<f32>,
    e2: vec3<f32>,
    /// Number of members of N', of Y and of the candidates.
    size: u32,
    outer_size: u32,
    own: u32,
    /// The centre's record, or NONE.
    record: u32,
}

var<private> ring: NewRing;

fn open_ring(p: u32) {
    let frame = frame_of(p);
    ring.p = p;
    ring.record = NONE;
    if with_curves {
        ring.record = record_of(p);
    }
    ring.center = points[p].position;
    ring.radius = points[p].radius;
    ring.inverse_radius = 1.0 / points[p].radius;
    ring.e1 = frame.e1;
    ring.e2 = frame.e2;
    ring.size = 0u;
    ring.outer_size = 0u;
    ring.own = 0u;
}

/// Whether a member is no new point and only bounds gaps.
fn is_bound(id: u32) -> bool {
    return with_curves && id >= params.candidates;
}

fn angle_of(d: vec3<f32>) -> f32 {
    return direction_angle(dot3(d, ring.e2), dot3(d, ring.e1));
}

/// Puts a new point into its place in N', by angle, ties by index, and returns that. Gaps move along.
fn place(id: u32, offset: vec3<f32>, normal: vec3<f32>, sphere: f32) -> u32 {
    let member = ring.size;
    let angle = angle_of(offset);
    set_word(ID, member, id);
    set_number(ANGLE, member, angle);
    set_vector(OFFSET, member, offset);
    set_vector(NORMAL, member, normal);
    set_number(SPHERE, member, sphere);
    var at = member;
    while at > 0u {
        let before = word(ORDER, at - 1u);
        let other = number(ANGLE, before);
        if other < angle || (other == angle && word(ID, before) < id) {
            break;
        }
        set_word(ORDER, at, before);
        set_word(GAP, at, word(GAP, at - 1u));
        at -= 1u;
    }
    set_word(ORDER, at, member);
    ring.size += 1u;
    return at;
}

/// Whether a new point is not yet in N' and not in the centre's own place.
fn can_join(c: u32) -> bool {
    var known = false;
    for (var i = 0u; i < ring.size; i++) {
        known |= word(ID, i) == c;
    }
    let d = candidates[c].place.xyz - ring.center;
    return !known & is_apart(dot3(d, d), ring.radius);
}

/// Adds a new point to N' and measures the two gaps that it makes.
fn add(c: u32) {
    let there = candidates[c].place;
    let at = place(c, there.xyz - ring.center, candidates[c].normal, params.lambda2 * there.w);
    // That before it, then its own: in one loop, since drivers copy functions to where they are called.
    var gap = select(at - 1u, ring.size - 1u, at == 0u);
    for (var i = 0u; i < 2u; i++) {
        set_number(GAP, gap, measured_gap(gap));
        gap = at;
    }
}
