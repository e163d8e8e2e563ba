// What a point sees when there are creases and boundaries (section 6). Twin: crates/reference/src/visible.rs
//
// Expects what curves.wgsl and fences.wgsl have.

/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override valid_sides: bool = true;

/// Squared distances below have no direction: the smallest normal numbers are near.
const SAME_PLACE: f32 = 1e-37;
/// A point belongs to a side only if their normals differ by less than this cosine says,
const LIKE: f32 = 0.3;
/// the sine of its elevation over the side's tangent plane is below this,
const STEEP_SIDE: f32 = 0.75;
/// and it does not lie behind the side by more than this cosine.
const BEHIND: f32 = -0.35;
/// Crease points see each other if neither lies behind the other by more than this cosine.
const CREASE_BEHIND: f32 = -0.3;

/// A point of the level or a new one, as others see it. Its record is NONE off the curves.
struct Seen {
    position: vec3<f32>,
    normal: vec3<f32>,
    record: u32,
}

/// Whether a point sees another one within its radius. `near_curves` as is_near_curves says.
fn sees(center: Seen, near_curves: bool, radius: f32, other: Seen) -> bool {
    return !with_curves || (sides_agree(center, radius, other) && !(near_curves && is_fenced(center, radius, other)));
}

/// Whether each of two points, if it lies on a curve, has the other one on its side.
fn sides_agree(center: Seen, radius: f32, other: Seen) -> bool {
    let d = other.position - center.position;
    let are_both_on_curves = center.record != NONE && other.record != NONE;
    // In the same place there is nothing between.
    if !is_apart(dot3(d, d), radius) {
        return !are_both_on_curves;
    }
    if center.record != NONE && !in_wedge(center.record, d) {
        return false;
    }
    let is_on_own = center.record == NONE || side_of(center.record, other) == center.record;
    let is_on_other = other.record == NONE || side_of(other.record, center) == other.record;
    if are_both_on_curves {
        return records_see(center.record, other.record, is_on_own && is_on_other);
    }
    return is_on_own && is_on_other;
}

/// Whether a direction lies between the curves that bound a record's sheet, or a little beyond.
fn in_wedge(record: u32, d: vec3<f32>) -> bool {
    let frame = record_frame(record);
    let angle = direction_angle(dot3(d, frame.e2), dot3(d, frame.e1));
    let wedge = record_wedge(record);
    return angle >= wedge.x && angle <= wedge.y;
}

/// The side of a crease point on which another point lies, or NONE; for a boundary point itself, if the
/// other one lies in its fan.
fn side_of(record: u32, other: Seen) -> u32 {
    let d = other.position - record_position(record);
    let d2 = dot3(d, d);
    if d2 < SAME_PLACE {
        return NONE;
    }
    let u = d * (1.0 / sqrt(d2));
    let first = record_first(record);
    let sides = record_sides(record);
    if sides == 1u || !with_creases {
        let like = dot3(other.normal, record_normal(record)) > LIKE;
        return select(NONE, record, like && in_wedge(record, d));
    }
    var best = first;
    var highest = 0.0;
    for (var k = first; k < first + sides; k++) {
        let score = dot3(other.normal, record_normal(k)) + dot3(u, record_conormal(k));
        if k == first || score > highest {
            best = k;
            highest = score;
        }
    }
    let normal = record_normal(best);
    let valid = dot3(other.normal, normal) > LIKE && abs(dot3(u, normal)) < STEEP_SIDE
        && dot3(u, record_conormal(best)) > BEHIND;
    return select(NONE, best, valid || !valid_sides);
}

/// Whether records of two points see each other; `agree` says whether each lies on the other's side. Those next to each
/// other on a curve do on their own side only.
fn records_see(a: u32, b: u32, agree: bool) -> bool {
    if record_first(a) == record_first(b) {
        return false;
    }
    if is_joined(a, b) || is_joined(b, a) {
        return any(record_partners(a) == vec2(b)) || any(record_partners(b) == vec2(a));
    }
    let d = record_position(b) - record_position(a);
    let u = d * (1.0 / sqrt(dot3(d, d)));
    return agree && (record_sides(a) == 1u || dot3(u, record_conormal(a)) > CREASE_BEHIND)
        && (record_sides(b) == 1u || -dot3(u, record_conormal(b)) > CREASE_BEHIND);
}

/// Whether a side of the one's point is next to the other's point on a curve.
fn is_joined(record: u32, other: u32) -> bool {
    let first = record_first(record);
    for (var k = first; k < first + record_sides(record); k++) {
        let partners = record_partners(k);
        if (partners.x != NONE && record_first(partners.x) == record_first(other))
            || (partners.y != NONE && record_first(partners.y) == record_first(other)) {
            return true;
        }
    }
    return false;
}
