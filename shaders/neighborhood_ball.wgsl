// neighborhood: the Euclidean neighbourhood N^E of each point without the pairs that eq. 6 rejects (sections 3 and 4).
// Twin: `consistent_ball` in crates/reference/src/neighborhood.rs
// One invocation per point. dispatch: first point, number of points.
//
// A point takes as many arena entries as N^E has members. If the arena is too small, nothing is written and the
// counters tell the host what to provide.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> grid: array<u32>;
/// Members of N^E: index, bits of x and y on the tangent plane, and the point whose neighbourhood it is, with the bits
/// REMOVED and DOUBTFUL if it may lie on another sheet.
@group(0) @binding(4) var<storage, read_write> arena: array<vec4<u32>>;
/// First arena entry and number of members of each point.
@group(0) @binding(5) var<storage, read_write> blocks: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> counters: Counters;
@group(0) @binding(7) var<storage, read> curves: array<u32>;

/// The accurate neighbourhood N^g, or else the fuzzy one N^f.
override accurate: bool = true;
/// Rules beyond the paper: see `Rules` in crates/points/src/params.rs.
override opposite_pairs: bool = true;
override narrow_cones: bool = true;
override natural_neighbors: bool = true;
override sure_neighbors: bool = true;

/// Cosine of 150°: points whose normals differ more are no neighbours, though eq. 6 lets exactly opposite ones pass.
const OPPOSITE: f32 = -0.8660254;
/// Share of the bound of eq. 6 from which pairs are rejected.
const NARROW: f32 = 0.7;
/// Share of the bound of eq. 6 from which pairs are doubtful.
const DOUBTFUL_SHARE: f32 = 0.5;

@compute @workgroup_size(64)
fn neighborhood_ball(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    let size = ball_size(p);
    let first = atomicAdd(&counters.arena, 4u * size) / 4u;
    atomicMax(&counters.arena_peak, 4u * (first + size));
    count_ball(size);
    blocks[p] = vec2(first, 0u);
    if 4u * (first + size) > params.arena_words {
        return;
    }
    let members = consistent_ball(p, first);
    blocks[p] = vec2(first, members);
    for (var i = first + members; i < first + size; i++) {
        arena[i].w = NONE;
    }
    note_cut_loops(p);
}

fn count_ball(size: u32) {
    let before = atomicAdd(&counters.ball_low, size);
    if before + size < before {
        atomicAdd(&counters.ball_high, 1u);
    }
}

/// Whether q is in N^E (eq. 7): within the radius and not in the same place.
fn in_ball(center: Point, p: u32, q: u32) -> bool {
    let d = points[q].position - center.position;
    let d2 = dot3(d, d);
    return q != p && d2 <= center.radius * center.radius && is_apart(d2, center.radius);
}

fn ball_size(p: u32) -> u32 {
    let center = points[p];
    var size = 0u;
    var walk = ball_walk(center.position, center.radius);
    for (var q = next_entry(&walk); q != NONE; q = next_entry(&walk)) {
        size += u32(in_ball(center, p, q));
    }
    return size;
}

/// Writes N^E without the pairs that eq. 6 rejects, and returns how many are left.
fn consistent_ball(p: u32, first: u32) -> u32 {
    let center = points[p];
    let frame = frame_of(p);
    let seen = Seen(center.position, center.normal, record_of(p));
    let near_curves = is_near_curves(center.position, center.radius);
    let inverse = 1.0 / center.radius;
    var members = 0u;
    var walk = ball_walk(center.position, center.radius);
    for (var q = next_entry(&walk); q != NONE; q = next_entry(&walk)) {
        if !in_ball(center, p, q) {
            continue;
        }
        let normal = points[q].normal;
        let d = points[q].position - center.position;
        let d2 = dot3(d, d);
        let other = Seen(points[q].position, normal, record_of(q));
        let u = d * (1.0 / sqrt(d2));
        let is_consistent = consistent(u, center.normal, normal)
            && sees(seen, near_curves, center.radius, other);
        let x = dot3(d, frame.e1);
        let y = dot3(d, frame.e2);
        let q2 = x * x + y * y;
        if !is_consistent || q2 <= 1e-12 * d2 {
            continue;
        }
        var scale = inverse;
        if accurate {
            // The geodesic projection q' (eq. 9).
            scale = (geodesic_distance(d, center.normal, normal) * inverse) / sqrt(q2);
        }
        let flags = select(0u, REMOVED | DOUBTFUL, is_doubtful(u, center.normal, normal));
        arena[first + members] = vec4(q, bitcast<u32>(x * scale), bitcast<u32>(y * scale), p | flags);
        members += 1u;
    }
    return members;
}

/// Eq. 6, printed inverted: whether neither point lies in the cone of apex the other and axis n0 + n1.
fn consistent(u: vec3<f32>, n0: vec3<f32>, n1: vec3<f32>) -> bool {
    let cosine = dot3(n0, n1);
    let along = abs(dot3(n0 + n1, u));
    // The margin is for flat surfaces, where both sides are rounding.
    let bound = select(1.0 + cosine, NARROW * (1.0 + cosine) + 1e-6, narrow_cones);
    return along <= bound && !(opposite_pairs && cosine < OPPOSITE);
}

/// Whether a pair that passes is doubtful: a step between two sheets rather than a slope of one.
fn is_doubtful(u: vec3<f32>, n0: vec3<f32>, n1: vec3<f32>) -> bool {
    let along = abs(dot3(n0 + n1, u));
    let beyond = along > DOUBTFUL_SHARE * (1.0 + dot3(n0, n1)) + 1e-6;
    return sure_neighbors && natural_neighbors && beyond;
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
