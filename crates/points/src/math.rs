//! Vectors and angles. Twin: `shaders/shared/math.wgsl`.
//!
//! Every function is the same sequence of + - * / and square roots as its twin: system libraries and drivers differ in
//! `acos` and `atan2`, never in these. They are inlined wherever they are called, so that loops over many of them run in
//! vector registers.

use glam::Vec3;

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};
pub use std::f32::consts::{PI, TAU};

/// `v` with length 1; the zero vector must be kept away by the caller.
#[inline(always)]
pub fn unit(v: Vec3) -> Vec3 {
    v * (1.0 / v.dot(v).sqrt())
}

/// Whether points at this squared distance have a direction to each other, seen at the scale of a radius. Nearer ones
/// count as being in one place.
#[inline(always)]
pub fn is_apart(squared_distance: f32, radius: f32) -> bool {
    squared_distance > radius * radius * 1e-12
}

/// Two unit vectors that span the plane of normal `n`; with `n` they are right-handed, so angles from the first to the
/// second turn counter-clockwise seen from outside.
pub fn tangent_frame(n: Vec3) -> (Vec3, Vec3) {
    let a = n.abs();
    // The axis farthest from n.
    let axis = if a.x <= a.y && a.x <= a.z {
        Vec3::X
    } else if a.y <= a.z {
        Vec3::Y
    } else {
        Vec3::Z
    };
    let e1 = unit(n.cross(axis));
    (e1, n.cross(e1))
}

/// Arc tangent for t in [0, 1], after Cephes' `atanf`: within 2e-7. It chooses between numbers where it could branch.
#[inline(always)]
fn atan_unit(t: f32) -> f32 {
    let upper = t > 0.414_213_57;
    let above = if upper { t - 1.0 } else { t };
    let below = if upper { t + 1.0 } else { 1.0 };
    let x = above / below;
    let z = x * x;
    let p = ((0.080_537_446 * z - 0.138_776_85) * z + 0.199_777_11) * z - 0.333_329_5;
    let a = p * z * x + x;
    a + if upper { FRAC_PI_4 } else { 0.0 }
}

/// Angle of the direction (x, y) in [0, 2π], counter-clockwise from the x axis; 0 for the zero vector.
#[inline(always)]
pub fn direction_angle(y: f32, x: f32) -> f32 {
    let ax = x.abs();
    let ay = y.abs();
    let longer = ax.max(ay);
    let shorter = ax.min(ay);
    let a = atan_unit(shorter / if longer == 0.0 { 1.0 } else { longer });
    let a = if ay > ax { FRAC_PI_2 - a } else { a };
    let a = if x < 0.0 { PI - a } else { a };
    if y < 0.0 { TAU - a } else { a }
}

/// Angle between two vectors in [0, π]; 0 if one is zero.
#[inline(always)]
pub fn angle_between(u: Vec3, v: Vec3) -> f32 {
    let c = u.cross(v);
    direction_angle(c.dot(c).sqrt(), u.dot(v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_agree_with_the_system_library() {
        for i in 0..=100_000 {
            let angle = f64::from(i) * std::f64::consts::TAU / 100_000.0;
            let (y, x) = (angle.sin() as f32, angle.cos() as f32);
            let expected = f64::from(y).atan2(f64::from(x)).rem_euclid(std::f64::consts::TAU);
            let found = f64::from(direction_angle(y, x));
            // Near the positive x axis 0 and 2π are the same direction.
            let error =
                (found - expected).abs().min(std::f64::consts::TAU - (found - expected).abs());
            // Two roundings of numbers up to 2π, whose steps are 4.8e-7.
            assert!(error < 7e-7, "{angle}: {found} instead of {expected}");
        }
    }

    #[test]
    fn frames_are_right_handed_and_orthonormal() {
        for n in
            [Vec3::X, Vec3::NEG_Y, Vec3::Z, Vec3::new(0.6, -0.48, 0.64), Vec3::splat(0.577_350_26)]
        {
            let (e1, e2) = tangent_frame(n);
            assert!((e1.cross(e2) - n).length() < 1e-6, "{n}");
            assert!(e1.dot(n).abs() < 1e-6 && (e1.length() - 1.0).abs() < 1e-6, "{n}");
        }
    }
}
