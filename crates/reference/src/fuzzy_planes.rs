//! Fuzzy planes (section 4.1, eq. 8): how far each member lies behind others. Twin: `shaders/shared/fuzzy_planes.wgsl`.

use crate::columns::vectorized;
use crate::pairs::{SURE, Verdict};
use glam::Vec3;

/// Largest badness (eq. 8) of a neighbour: 1, and a margin because regular grids give exactly that.
pub const WORST_BADNESS: f32 = 1.001;

vectorized! {
    /// The largest signed squares of `sin α_ij` for every member `i`, over successors and predecessors. They order like
    /// the sines and need no root per pair. The vectors whose fuzzy planes are tested are (x, y), `q'_i - p`, for the
    /// accurate neighbourhood, and (x, y, height), `p_i - p`, for the fuzzy one.
    pub(crate) fn worst_sines[const FUZZY: bool] [FUZZY](
        x: &[f32],
        y: &[f32],
        height: &[f32],
        verdicts: &[Verdict],
        successor: &mut [f32],
        predecessor: &mut [f32],
    ) {
        let count = x.len();
        let dot = |a: Vec3, b: Vec3| if FUZZY { a.dot(b) } else { a.x * b.x + a.y * b.y };
        let (y, height) = (&y[..count], &height[..count]);
        let at = |i: usize| Vec3::new(x[i], y[i], if FUZZY { height[i] } else { 0.0 });
        let (successor, predecessor) = (&mut successor[..count], &mut predecessor[..count]);
        for j in (0..verdicts.len()).filter(|&j| verdicts[j] == SURE) {
            let other = at(j);
            let length = dot(other, other);
            for i in 0..count {
                let c = at(i) - other;
                let product = length * dot(c, c);
                let along = dot(other, c);
                let sine = along * along.abs() / product;
                // The member itself, and others in its place, count for nothing.
                let sine = unless(product == 0.0, sine);
                // An exactly collinear point counts as successor.
                let succeeds = x[i] * other.y - y[i] * other.x >= 0.0;
                let (after, before) = (unless(!succeeds, sine), unless(succeeds, sine));
                successor[i] = if after > successor[i] { after } else { successor[i] };
                predecessor[i] = if before > predecessor[i] { before } else { predecessor[i] };
            }
        }
    }

    /// Adds up the badness over successors and predecessors, in the place of the former.
    pub(crate) fn badness(successor: &mut [f32], predecessor: &[f32], sin_theta_f: f32) {
        for (after, &before) in successor.iter_mut().zip(predecessor) {
            *after = plane_badness(*after, sin_theta_f) + plane_badness(before, sin_theta_f);
        }
    }
}

/// A number, or none at all, which is larger than none: NaN. It costs less than a choice between numbers.
#[inline(always)]
fn unless(condition: bool, number: f32) -> f32 {
    f32::from_bits(number.to_bits() | u32::from(condition).wrapping_neg())
}

/// `w_ij` from the signed square of `sin α_ij`; 0 for an empty set, which passes -2.
#[inline(always)]
fn plane_badness(sin_squared: f32, sin_theta_f: f32) -> f32 {
    let root = sin_squared.abs().sqrt();
    let sine = if sin_squared < 0.0 { -root } else { root };
    if sine < -sin_theta_f { 0.0 } else { 0.5 * (sine / sin_theta_f + 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ball::Members;
    use crate::pairs::{Center, DOUBT};

    /// Eq. 8 as it stands: the sum of the largest badness over successors and over predecessors.
    fn plain_badness(x: &[f32], y: &[f32], verdicts: &[Verdict], i: usize, theta: f32) -> f32 {
        let q = |i: usize| Vec3::new(x[i], y[i], 0.0);
        let mut worst = [-2.0f32; 2];
        for j in (0..x.len()).filter(|&j| j != i && verdicts[j] == SURE) {
            let c = q(i) - q(j);
            let along = q(j).dot(c);
            let sine = along * along.abs() / (q(j).dot(q(j)) * c.dot(c));
            let side = usize::from(x[i] * y[j] - y[i] * x[j] < 0.0);
            worst[side] = worst[side].max(sine);
        }
        plane_badness(worst[0], theta) + plane_badness(worst[1], theta)
    }

    #[test]
    fn the_badness_of_many_members_has_the_bytes_of_single_ones() {
        let mut seed = 1u32;
        let mut coordinate = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
        };
        let center = Center {
            normal: Vec3::Z,
            frame: (Vec3::X, Vec3::Y),
            radius: 1.0,
            inverse_radius: 1.0,
            ..Center::default()
        };
        let mut members = Members::default();
        for count in [0, 1, 5, 8, 9, 40] {
            let begin = members.len();
            members.prepare(count as usize);
            for i in 0..count {
                let d = Vec3::new(coordinate(), coordinate(), 0.1 * coordinate());
                let normal = Vec3::new(coordinate(), coordinate(), 3.0).normalize();
                members.offer(i, d, normal, true);
            }
            members.end(&center);
            members.project(false);
            let doubtful = begin..begin + count as usize / 5;
            doubtful.for_each(|i| members.verdicts[i] = DOUBT);
            let ball = members.ball(begin..begin + count as usize, false, 0.5);
            for i in 0..ball.len() {
                let plain = plain_badness(ball.x, ball.y, ball.verdicts, i, 0.5);
                assert_eq!(ball.badness[i].to_bits(), plain.to_bits(), "{i} of {count}");
            }
        }
    }
}
