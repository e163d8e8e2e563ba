// Fuzzy planes (section 4.1, eq. 8). Twin: crates/reference/src/fuzzy_planes.rs
//
// Expects `accurate`, `is_left_out`, MOST, and rows X, Y and HEIGHT of the members, as neighborhood.wgsl has them.

/// Largest badness of a neighbour: 1, and a margin because regular grids give exactly that.
const WORST_BADNESS: f32 = 1.001;
/// Members over which the loop has a constant length: drivers unroll it, and private rows at
/// constant places cost them little.
const UNROLLED: u32 = MOST * u32(!IN_ARENA);

/// Whether the badness w_i (eq. 8) of member i is above 1: it lies behind its successors and predecessors.
///
/// The maximum is taken over signed squares of sin α_ij, which order the same and need no root per
/// pair. An empty set has -2.
fn is_behind(i: u32, members: u32) -> bool {
    let own = OnPlane(number(X, i), number(Y, i), plane_vector(i));
    var sines = vec2(-2.0);
    for (var j = 0u; j < UNROLLED; j++) {
        sines = with_plane(sines, own, j, i != j & j < members);
    }
    for (var j = UNROLLED; j < members; j++) {
        sines = with_plane(sines, own, j, i != j);
        // Both only rise. Among few it costs more to look than to go on.
        if IN_ARENA && is_worst(sines) {
            return true;
        }
    }
    return is_worst(sines);
}

/// A member on the tangent plane, and its vector.
struct OnPlane {
    x: f32,
    y: f32,
    vector: vec3<f32>,
}

/// The squares of the largest sines to successors and predecessors, after that to member j, if it is one.
fn with_plane(sines: vec2<f32>, own: OnPlane, j: u32, is_member: bool) -> vec2<f32> {
    let other = plane_vector(j);
    let c = own.vector - other;
    let product = dot3(other, other) * dot3(c, c);
    let along = dot3(other, c);
    let squared = along * abs(along) / product;
    let takes_part = is_member & !is_left_out(j) & product != 0.0;
    // An exactly collinear point counts as successor.
    let succeeds = own.x * number(Y, j) - own.y * number(X, j) >= 0.0;
    return select(sines, vec2(squared), vec2(takes_part) & vec2(succeeds, !succeeds) & vec2(squared) > sines);
}

fn is_worst(sines: vec2<f32>) -> bool {
    return plane_badness(sines.x) + plane_badness(sines.y) > WORST_BADNESS;
}

/// The vector whose fuzzy plane is tested, in the frame of the tangent plane: q' - p for the accurate neighbourhood,
/// p_i - p for the fuzzy one.
fn plane_vector(i: u32) -> vec3<f32> {
    if accurate {
        return vec3(number(X, i), number(Y, i), 0.0);
    }
    return vec3(number(X, i), number(Y, i), number(HEIGHT, i));
}

/// w_ij from the signed square of sin α_ij; 0 for an empty set.
fn plane_badness(sin_squared: f32) -> f32 {
    let root = sqrt(abs(sin_squared));
    let sine = select(root, -root, sin_squared < 0.0);
    if sine < -params.sin_theta_f {
        return 0.0;
    }
    return 0.5 * (sine / params.sin_theta_f + 1.0);
}
