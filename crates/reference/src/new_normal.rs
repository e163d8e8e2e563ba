//! Normals of new points, and triangles that turn their back on a corner. Twin: `shaders/shared/new_normal.wgsl`.

use crate::math::unit;
use crate::pn_triangle::{Corner, direction, exact_normal, facing, is_none};
use glam::Vec3;
use surfine_points::Rules;

/// Cosine of 110°: a triangle is steep if its normal is farther from that of a corner.
pub const STEEP: f32 = -0.342_020_14;

/// Whether the flat triangle turns its back on one of its corners. `size` as in [`exact_normal`].
#[inline(always)]
pub(crate) fn is_steep(corners: [Corner; 3], size: f32) -> bool {
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
pub(crate) fn safe_normal(corners: [Corner; 3], size: f32, rules: Rules) -> Vec3 {
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
/// Normals that both lean the same way along the edge make a step, and the reflection turns by as much to the other
/// way. That is right for a slope of one sheet; where two sheets were joined for want of samples it makes normals that
/// fit neither. So the steeper the step, the less is reflected.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::angle_between;
    use crate::pn_triangle::tests::on_sphere;

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
}
