// Crease segments that run between two points (section 6). Twin: crates/reference/src/visible/fences.rs
//
// Expects what curves.wgsl, segments.wgsl and visible.wgsl have.

/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override separating_segments: bool = true;

/// Segments can separate two points if their middle is within this share of the points' distance, and half of the
/// longest segment, from the middle of the points.
const FENCE_REACH: f32 = 0.75;

/// Whether there may be curves within a radius around a point.
fn is_near_curves(position: vec3<f32>, radius: f32) -> bool {
    if !with_creases || !separating_segments {
        return false;
    }
    var walk = segment_walk(position, (FENCE_REACH + 0.5) * radius + params.longest_half);
    while !is_over(walk) {
        let entries = next_segments(&walk);
        if entries.x < entries.y {
            return true;
        }
    }
    return false;
}

/// Whether a crease runs between a point and another one within its radius.
fn is_fenced(center: Seen, radius: f32, other: Seen) -> bool {
    let d = other.position - center.position;
    let d2 = dot3(d, d);
    if dot3(center.normal, other.normal) > params.softest_crease || !is_apart(d2, radius) {
        return false;
    }
    let middle = center.position + d * 0.5;
    let reach = FENCE_REACH * sqrt(d2) + params.longest_half;
    var walk = segment_walk(middle, reach);
    while !is_over(walk) {
        let entries = next_segments(&walk);
        for (var i = entries.x; i < entries.y; i++) {
            let s = segment_at(i);
            let ends = segment_side(s, 0u);
            let off = (record_position(ends.x) + record_position(ends.y)) * 0.5 - middle;
            if dot3(off, off) <= reach * reach && separates(s, center, other) {
                return true;
            }
        }
    }
    return false;
}

/// Whether a crease segment runs between two points: they lie on different sides of it at an end, and the shortest way
/// between them over the unfolded sides crosses it.
fn separates(segment: u32, a: Seen, b: Seen) -> bool {
    let one = segment_side(segment, 0u);
    let two = segment_side(segment, 1u);
    if touches(segment, one, a.record) || touches(segment, one, b.record) || !crosses(one, a, b) {
        return false;
    }
    return parts(one.x, two.x, a, b) || parts(one.y, two.y, a, b);
}

fn touches(segment: u32, ends: vec2<u32>, record: u32) -> bool {
    if record == NONE {
        return false;
    }
    let first = record_first(record);
    return record_segment(record) == segment || record_first(ends.x) == first || record_first(ends.y) == first;
}

/// Whether two points lie on the two sides of a segment, seen from an end. At a corner either may lie on a third one:
/// that end can't tell then.
fn parts(one: u32, two: u32, a: Seen, b: Seen) -> bool {
    let side_a = side_of(one, a);
    let side_b = side_of(one, b);
    return side_a != side_b && (side_a == one || side_a == two) && (side_b == one || side_b == two);
}

/// Whether the straight way between two points over the unfolded sides of a segment meets it.
fn crosses(ends: vec2<u32>, a: Seen, b: Seen) -> bool {
    let start = record_position(ends.x);
    let v = record_position(ends.y) - start;
    let inverse = 1.0 / dot3(v, v);
    let at_a = place_along(a.position - start, v, inverse);
    let at_b = place_along(b.position - start, v, inverse);
    let crossing = at_a.x * at_b.y + at_b.x * at_a.y;
    return crossing >= 0.0 && crossing <= at_a.y + at_b.y;
}

/// Share of the way along v, and distance from it.
fn place_along(d: vec3<f32>, v: vec3<f32>, inverse: f32) -> vec2<f32> {
    let t = dot3(d, v) * inverse;
    let off = d - v * t;
    return vec2(t, sqrt(dot3(off, off)));
}
