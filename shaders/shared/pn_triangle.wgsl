// Point-normal interpolation (section 3). Twin: crates/reference/src/pn_triangle.rs

/// Below this squared cross product, in units of the triangle's own size, a triangle has no normal.
const FLAT: f32 = 1e-12;

struct Corner {
    position: vec3<f32>,
    normal: vec3<f32>,
}

struct Triangle {
    a: Corner,
    b: Corner,
    c: Corner,
}

/// b_210 - p_0 (eq. 2): a third of the edge d leaving a corner of normal n, turned into the tangent plane there with
/// its length kept. Zero if the edge is along the normal.
fn tangent(d: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    let d2 = dot3(d, d);
    let projected = d - n * dot3(d, n);
    let p2 = dot3(projected, projected);
    if p2 <= 1e-12 * d2 {
        return vec3(0.0);
    }
    return projected * ((sqrt(d2) / sqrt(p2)) * 0.33333334);
}

/// Geodesic distance (eq. 4) over the edge d from a point of normal n0 to one of normal n1.
fn geodesic_distance(d: vec3<f32>, n0: vec3<f32>, n1: vec3<f32>) -> f32 {
    let middle = (d + tangent(-d, n1)) - tangent(d, n0);
    return 0.6666667 * sqrt(dot3(d, d)) + sqrt(dot3(middle, middle));
}

/// Curved angle (eq. 5) at the origin between two points with normals, given relative to it.
fn curved_angle(a: Corner, b: Corner) -> f32 {
    let d = b.position - a.position;
    let b210 = a.position + tangent(d, a.normal);
    let b120 = b.position + tangent(-d, b.normal);
    return angle_between(a.position, b210) + angle_between(b210, b120) + angle_between(b120, b.position);
}

/// The six tangent vectors of a triangle and two of its edges (figure 2).
struct ControlPolygon {
    d1: vec3<f32>,
    d2: vec3<f32>,
    t01: vec3<f32>,
    t10: vec3<f32>,
    t12: vec3<f32>,
    t21: vec3<f32>,
    t20: vec3<f32>,
    t02: vec3<f32>,
}

fn control_polygon(t: Triangle) -> ControlPolygon {
    let d1 = t.b.position - t.a.position;
    let d2 = t.c.position - t.a.position;
    let d12 = t.c.position - t.b.position;
    return ControlPolygon(
        d1,
        d2,
        tangent(d1, t.a.normal),
        tangent(-d1, t.b.normal),
        tangent(d12, t.b.normal),
        tangent(-d12, t.c.normal),
        tangent(-d2, t.c.normal),
        tangent(d2, t.a.normal),
    );
}

/// The centre of gravity displaced by the smoothing operator φ (eq. 3).
fn displaced_center(t: Triangle) -> vec3<f32> {
    let p = control_polygon(t);
    let phi = (p.t01 + p.t10 + p.t12 + p.t21 + p.t20 + p.t02) * 0.16666667;
    return t.a.position + ((p.d1 + p.d2) * 0.33333334 + phi);
}

/// Cross product of the two derivatives at the centre (section 3; their leading coefficient is 1, not the printed 7),
/// in units of the length `size`.
fn center_cross(t: Triangle, size: f32) -> vec3<f32> {
    let p = control_polygon(t);
    // Control points relative to the first corner.
    let b210 = p.t01;
    let b120 = p.d1 + p.t10;
    let b021 = p.d1 + p.t12;
    let b201 = p.t02;
    let b102 = p.d2 + p.t20;
    let b012 = p.d2 + p.t21;
    let inverse = 1.0 / size;
    let bu = (((((p.d1 + b120) - b102) + b012) - b210) + (b021 - b201) * 2.0) * inverse;
    let bv = (((((p.d2 + b102) - b120) + b021) - b201) + (b012 - b210) * 2.0) * inverse;
    return cross3(bu, bv);
}

/// The same for the flat triangle.
fn flat_cross(t: Triangle, size: f32) -> vec3<f32> {
    let inverse = 1.0 / size;
    return cross3((t.b.position - t.a.position) * inverse, (t.c.position - t.a.position) * inverse);
}

fn squared_distance(c: Corner, x: vec3<f32>) -> f32 {
    let d = c.position - x;
    return dot3(d, d);
}

/// Largest distance from x to the three corners.
fn reach(t: Triangle, x: vec3<f32>) -> f32 {
    return sqrt(max(max(squared_distance(t.a, x), squared_distance(t.b, x)), squared_distance(t.c, x)));
}
