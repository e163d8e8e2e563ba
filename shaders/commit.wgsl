// commit: appends the inserted candidates to the cloud, in their order, and gives old points their new radii.
// Twin: crates/reference/src/commit.rs
// One invocation per candidate, or per point where there are more. dispatch: new points before this step.

@group(0) @binding(2) var<storage, read_write> points: array<Point>;
@group(0) @binding(3) var<storage, read> candidates: array<Candidate>;
/// Number of inserted candidates before each one, and one more.
@group(0) @binding(4) var<storage, read> new_indices: array<u32>;
/// Bits of the radii at the next level: of the points, then of the candidates, then what next rings ask of the points.
@group(0) @binding(5) var<storage, read> next_radii: array<u32>;
/// Three corners of each new point's triangle.
@group(0) @binding(6) var<storage, read_write> parents: array<u32>;
@group(0) @binding(7) var<storage, read> curves: array<u32>;

@compute @workgroup_size(64)
fn commit(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index < params.points {
        let covered = next_radii[params.points + params.candidates + index];
        points[index].radius = bitcast<f32>(max(next_radii[index], covered));
    }
    if index < params.candidates && new_indices[index + 1u] != new_indices[index] {
        append_point(index, new_indices[index]);
    }
}

fn append_point(c: u32, rank: u32) {
    var radius = bitcast<f32>(next_radii[params.points + c]);
    var level = params.level;
    let record = record_of_candidate(c);
    if with_curves && record != NONE {
        radius = max(radius, record_radius(record));
        level |= (record + 1u) << LEVEL_BITS;
    }
    points[params.points + rank] = Point(candidates[c].place.xyz, radius, candidates[c].normal, level);
    let corners = candidates[c].corners;
    let first = 3u * (dispatch.x + rank);
    parents[first] = corners.x;
    parents[first + 1u] = corners.y;
    parents[first + 2u] = corners.z;
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
