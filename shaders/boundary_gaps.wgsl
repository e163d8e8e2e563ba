// boundary: the points whose ring leaves a gap wider than θ_b (section 6), in any order: the host sorts them.
// Twin: `Gap::widest` in crates/features/src/boundary.rs
// One invocation per point. dispatch: bits of θ_b, room in the list.

@group(0) @binding(2) var<storage, read> fans: array<Fan>;
@group(0) @binding(3) var<storage, read> ring_entries: array<vec2<u32>>;
/// The point, the ring's members where the gap begins and ends, bits of its angle.
@group(0) @binding(4) var<storage, read_write> gaps: array<vec4<u32>>;
/// Number of such points.
@group(0) @binding(5) var<storage, read_write> gap_count: atomic<u32>;

/// Gaps of triangles are narrower: π less what rounding may take.
const STRAIGHT: f32 = 3.1412785;

@compute @workgroup_size(64)
fn boundary_gaps(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if p >= params.points {
        return;
    }
    let first = fans[p].slots.x;
    let after = first + fans[p].slots.y;
    if after - first < 2u {
        return;
    }
    var widest = -1.0;
    var narrowest = TAU;
    var begin = 0u;
    var end = 0u;
    for (var i = first; i < after; i++) {
        let last = i + 1u == after;
        let from_entry = ring_entries[i];
        let to_entry = ring_entries[select(i + 1u, first, last)];
        let to = bitcast<f32>(to_entry.y);
        let angle = select(to, to + TAU, last) - bitcast<f32>(from_entry.y);
        narrowest = min(narrowest, angle);
        if angle > widest {
            widest = angle;
            begin = from_entry.x;
            end = to_entry.x;
        }
    }
    // A line of points has no boundary.
    if widest > bitcast<f32>(dispatch.x) && narrowest < STRAIGHT {
        let at = atomicAdd(&gap_count, 1u);
        if at < dispatch.y {
            gaps[at] = vec4(p, begin, end, bitcast<u32>(widest));
        }
    }
}
