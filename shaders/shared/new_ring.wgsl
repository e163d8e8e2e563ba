// The new neighbourhood N' of one point while it is refined. Twin: `Fan` in crates/reference/src/fan.rs
//
// Expects what insertion.wgsl declares. Members keep their number; the row ORDER sorts them by angle.

/// Whether angles between new neighbours are straight instead of curved.
override plain_angle: bool = false;
/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override curve_bounds: bool = true;

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

/// Where a step keeps the curves, the neighbours of a point along them bound its gaps, though they are not new.
fn add_bounds() {
    if !with_curves || ring.record == NONE || !curve_bounds || params.candidates > params.triangles {
        return;
    }
    let partners = record_partners(ring.record);
    for (var k = 0u; k < 2u; k++) {
        if partners[k] != NONE {
            let q = record_point(partners[k]);
            place(params.candidates + q, points[q].position - ring.center, points[q].normal, 0.0);
        }
    }
}

fn angle_of(d: vec3<f32>) -> f32 {
    return direction_angle(dot3(d, ring.e2), dot3(d, ring.e1));
}

fn next_member(i: u32) -> u32 {
    return select(i + 1u, 0u, i + 1u == ring.size);
}

/// Directed angle on the tangent plane from the member at place i to the next one, in [0, 2π]. A sheet that ends at the
/// centre has no next one after the last.
fn directed_gap(i: u32) -> f32 {
    let last = i + 1u == ring.size;
    if last && ring.record != NONE {
        return TAU;
    }
    let to = number(ANGLE, word(ORDER, next_member(i)));
    return select(to, to + TAU, last) - number(ANGLE, word(ORDER, i));
}

/// Angle from the member at place i to the next one: curved (eq. 5), or plain; directed from π on.
fn measured_gap(i: u32) -> f32 {
    if ring.record != NONE && i + 1u == ring.size {
        return 0.0;
    }
    let directed = directed_gap(i);
    if directed >= PI {
        return directed;
    }
    let a = word(ORDER, i);
    let b = word(ORDER, next_member(i));
    let from_a = vector(OFFSET, a) * ring.inverse_radius;
    let from_b = vector(OFFSET, b) * ring.inverse_radius;
    if plain_angle {
        return angle_between(from_a, from_b);
    }
    return curved_angle(Corner(from_a, vector(NORMAL, a)), Corner(from_b, vector(NORMAL, b)));
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

/// The first of the widest gaps.
fn widest_gap() -> u32 {
    var widest = 0u;
    for (var i = 1u; i < ring.size; i++) {
        if number(GAP, i) > number(GAP, widest) * HYSTERESIS {
            widest = i;
        }
    }
    return widest;
}
