// commit: appends the inserted candidates to the cloud, by (creator, slot), and gives old points their new radii.
// Twin: crates/reference/src/commit.rs
// One invocation per slot, or per point where there are more. dispatch: new points before this step.

@group(0) @binding(2) var<storage, read_write> points: array<Point>;
@group(0) @binding(3) var<storage, read> ring_starts: array<u32>;
@group(0) @binding(4) var<storage, read> ring_entries: array<vec2<u32>>;
@group(0) @binding(5) var<storage, read> candidate_positions: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> candidate_normals: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read> owners: array<u32>;
/// Number of inserted candidates before each slot, and one more.
@group(0) @binding(8) var<storage, read> new_indices: array<u32>;
@group(0) @binding(9) var<storage, read> next_radii: array<u32>;
/// Three corners of each new point's triangle.
@group(0) @binding(10) var<storage, read_write> parents: array<u32>;
@group(0) @binding(11) var<storage, read> curves: array<u32>;

/// Whether the simplifications of section 7 are made.
override simplified: bool = false;

@compute @workgroup_size(64)
fn commit(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = linear_index(id, groups);
    if index < params.points {
        points[index].radius = next_radius(index);
    }
    if index < params.slots && new_indices[index + 1u] != new_indices[index] {
        append_point(index, new_indices[index]);
    }
}

/// The larger of what the insertion and the next ring ask for.
fn next_radius(index: u32) -> f32 {
    return bitcast<f32>(max(next_radii[index], next_radii[params.points + params.slots + index]));
}

fn append_point(slot: u32, rank: u32) {
    if owners[slot] == NONE {
        append_curve_point(slot, rank);
        return;
    }
    let corners = fan_triangle(owners[slot], slot);
    var position = candidate_positions[slot].xyz;
    var normal = candidate_normals[slot].xyz;
    if simplified {
        // Section 7, simplification 4: the displacement is computed for inserted points only.
        let triangle = triangle_of(corners);
        position = displaced_center(triangle);
        let curved = new_normal(triangle, candidate_positions[slot].w);
        // Else it stays that of the flat triangle.
        if dot3(curved, curved) > 0.0 {
            normal = curved;
        }
    }
    let radius = next_radius(params.points + slot);
    points[params.points + rank] = Point(position, radius, normal, params.level);
    set_parents(rank, corners);
}

/// A new point on a crease or boundary has the ends of its segment as corners, the nearer one twice.
fn append_curve_point(slot: u32, rank: u32) {
    let record = record_of_slot(slot);
    let radius = max(next_radius(params.points + slot), record_radius(record));
    let level = params.level | ((record + 1u) << LEVEL_BITS);
    points[params.points + rank] = Point(record_position(record), radius, record_normal(record), level);
    let ends = record_ends(record);
    set_parents(rank, ends.xxy);
}

fn set_parents(rank: u32, corners: vec3<u32>) {
    let first = 3u * (dispatch.x + rank);
    parents[first] = corners.x;
    parents[first + 1u] = corners.y;
    parents[first + 2u] = corners.z;
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
