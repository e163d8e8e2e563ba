// The Euclidean neighbourhood N^E of a point without the pairs that eq. 6 rejects (sections 3 and 4).
// Twins: `find_balls` in crates/reference/src/neighborhood.rs, `judge` (eq. 6) in crates/reference/src/pairs.rs and
// `project` (eq. 9) in crates/reference/src/ball.rs
//
// Expects what neighborhood.wgsl declares.

/// The accurate neighbourhood N^g, or else the fuzzy one N^f.
override accurate: bool = true;
/// Rules beyond the paper: see `Rules` in crates/points/src/params.rs.
override opposite_pairs: bool = true;
override narrow_cones: bool = true;
override sure_neighbors: bool = true;

/// Cosine of 150°: points whose normals differ more are no neighbours, though eq. 6 lets exactly opposite ones pass.
const OPPOSITE: f32 = -0.8660254;
/// Share of the bound of eq. 6 from which pairs are rejected.
const NARROW: f32 = 0.7;
/// Share of the bound of eq. 6 from which pairs are doubtful.
const DOUBTFUL_SHARE: f32 = 0.5;

/// Lists N^E (eq. 7), all points within the radius but those in the same place. Returns how many they are, of which no
/// more are listed than fit.
fn gather_ball(p: u32) -> u32 {
    return list_within(points[p].position, points[p].radius, one_place(points[p].radius));
}

/// How many words the rows must hold, with one for what is written and then not kept.
fn count_members(p: u32) -> u32 {
    return count_within(points[p].position, points[p].radius) + 1u;
}

/// Keeps the members that eq. 6 does not reject, lays them onto the tangent plane, and returns how many are left.
fn keep_consistent(p: u32, size: u32) -> u32 {
    let center = points[p];
    let frame = frame_of(p);
    let inverse = 1.0 / center.radius;
    var meets_curves = is_on_curve(p);
    var turns = false;
    var members = 0u;
    for (var i = 0u; i < size; i++) {
        let q = word(ID, i);
        let d = points[q].position - center.position;
        let d2 = dot3(d, d);
        let normal = points[q].normal;
        let u = d * (1.0 / sqrt(d2));
        let x = dot3(d, frame.e1);
        let y = dot3(d, frame.e2);
        let q2 = x * x + y * y;
        let stays = q2 > 1e-12 * d2 & consistent(u, center.normal, normal);
        meets_curves |= stays & is_on_curve(q);
        turns |= stays & with_creases & dot3(center.normal, normal) <= params.softest_crease;
        var scale = inverse;
        if accurate {
            // The geodesic projection q' (eq. 9).
            scale = (geodesic_distance(d, center.normal, normal) * inverse) / sqrt(q2);
        }
        set_word(ID, members, q);
        set_word(VERDICT, members, select(KEPT, DOUBT, is_doubtful(u, center.normal, normal)));
        set_number(X, members, x * scale);
        set_number(Y, members, y * scale);
        if !accurate {
            set_number(HEIGHT, members, dot3(d, center.normal) * inverse);
        }
        members += u32(stays);
    }
    if with_curves {
        return keep_seen(p, members, meets_curves, turns);
    }
    return members;
}

/// Keeps the members that the centre sees, and returns how many are left. All are unless one of them or the centre lies
/// on a curve, or one turns away as far as across a crease and there are creases around: a loop of its own, since what
/// it asks costs much and few points need it.
fn keep_seen(p: u32, members: u32, meets_curves: bool, turns: bool) -> u32 {
    let radius = points[p].radius;
    let center = Seen(points[p].position, points[p].normal, record_of(p));
    var seen = members;
    if meets_curves {
        seen = 0u;
        for (var i = 0u; i < members; i++) {
            seen = keep_if(sides_agree(center, radius, seen_member(i)), i, seen);
        }
    }
    if turns && is_near_curves(center.position, radius) {
        let asked = seen;
        seen = 0u;
        for (var i = 0u; i < asked; i++) {
            seen = keep_if(!is_fenced(center, radius, seen_member(i)), i, seen);
        }
    }
    return seen;
}

fn seen_member(i: u32) -> Seen {
    let q = word(ID, i);
    return Seen(points[q].position, points[q].normal, record_of(q));
}

/// Moves member i behind those that are kept, and says how many these are then.
fn keep_if(stays: bool, i: u32, kept: u32) -> u32 {
    for (var row = ID; row <= HEIGHT; row++) {
        set_word(row, kept, word(row, i));
    }
    return kept + u32(stays);
}

/// Eq. 6, printed inverted: whether neither point lies in the cone of apex the other and axis n0 + n1.
fn consistent(u: vec3<f32>, n0: vec3<f32>, n1: vec3<f32>) -> bool {
    let cosine = dot3(n0, n1);
    let along = abs(dot3(n0 + n1, u));
    // The margin is for flat surfaces, where both sides are rounding.
    let bound = select(1.0 + cosine, NARROW * (1.0 + cosine) + 1e-6, narrow_cones);
    return along <= bound & !(opposite_pairs & cosine < OPPOSITE);
}

/// Whether a pair that passes is doubtful: a step between two sheets rather than a slope of one.
fn is_doubtful(u: vec3<f32>, n0: vec3<f32>, n1: vec3<f32>) -> bool {
    let along = abs(dot3(n0 + n1, u));
    let beyond = along > DOUBTFUL_SHARE * (1.0 + dot3(n0, n1)) + 1e-6;
    return sure_neighbors & natural_neighbors & beyond;
}
