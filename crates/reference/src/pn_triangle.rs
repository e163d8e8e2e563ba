//! Point-normal interpolation (section 3). Twins: `pn_triangle.wgsl` and `new_normal.wgsl` in `shaders/shared`.

use crate::math::{angle_between, unit};
use glam::Vec3;
use surfine_points::Rules;

/// A point with its normal: a corner of a PN triangle.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Position.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

/// Below this squared cross product of the derivatives, in units of the triangle's own size, a triangle has no normal.
pub const FLAT: f32 = 1e-12;

/// `b_210 - p_0` (eq. 2): a third of the edge `d` leaving a corner of normal `n`, turned into the tangent plane there
/// with its length kept. Zero if the edge is along the normal.
#[inline(always)]
pub fn tangent(d: Vec3, n: Vec3) -> Vec3 {
    let d2 = d.dot(d);
    let projected = d - n * d.dot(n);
    let p2 = projected.dot(projected);
    // The factor keeps the quotient meaningful: below it only rounding is left of the projection.
    if p2 <= 1e-12 * d2 {
        return Vec3::ZERO;
    }
    projected * ((d2.sqrt() / p2.sqrt()) * 0.333_333_34)
}

/// Geodesic distance (eq. 4) over the edge `d` from a point of normal `n0` to one of normal `n1`.
#[inline(always)]
pub fn geodesic_distance(d: Vec3, n0: Vec3, n1: Vec3) -> f32 {
    let middle = (d + tangent(-d, n1)) - tangent(d, n0);
    0.666_666_7 * d.dot(d).sqrt() + middle.dot(middle).sqrt()
}

/// Curved angle (eq. 5) at the origin between two points with normals, given relative to it.
#[inline(always)]
pub fn curved_angle(a: Corner, b: Corner) -> f32 {
    let d = b.position - a.position;
    let b210 = a.position + tangent(d, a.normal);
    let b120 = b.position + tangent(-d, b.normal);
    angle_between(a.position, b210) + angle_between(b210, b120) + angle_between(b120, b.position)
}

/// The six tangent vectors of a triangle and two of its edges (figure 2).
struct ControlPolygon {
    d1: Vec3,
    d2: Vec3,
    t01: Vec3,
    t10: Vec3,
    t12: Vec3,
    t21: Vec3,
    t20: Vec3,
    t02: Vec3,
}

#[inline(always)]
fn control_polygon([a, b, c]: [Corner; 3]) -> ControlPolygon {
    let d1 = b.position - a.position;
    let d2 = c.position - a.position;
    let d12 = c.position - b.position;
    ControlPolygon {
        d1,
        d2,
        t01: tangent(d1, a.normal),
        t10: tangent(-d1, b.normal),
        t12: tangent(d12, b.normal),
        t21: tangent(-d12, c.normal),
        t20: tangent(-d2, c.normal),
        t02: tangent(d2, a.normal),
    }
}

/// Centre of gravity of a triangle.
#[inline(always)]
pub fn center_of_gravity([a, b, c]: [Corner; 3]) -> Vec3 {
    a.position + ((b.position - a.position) + (c.position - a.position)) * 0.333_333_34
}

/// The centre of gravity displaced by the smoothing operator φ (eq. 3).
#[inline(always)]
pub fn displaced_center(corners: [Corner; 3]) -> Vec3 {
    let t = control_polygon(corners);
    let phi = (t.t01 + t.t10 + t.t12 + t.t21 + t.t20 + t.t02) * 0.166_666_67;
    corners[0].position + ((t.d1 + t.d2) * 0.333_333_34 + phi)
}

/// The unit vector along a vector; zero for one of no length, which has no direction.
#[inline(always)]
fn direction(n: Vec3) -> Vec3 {
    if n.dot(n) > FLAT { unit(n) } else { Vec3::ZERO }
}

/// Whether a direction is none.
#[inline(always)]
fn is_none(direction: Vec3) -> bool {
    direction.dot(direction) == 0.0
}

/// Normal at the centre of the PN triangle: the cross product of the two derivatives (section 3), whose leading
/// coefficient is 1 and not the printed 7. Zero for a triangle without area. `size` is a length of the order of the
/// edges: derivatives are taken in its units, so that no product leaves the range of f32.
#[inline(always)]
fn exact_normal(corners: [Corner; 3], size: f32) -> Vec3 {
    let t = control_polygon(corners);
    // Control points relative to the first corner.
    let b210 = t.t01;
    let b120 = t.d1 + t.t10;
    let b021 = t.d1 + t.t12;
    let b201 = t.t02;
    let b102 = t.d2 + t.t20;
    let b012 = t.d2 + t.t21;
    let inverse = 1.0 / size;
    let bu = (((((t.d1 + b120) - b102) + b012) - b210) + (b021 - b201) * 2.0) * inverse;
    let bv = (((((t.d2 + b102) - b120) + b021) - b201) + (b012 - b210) * 2.0) * inverse;
    direction(bu.cross(bv))
}

/// Cosine of 110°: a triangle is steep if its normal is farther from that of a corner.
pub const STEEP: f32 = -0.342_020_14;

/// Whether the flat triangle turns its back on one of its corners. `size` as in [`exact_normal`].
#[inline(always)]
fn is_steep(corners: [Corner; 3], size: f32) -> bool {
    let n = facing(corners, size);
    let [a, b, c] = corners.map(|corner| n.dot(corner.normal) < STEEP);
    // Without the short cuts of `||` many triangles can be asked at once.
    is_none(n) | a | b | c
}

/// Normal of a new point, `None` for a triangle that has none. `size` is a length of the order of the edges.
pub fn new_normal(corners: [Corner; 3], size: f32, rules: Rules) -> Option<Vec3> {
    let normal = if rules.sliver_normals {
        safe_normal(corners, size, rules)
    } else {
        exact_normal(corners, size)
    };
    (!is_none(normal)).then_some(normal)
}

/// Cosine of 15°: a normal that is farther from the interpolated one is replaced by it; from there to 5° they blend.
pub const FAR: f32 = 0.965_925_8;
/// One over the difference of the cosines of 5° and 15°.
pub const BLEND: f32 = 33.037_24;

/// [`exact_normal`], but where that is far from the quadratic normal of the corners (Vlachos et al. 2001, section 3.3)
/// the latter: in slivers the cross product keeps little but rounding. Zero where there is none.
#[inline(always)]
fn safe_normal(corners: [Corner; 3], size: f32, rules: Rules) -> Vec3 {
    let exact = exact_normal(corners, size);
    let smooth = quadratic_normal(corners, size, rules);
    let t = ((exact.dot(smooth) - FAR) * BLEND).clamp(0.0, 1.0);
    let blend = unit(exact * t + smooth * (1.0 - t));
    if is_none(exact) | is_none(smooth) { Vec3::ZERO } else { blend }
}

/// Normal at the centre of the quadratic patch of normals; zero where those of the corners cancel.
#[inline(always)]
fn quadratic_normal([a, b, c]: [Corner; 3], size: f32, rules: Rules) -> Vec3 {
    let corners = (a.normal + b.normal + c.normal) * 0.111_111_11;
    let edge = |a, b| edge_normal(a, b, size, rules);
    let edges = edge(a, b) + edge(b, c) + edge(c, a);
    direction(corners + edges * 0.222_222_22)
}

/// From this share of the bound of eq. 6 on an edge is a step.
pub const STEP: f32 = 0.4;
/// One over the width of the range below it where an edge is both.
pub const STEP_BLEND: f32 = 5.0;

/// The mean of two normals, reflected across the plane that halves their edge; zero where they cancel.
///
/// Normals that both lean the same way along the edge make a step, and the reflection turns by as much to the other way.
/// That is right for a slope of one sheet; where two sheets were joined for want of samples it makes normals that fit
/// neither. So the steeper the step, the less is reflected.
#[inline(always)]
fn edge_normal(a: Corner, b: Corner, size: f32, rules: Rules) -> Vec3 {
    let sum = a.normal + b.normal;
    let u = (b.position - a.position) * (1.0 / size);
    let u2 = u.dot(u);
    let along = u.dot(sum);
    let step = along.abs() / (u2.sqrt() * (1.0 + a.normal.dot(b.normal)) + 1e-6);
    let blend = ((STEP - step) * STEP_BLEND).clamp(0.0, 1.0);
    let share = if rules.step_normals { blend } else { 1.0 };
    let reflected = sum - u * (2.0 * share * along / u2);
    direction(if u2 > 0.0 { reflected } else { sum })
}

/// Normal of the flat triangle, zero for one without area; `size` as in [`exact_normal`].
#[inline(always)]
fn facing([a, b, c]: [Corner; 3], size: f32) -> Vec3 {
    let inverse = 1.0 / size;
    direction(((b.position - a.position) * inverse).cross((c.position - a.position) * inverse))
}

/// Largest distance from `x` to the three corners.
#[inline(always)]
pub fn reach(corners: [Corner; 3], x: Vec3) -> f32 {
    let squared = |c: Corner| {
        let d = c.position - x;
        d.dot(d)
    };
    squared(corners[0]).max(squared(corners[1])).max(squared(corners[2])).sqrt()
}

/// Position, normal and ρ of a new point (section 5). The third is -1 where a triangle has none: if it has no area, or is steep.
pub(crate) type NewPoint = (Vec3, Vec3, f32);

/// The new point of a triangle.
#[inline(always)]
pub(crate) fn new_point(corners: [Corner; 3], rules: Rules) -> NewPoint {
    let position = displaced_center(corners);
    let rho = reach(corners, position);
    let normal = safe_normal(corners, rho, rules);
    let is_steep = rules.steep_faces & is_steep(corners, rho);
    checked(position, normal, rho, is_steep)
}

/// [`new_point`] without the rule for slivers.
#[inline(always)]
pub(crate) fn literal_point(corners: [Corner; 3], rules: Rules) -> NewPoint {
    let position = displaced_center(corners);
    let rho = reach(corners, position);
    let is_steep = rules.steep_faces & is_steep(corners, rho);
    checked(position, exact_normal(corners, rho), rho, is_steep)
}

#[inline(always)]
fn checked(position: Vec3, normal: Vec3, rho: f32, is_steep: bool) -> NewPoint {
    let fails = (rho == 0.0) | is_none(normal) | is_steep;
    if fails { (Vec3::ZERO, Vec3::ZERO, -1.0) } else { (position, normal, rho) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on_sphere(x: f32, y: f32, z: f32) -> Corner {
        let n = Vec3::new(x, y, z).normalize();
        Corner { position: n, normal: n }
    }

    #[test]
    fn a_flat_triangle_is_not_displaced() {
        let corner = |x, y| Corner { position: Vec3::new(x, y, 0.0), normal: Vec3::Z };
        let triangle = [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0)];
        assert!((displaced_center(triangle) - center_of_gravity(triangle)).length() < 1e-7);
        assert!((exact_normal(triangle, 1.0) - Vec3::Z).length() < 1e-6);
    }

    #[test]
    fn a_spherical_triangle_lands_on_the_sphere_with_its_normal() {
        let triangle =
            [on_sphere(1.0, 0.1, 0.0), on_sphere(1.0, -0.1, 0.15), on_sphere(1.0, -0.1, -0.15)];
        let x = displaced_center(triangle);
        let (flat, curved) = (1.0 - center_of_gravity(triangle).length(), 1.0 - x.length());
        assert!(curved.abs() < flat / 100.0, "distance {curved}, of the flat triangle {flat}");
        // The printed coefficient 7 turns this normal by a multiple of the bound.
        let normal = exact_normal(triangle, 0.2);
        let outward = if normal.dot(x) < 0.0 { -normal } else { normal };
        assert!(angle_between(outward, x).to_degrees() < 0.02);
    }

    #[test]
    fn slivers_with_noisy_normals_keep_sound_ones() {
        // Corners almost in a line, and normals three degrees off in all ways, as earlier slivers leave them.
        let (mut exact, mut sound) = (0.0f32, 0.0f32);
        for signs in 0..64u32 {
            let tilt = |bit: u32| if signs >> bit & 1 == 1 { 0.05 } else { -0.05 };
            let corner = |y, z, bit| {
                let Corner { position, normal } = on_sphere(1.0, y, z);
                Corner { position, normal: unit(normal + Vec3::new(0.0, tilt(bit), tilt(bit + 1))) }
            };
            let triangle = [corner(-0.1, 0.0, 0), corner(0.1, 0.0, 2), corner(0.0, 0.01, 4)];
            let off =
                |n: Option<Vec3>| angle_between(n.expect("it has an area"), Vec3::X).to_degrees();
            exact = exact.max(off(new_normal(triangle, 0.1, Rules::LITERAL)));
            sound = sound.max(off(new_normal(triangle, 0.1, Rules::ALL)));
        }
        assert!(exact > 15.0 && sound < 6.0, "{exact} degrees by the text, else {sound}");
    }

    #[test]
    fn a_triangle_that_turns_its_back_on_a_corner_is_steep() {
        let corner = |x, y, n| Corner { position: Vec3::new(x, y, 0.0), normal: n };
        let at =
            |n: Vec3| [corner(0.0, 0.0, Vec3::Z), corner(1.0, 0.0, Vec3::Z), corner(0.0, 1.0, n)];
        let turned = |degrees: f32| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            is_steep(at(Vec3::new(sin, 0.0, cos)), 1.0)
        };
        assert!(!turned(0.0) && !turned(109.0) && turned(111.0) && turned(180.0));
    }

    #[test]
    fn a_triangle_without_area_has_no_normal() {
        let corner = |x| Corner { position: Vec3::new(x, 0.0, 0.0), normal: Vec3::Z };
        let triangle = [corner(0.0), corner(1.0), corner(3.0)];
        assert_eq!(new_normal(triangle, 1.0, Rules::LITERAL), None);
    }

    #[test]
    fn the_geodesic_distance_exceeds_the_chord_on_a_curved_surface() {
        let (a, b) = (on_sphere(1.0, 0.0, 0.0), on_sphere(0.0, 1.0, 0.0));
        let g = geodesic_distance(b.position - a.position, a.normal, b.normal);
        // Control polygon of a quarter circle: 1.4142 * 2/3 + the middle piece.
        assert!(g > 1.45 && g < 1.75, "{g}");
    }
}
