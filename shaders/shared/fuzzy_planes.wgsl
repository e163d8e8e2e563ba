// Fuzzy planes (section 4.1, eq. 8). Twin: `is_behind` in crates/reference/src/neighborhood.rs

/// Largest badness of a neighbour: 1, and a margin because regular grids give exactly that.
const WORST_BADNESS: f32 = 1.001;

/// The largest signed squares of sin α_ij so far, over successors and over predecessors: they order as the sines do and
/// need no root per pair. An empty set has -2.
struct Badness {
    successor: f32,
    predecessor: f32,
}

/// Takes the fuzzy plane of another member into account; true once the badness is above 1, whatever comes after.
fn is_bad(badness: ptr<function, Badness>, own: vec3<f32>, other: vec3<f32>, succeeds: bool) -> bool {
    let c = own - other;
    let product = dot3(other, other) * dot3(c, c);
    if product == 0.0 {
        return false;
    }
    let along = dot3(other, c);
    let sin_squared = along * abs(along) / product;
    if sin_squared <= select((*badness).predecessor, (*badness).successor, succeeds) {
        return false;
    }
    (*badness).successor = select((*badness).successor, sin_squared, succeeds);
    (*badness).predecessor = select(sin_squared, (*badness).predecessor, succeeds);
    return plane_badness((*badness).successor) + plane_badness((*badness).predecessor) > WORST_BADNESS;
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
