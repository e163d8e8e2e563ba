// candidates: the possible new points of all fans (section 5, eq. 12).
// Twins: crates/reference/src/candidates.rs, of one triangle crates/reference/src/triangles.rs
// One invocation per candidate. Those of triangles come first, then the new points on creases and boundaries.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> fans: array<Fan>;
@group(0) @binding(4) var<storage, read_write> all: array<Candidate>;
@group(0) @binding(5) var<storage, read_write> counters: Counters;
@group(0) @binding(6) var<storage, read> curves: array<u32>;

/// A rule beyond the paper: see `Rules` in crates/points/src/params.rs.
override largest_first: bool = true;
/// Whether sizes are ρ.
override simplified: bool = false;

const THIRD: f32 = 1.0 / 3.0;

@compute @workgroup_size(64)
fn candidates(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let c = linear_index(id, groups);
    if c >= params.candidates {
        return;
    }
    if c >= params.triangles {
        add_curve_point(c);
        note_rho(record_rho(record_of_candidate(c)));
        return;
    }
    all[c].state = FREE;
    if !add_candidate(c) {
        all[c].place = vec4(0.0, 0.0, 0.0, -1.0);
        all[c].normal = vec3(0.0);
        all[c].size = 0.0;
    }
}

/// Notes the largest ρ, for the paper's loop. Most are no larger than what is known: to look costs less than to write.
fn note_rho(rho: f32) {
    if !largest_first && bitcast<u32>(rho) > atomicLoad(&counters.widest) {
        atomicMax(&counters.widest, bitcast<u32>(rho));
    }
}

/// Takes over a new point on a crease or boundary, which is inserted in any case. It has the ends of its segment as
/// corners, the nearer one twice.
fn add_curve_point(c: u32) {
    let record = record_of_candidate(c);
    let ends = record_ends(record);
    all[c].corners = ends.xxy;
    all[c].place = vec4(record_position(record), record_rho(record));
    all[c].normal = record_normal(record);
    all[c].state = ON_CURVE;
    all[c].size = record_rho(record);
}

/// Writes the candidate of a triangle; false if there is none.
fn add_candidate(c: u32) -> bool {
    let triangle = triangle_of(all[c].corners);
    let position = displaced_center(triangle);
    let rho = reach(triangle, position);
    if rho == 0.0 || is_steep(triangle, rho) {
        return false;
    }
    let normal = new_normal(triangle, rho);
    if dot3(normal, normal) == 0.0 {
        return false;
    }
    all[c].place = vec4(position, rho);
    all[c].normal = normal;
    all[c].size = size_of(all[c].corners, rho);
    note_rho(rho);
    return true;
}

/// The size of a triangle. Where neighbours are unevenly far, it counts as large as the neighbourhoods of its
/// corners, but if simplified.
fn size_of(corners: vec3<u32>, rho: f32) -> f32 {
    if !largest_first || simplified {
        return rho;
    }
    let near = fans[corners.x].near + fans[corners.y].near + fans[corners.z].near;
    return max(rho, near * THIRD);
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
