// candidates: the possible new points L_p of each fan (section 5, eq. 12). Twin: crates/reference/src/candidates.rs
// One invocation per point, or per new point on a crease or boundary where there are more.

@group(0) @binding(2) var<storage, read> points: array<Point>;
@group(0) @binding(3) var<storage, read> ring_starts: array<u32>;
@group(0) @binding(4) var<storage, read> ring_entries: array<vec2<u32>>;
/// Position, and ρ: the largest distance to the three corners, or -1 where the slot holds no candidate.
@group(0) @binding(5) var<storage, read_write> candidate_positions: array<vec4<f32>>;
/// Normal, and in every slot of a point the distance within which new points are its new neighbours.
@group(0) @binding(6) var<storage, read_write> candidate_normals: array<vec4<f32>>;
/// The point whose fan holds the slot; NONE for new points on creases and boundaries.
@group(0) @binding(7) var<storage, read_write> owners: array<u32>;
@group(0) @binding(8) var<storage, read_write> states: array<u32>;
@group(0) @binding(9) var<storage, read> curves: array<u32>;

/// Whether the simplifications of section 7 are made.
override simplified: bool = false;
/// Rules beyond the paper: see `Rules` in crates/points/src/params.rs.
override first_radii: bool = true;

/// Radii exceed the distance to the farthest natural neighbour by this factor.
const NATURAL: f32 = 1.25;

@compute @workgroup_size(64)
fn candidates(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let p = linear_index(id, groups);
    if params.fan_slots + p < params.slots {
        add_curve_point(params.fan_slots + p);
    }
    if p >= params.points {
        return;
    }
    let near = near_radius(p);
    for (var slot = ring_starts[p]; slot < ring_starts[p + 1u]; slot++) {
        owners[slot] = p;
        let exists = candidate(p, slot, near);
        states[slot] = select(NONE, FREE, exists);
        if !exists {
            candidate_positions[slot] = vec4(0.0, 0.0, 0.0, -1.0);
            candidate_normals[slot] = vec4(0.0, 0.0, 0.0, near);
        }
    }
}

/// Takes over a new point on a crease or boundary, which is inserted in any case.
fn add_curve_point(slot: u32) {
    let record = record_of_slot(slot);
    candidate_positions[slot] = vec4(record_position(record), record_rho(record));
    candidate_normals[slot] = vec4(record_normal(record), 0.0);
    owners[slot] = NONE;
    states[slot] = ON_CURVE;
}

/// Writes the candidate of a slot; false if there is none.
fn candidate(p: u32, slot: u32, near: f32) -> bool {
    let corners = fan_triangle(p, slot);
    if corners.x == NONE {
        return false;
    }
    let triangle = triangle_of(corners);
    var position: vec3<f32>;
    if simplified {
        position = center_of_gravity(triangle);
    } else {
        position = displaced_center(triangle);
    }
    let rho = reach(triangle, position);
    if rho == 0.0 {
        return false;
    }
    if is_steep(triangle, rho) {
        return false;
    }
    var normal: vec3<f32>;
    if simplified {
        // The triangle must have an area; its curved normal is taken when it is inserted.
        let cross = flat_cross(triangle, rho);
        if dot3(cross, cross) <= FLAT {
            return false;
        }
        normal = unit(cross);
    } else {
        normal = new_normal(triangle, rho);
        if dot3(normal, normal) == 0.0 {
            return false;
        }
    }
    candidate_positions[slot] = vec4(position, rho);
    candidate_normals[slot] = vec4(normal, near);
    return true;
}

/// λ1 r. The radii of the input may be too large, and would take far points for new neighbours: in the first step they
/// count as no more than NATURAL times the distance to the farthest neighbour.
fn near_radius(p: u32) -> f32 {
    let radius = points[p].radius;
    if !first_radii || ring_starts[p] == ring_starts[p + 1u] {
        return params.lambda1 * radius;
    }
    var farthest = 0.0;
    for (var slot = ring_starts[p]; slot < ring_starts[p + 1u]; slot++) {
        let d = points[ring_entries[slot].x].position - points[p].position;
        farthest = max(farthest, dot3(d, d));
    }
    // No branch: drivers may compile anew for every level where one depends on a uniform.
    return params.lambda1 * select(radius, min(radius, NATURAL * sqrt(farthest)), params.level == 1u);
}

fn curve_word(at: u32) -> u32 {
    return curves[at];
}
