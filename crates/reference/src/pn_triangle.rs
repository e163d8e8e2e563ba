//! Point-normal interpolation (section 3). Twin: `shaders/shared/pn_triangle.wgsl`.

use crate::math::{angle_between, unit};
use glam::Vec3;

pub use crate::new_normal::{BLEND, FAR, STEEP, STEP, STEP_BLEND, new_normal};

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
pub(crate) fn direction(n: Vec3) -> Vec3 {
    if n.dot(n) > FLAT { unit(n) } else { Vec3::ZERO }
}

/// Whether a direction is none.
#[inline(always)]
pub(crate) fn is_none(direction: Vec3) -> bool {
    direction.dot(direction) == 0.0
}

/// Normal at the centre of the PN triangle: the cross product of the two derivatives (section 3), whose leading
/// coefficient is 1 and not the printed 7. Zero for a triangle without area. `size` is a length of the order of the
/// edges: derivatives are taken in its units, so that no product leaves the range of f32.
#[inline(always)]
pub(crate) fn exact_normal(corners: [Corner; 3], size: f32) -> Vec3 {
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

/// Normal of the flat triangle, zero for one without area; `size` as in [`exact_normal`].
#[inline(always)]
pub(crate) fn facing([a, b, c]: [Corner; 3], size: f32) -> Vec3 {
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn on_sphere(x: f32, y: f32, z: f32) -> Corner {
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
    fn the_geodesic_distance_exceeds_the_chord_on_a_curved_surface() {
        let (a, b) = (on_sphere(1.0, 0.0, 0.0), on_sphere(0.0, 1.0, 0.0));
        let g = geodesic_distance(b.position - a.position, a.normal, b.normal);
        // Control polygon of a quarter circle: 1.4142 * 2/3 + the middle piece.
        assert!(g > 1.45 && g < 1.75, "{g}");
    }
}
