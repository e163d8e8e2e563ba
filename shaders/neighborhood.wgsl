// neighborhood: the one-ring of each point (section 4). Twin: crates/reference/src/neighborhood.rs
// One invocation per point. dispatch: first point, number of points.
//
// A point takes as many arena entries as its Euclidean neighbourhood has members. If the arena is too small, nothing
// is written and the counters tell the host what to provide.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> grid: array<u32>;
/// Members of N^E: index, then bits of x, y and angle. In the end the ring comes first.
@group(0) @binding(4) var<storage, read_write> arena: array<vec4<u32>>;
/// First arena entry of each point.
@group(0) @binding(5) var<storage, read_write> blocks: array<u32>;
/// Size of each ring at the index after its point's.
@group(0) @binding(6) var<storage, read_write> ring_starts: array<u32>;
@group(0) @binding(7) var<storage, read_write> counters: Counters;

/// The accurate neighbourhood N^g, or else the fuzzy one N^f.
override accurate: bool = true;

const REMOVED: u32 = 1u;

@compute @workgroup_size(64)
fn neighborhood(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index >= dispatch.y {
        return;
    }
    let p = dispatch.x + index;
    let size = ball_size(p);
    let first = atomicAdd(&counters.arena, 4u * size) / 4u;
    atomicMax(&counters.arena_peak, 4u * (first + size));
    count_ball(size);
    ring_starts[p + 1u] = 0u;
    blocks[p] = first;
    if 4u * (first + size) > params.arena_words {
        return;
    }
    let members = consistent_ball(p, first);
    for (var i = first; i < first + members; i++) {
        arena[i].w = select(0u, REMOVED, badness(p, first, members, i) > 1.0 + 1e-3);
    }
    let ring = sort_ring(first, members);
    ring_starts[p + 1u] = ring;
    if ring == 0u {
        atomicAdd(&counters.isolated, 1u);
    }
}

fn count_ball(size: u32) {
    atomicMax(&counters.largest_ball, size);
    let before = atomicAdd(&counters.ball_low, size);
    if before + size < before {
        atomicAdd(&counters.ball_high, 1u);
    }
}

/// Whether q is in N^E (eq. 7): within the radius and not at the same place.
fn in_ball(center: Point, p: u32, q: u32) -> bool {
    let d = points[q].position - center.position;
    let d2 = dot3(d, d);
    return q != p && d2 <= center.radius * center.radius && d2 != 0.0;
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
    let frame = tangent_frame(center.normal);
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
        let u = d * (1.0 / sqrt(d2));
        let consistent = abs(dot3(center.normal + normal, u)) <= 1.0 + dot3(center.normal, normal);
        let x = dot3(d, frame.e1);
        let y = dot3(d, frame.e2);
        let q2 = x * x + y * y;
        if !consistent || q2 <= 1e-12 * d2 {
            continue;
        }
        var scale = inverse;
        if accurate {
            // The geodesic projection q' (eq. 9).
            scale = (geodesic_distance(d, center.normal, normal) * inverse) / sqrt(q2);
        }
        arena[first + members] = vec4(q, bitcast<u32>(x * scale), bitcast<u32>(y * scale), 0u);
        members += 1u;
    }
    return members;
}

/// The vector whose fuzzy plane is tested: q' - p for the accurate neighbourhood, p_i - p for the fuzzy one.
fn plane_vector(center: Point, i: u32) -> vec3<f32> {
    if accurate {
        return vec3(bitcast<f32>(arena[i].y), bitcast<f32>(arena[i].z), 0.0);
    }
    return (points[arena[i].x].position - center.position) * (1.0 / center.radius);
}

/// Badness w_i (eq. 8): how far member i lies behind its successors and predecessors.
/// The maximum is taken over signed squares of sin α_ij, which order the same and need no root per pair.
fn badness(p: u32, first: u32, members: u32, i: u32) -> f32 {
    let center = points[p];
    let own = plane_vector(center, i);
    let x = bitcast<f32>(arena[i].y);
    let y = bitcast<f32>(arena[i].z);
    var successor = -2.0;
    var predecessor = -2.0;
    for (var j = first; j < first + members; j++) {
        let other = plane_vector(center, j);
        let c = own - other;
        let product = dot3(other, other) * dot3(c, c);
        if i == j || product == 0.0 {
            continue;
        }
        let along = dot3(other, c);
        let sin_squared = along * abs(along) / product;
        // An exactly collinear point counts as successor.
        if x * bitcast<f32>(arena[j].z) - y * bitcast<f32>(arena[j].y) >= 0.0 {
            successor = max(successor, sin_squared);
        } else {
            predecessor = max(predecessor, sin_squared);
        }
    }
    return plane_badness(successor) + plane_badness(predecessor);
}

/// w_ij from the signed square of sin α_ij; 0 for an empty set, which passes -2.
fn plane_badness(sin_squared: f32) -> f32 {
    let root = sqrt(abs(sin_squared));
    let sine = select(root, -root, sin_squared < 0.0);
    if sine < -params.sin_theta_f {
        return 0.0;
    }
    return 0.5 * (sine / params.sin_theta_f + 1.0);
}

/// Sorts the members that are not removed to the front, by angle, distance and index; returns their number.
fn sort_ring(first: u32, members: u32) -> u32 {
    var size = 0u;
    for (var i = first; i < first + members; i++) {
        var member = arena[i];
        if member.w == REMOVED {
            continue;
        }
        member.w = bitcast<u32>(direction_angle(bitcast<f32>(member.z), bitcast<f32>(member.y)));
        var at = first + size;
        while at > first && comes_before(member, arena[at - 1u]) {
            arena[at] = arena[at - 1u];
            at -= 1u;
        }
        arena[at] = member;
        size += 1u;
    }
    return size;
}

fn comes_before(a: vec4<u32>, b: vec4<u32>) -> bool {
    let angle_a = bitcast<f32>(a.w);
    let angle_b = bitcast<f32>(b.w);
    if angle_a != angle_b {
        return angle_a < angle_b;
    }
    let ax = bitcast<f32>(a.y);
    let ay = bitcast<f32>(a.z);
    let bx = bitcast<f32>(b.y);
    let by = bitcast<f32>(b.z);
    let distance_a = ax * ax + ay * ay;
    let distance_b = bx * bx + by * by;
    if distance_a != distance_b {
        return distance_a < distance_b;
    }
    return a.x < b.x;
}
