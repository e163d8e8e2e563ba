// Vectors and angles. Twin: crates/points/src/math.rs
//
// Only + - * / and square roots, in the twin's order: drivers differ in normalize, acos and atan2.

const TAU: f32 = 6.2831855;
const PI: f32 = 3.1415927;
const HALF_PI: f32 = 1.5707964;

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn cross3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
}

/// v with length 1; the zero vector must be kept away by the caller.
fn unit(v: vec3<f32>) -> vec3<f32> {
    return v * (1.0 / sqrt(dot3(v, v)));
}

/// Whether points at this squared distance have a direction to each other, seen at the scale of a radius. Nearer ones
/// count as being in one place.
fn is_apart(squared_distance: f32, radius: f32) -> bool {
    return squared_distance > one_place(radius);
}

/// The largest squared distance at which points count as being in one place.
fn one_place(radius: f32) -> f32 {
    return radius * radius * 1e-12;
}

/// Two unit vectors that span the plane of normal n, counter-clockwise seen from outside.
struct TangentFrame {
    e1: vec3<f32>,
    e2: vec3<f32>,
}

fn tangent_frame(n: vec3<f32>) -> TangentFrame {
    let a = abs(n);
    // The axis farthest from n.
    var axis = vec3(0.0, 0.0, 1.0);
    if a.x <= a.y && a.x <= a.z {
        axis = vec3(1.0, 0.0, 0.0);
    } else if a.y <= a.z {
        axis = vec3(0.0, 1.0, 0.0);
    }
    let e1 = unit(cross3(n, axis));
    return TangentFrame(e1, cross3(n, e1));
}

/// Arc tangent for t in [0, 1], after Cephes' atanf: within 2e-7.
fn atan_unit(t: f32) -> f32 {
    let upper = t > 0.41421357;
    var x = t;
    if upper {
        x = (t - 1.0) / (t + 1.0);
    }
    let z = x * x;
    let p = ((0.080537446 * z - 0.13877685) * z + 0.19977711) * z - 0.3333295;
    let a = p * z * x + x;
    return select(a, a + 0.7853982, upper);
}

/// Angle of the direction (x, y) in [0, 2π], counter-clockwise from the x axis; 0 for the zero vector.
fn direction_angle(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let longer = max(ax, ay);
    if longer == 0.0 {
        return 0.0;
    }
    var a = atan_unit(min(ax, ay) / longer);
    if ay > ax {
        a = HALF_PI - a;
    }
    if x < 0.0 {
        a = PI - a;
    }
    if y < 0.0 {
        a = TAU - a;
    }
    return a;
}

/// Angle between two vectors in [0, π]; 0 if one is zero.
fn angle_between(u: vec3<f32>, v: vec3<f32>) -> f32 {
    let c = cross3(u, v);
    return direction_angle(sqrt(dot3(c, c)), dot3(u, v));
}
