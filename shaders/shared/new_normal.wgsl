// Normals of new points, and triangles that have none. Twin: crates/reference/src/new_normal.rs
//
// Expects what pn_triangle.wgsl has.

/// Rules beyond the paper: see `Rules` in crates/points/src/params.rs.
override sliver_normals: bool = true;
override steep_faces: bool = true;
override step_normals: bool = true;

/// Cosine of 110°: a triangle is steep if its normal is farther from that of a corner.
const STEEP: f32 = -0.34202014;
/// Cosine of 15°, and one over its distance from the cosine of 5°: between them a normal blends from the
/// interpolated to the exact one.
const FAR: f32 = 0.9659258;
const BLEND: f32 = 33.03724;

/// Whether the flat triangle turns its back on one of its corners, where the rule holds. `size` as in center_cross.
fn is_steep(t: Triangle, size: f32) -> bool {
    if !steep_faces {
        return false;
    }
    let flat = flat_cross(t, size);
    if dot3(flat, flat) <= FLAT {
        return true;
    }
    let n = unit(flat);
    return dot3(n, t.a.normal) < STEEP || dot3(n, t.b.normal) < STEEP || dot3(n, t.c.normal) < STEEP;
}

/// Normal of a new point: that of the curved triangle, but where it is far from the quadratic normal of the corners
/// (Vlachos et al. 2001, section 3.3) the latter: in slivers the cross product keeps little but rounding. Zero for a
/// triangle without area.
fn new_normal(t: Triangle, size: f32) -> vec3<f32> {
    let cross = center_cross(t, size);
    if dot3(cross, cross) <= FLAT {
        return vec3(0.0);
    }
    let exact = unit(cross);
    if !sliver_normals {
        return exact;
    }
    let quadratic = quadratic_sum(t, size);
    if dot3(quadratic, quadratic) <= FLAT {
        return vec3(0.0);
    }
    let smooth_normal = unit(quadratic);
    let share = min(max((dot3(exact, smooth_normal) - FAR) * BLEND, 0.0), 1.0);
    return unit(exact * share + smooth_normal * (1.0 - share));
}

/// Normal at the centre of the quadratic patch of normals, of any length.
fn quadratic_sum(t: Triangle, size: f32) -> vec3<f32> {
    let corners = (t.a.normal + t.b.normal + t.c.normal) * 0.11111111;
    let edges = edge_normal(t.a, t.b, size) + edge_normal(t.b, t.c, size) + edge_normal(t.c, t.a, size);
    return corners + edges * 0.22222222;
}

/// From this share of the bound of eq. 6 on an edge is a step.
const STEP: f32 = 0.4;
/// One over the width of the range below it where an edge is both.
const STEP_BLEND: f32 = 5.0;

/// The mean of two normals, reflected across the plane that halves their edge; the steeper the step of an edge, the
/// less is reflected. Zero where they cancel.
fn edge_normal(a: Corner, b: Corner, size: f32) -> vec3<f32> {
    let sum = a.normal + b.normal;
    let u = (b.position - a.position) * (1.0 / size);
    let u2 = dot3(u, u);
    var reflected = sum;
    if u2 > 0.0 {
        let along = dot3(u, sum);
        let step = abs(along) / (sqrt(u2) * (1.0 + dot3(a.normal, b.normal)) + 1e-6);
        let blend = min(max((STEP - step) * STEP_BLEND, 0.0), 1.0);
        let share = select(1.0, blend, step_normals);
        reflected = sum - u * (2.0 * share * along / u2);
    }
    if dot3(reflected, reflected) <= FLAT {
        return vec3(0.0);
    }
    return unit(reflected);
}
