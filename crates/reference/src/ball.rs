//! The members of neighbourhoods on the tangent planes of their centres, and the fuzzy planes between them (section 4).
//! Twins: `ball.wgsl` and `fuzzy_planes.wgsl` in `shaders/shared`.

use crate::Level;
use crate::angles::direction_angles;
use crate::columns::{BLOCK, Column, LANES, Vectors, vectorized};
use crate::pn_triangle::geodesic_distance;
use glam::Vec3;
use std::ops::Range;

/// Largest badness of a neighbour: 1, and a margin because regular grids give exactly that.
const WORST_BADNESS: f32 = 1.001;

/// The centre of a neighbourhood.
#[derive(Clone, Copy, Default)]
pub(crate) struct Center {
    pub(crate) position: Vec3,
    pub(crate) normal: Vec3,
    /// Span its tangent plane.
    pub(crate) frame: (Vec3, Vec3),
    pub(crate) radius: f32,
    pub(crate) inverse_radius: f32,
}

impl Center {
    pub(crate) fn of(level: &Level, p: usize) -> Self {
        let radius = level.radii[p];
        Self {
            position: level.positions[p],
            normal: level.normals[p],
            frame: level.frame(p),
            radius,
            inverse_radius: 1.0 / radius,
        }
    }
}

/// Centres with one member each.
#[derive(Clone, Copy)]
pub(crate) struct Pairs {
    /// From the centre to the member.
    d: Vectors,
    normal: Vectors,
    other: Vectors,
    /// Of `d` in the frame of the tangent plane.
    x: Column,
    y: Column,
    inverse_radius: Column,
}

impl Pairs {
    const EMPTY: Self = Self {
        d: Vectors::ZERO,
        normal: Vectors::ZERO,
        other: Vectors::ZERO,
        x: [0.0; BLOCK],
        y: [0.0; BLOCK],
        inverse_radius: [0.0; BLOCK],
    };

    fn set(&mut self, i: usize, center: &Center, d: Vec3, other: Vec3) {
        self.d.set(i, d);
        self.normal.set(i, center.normal);
        self.other.set(i, other);
        (self.x[i], self.y[i]) = (d.dot(center.frame.0), d.dot(center.frame.1));
        self.inverse_radius[i] = center.inverse_radius;
    }

    /// The vector between the points of a pair, and their normals.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> (Vec3, Vec3, Vec3) {
        (self.d.get(i), self.normal.get(i), self.other.get(i))
    }
}

/// What is known of a member.
pub(crate) type Verdict = u32;
/// It is no neighbour and hides none.
pub(crate) const OUT: Verdict = 0;
/// It is a neighbour unless others hide it.
pub(crate) const SURE: Verdict = 1;
/// It may lie on another sheet: then it is no neighbour unless a gap stays open, and hides none.
pub(crate) const DOUBT: Verdict = 2;

/// The members of many neighbourhoods, one after the other.
#[derive(Default)]
pub(crate) struct Members {
    pub(crate) ids: Vec<u32>,
    pub(crate) pairs: Vec<Pairs>,
    /// Orthogonal projections `q_i`, up to positive factors, in units of the radius; for the accurate neighbourhood `q'_i` (eq. 9).
    x: Vec<Column>,
    y: Vec<Column>,
    angle: Vec<Column>,
    /// The vectors whose fuzzy planes are tested, for the fuzzy neighbourhood: `p_i - p`. For the accurate one they are
    /// `q'_i - p`, which is (x, y).
    offset: [Vec<Column>; 3],
    pub(crate) verdicts: Vec<[Verdict; BLOCK]>,
    successor: Vec<f32>,
    predecessor: Vec<f32>,
}

/// The members of one neighbourhood on the tangent plane.
#[derive(Clone, Copy)]
pub(crate) struct Ball<'a> {
    pub(crate) ids: &'a [u32],
    pub(crate) x: &'a [f32],
    pub(crate) y: &'a [f32],
    pub(crate) angle: &'a [f32],
    pub(crate) verdicts: &'a [Verdict],
    badness: &'a [f32],
    /// All pairs, and the first of the neighbourhood.
    pairs: &'a [Pairs],
    first: usize,
}

impl Members {
    pub(crate) fn clear(&mut self) {
        self.ids.clear();
        self.pairs.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.ids.len()
    }

    pub(crate) fn push(&mut self, id: u32, center: &Center, d: Vec3, other: Vec3) {
        let i = self.ids.len() % BLOCK;
        if i == 0 {
            self.pairs.push(Pairs::EMPTY);
        }
        if let Some(pairs) = self.pairs.last_mut() {
            pairs.set(i, center, d, other);
        }
        self.ids.push(id);
    }

    /// Finds the places of all on the tangent planes. Those exactly along the normal have no direction there: they are out.
    pub(crate) fn project(&mut self, fuzzy: bool) {
        let Self { x, y, angle, offset, verdicts, .. } = self;
        // One more than there are: the members of a neighbourhood are read in multiples of `LANES`.
        let blocks = self.pairs.len() + 1;
        if x.len() < blocks {
            let columns = [&mut *x, y, angle].into_iter().chain(offset.iter_mut());
            columns.for_each(|column| column.resize(blocks, [0.0; BLOCK]));
            verdicts.resize(blocks, [OUT; BLOCK]);
        }
        for (i, pairs) in self.pairs.iter().enumerate() {
            if fuzzy {
                project::<true>(pairs, &mut x[i], &mut y[i], &mut verdicts[i]);
                for lane in 0..BLOCK {
                    let d = pairs.d.get(lane) * pairs.inverse_radius[lane];
                    offset.iter_mut().zip(d.to_array()).for_each(|(o, v)| o[i][lane] = v);
                }
            } else {
                project::<false>(pairs, &mut x[i], &mut y[i], &mut verdicts[i]);
            }
            direction_angles(&y[i], &x[i], &mut angle[i]);
        }
    }

    /// The members of a neighbourhood, after their badness `w_i` (eq. 8) was found.
    pub(crate) fn ball(&mut self, own: Range<usize>, fuzzy: bool, sin_theta_f: f32) -> Ball<'_> {
        let padded = own.start..own.start + own.len().next_multiple_of(LANES);
        let [ox, oy, oz] = &self.offset;
        let (x, y) = (self.x.as_flattened(), self.y.as_flattened());
        let verdicts = &self.verdicts.as_flattened()[own.clone()];
        // Less than any square of a sine.
        for sines in [&mut self.successor, &mut self.predecessor] {
            sines.clear();
            sines.resize(padded.len(), -2.0);
        }
        let (successor, predecessor) = (&mut *self.successor, &mut *self.predecessor);
        let directions = [&x[padded.clone()], &y[padded.clone()]];
        if fuzzy {
            let offsets = [ox, oy, oz].map(|column| &column.as_flattened()[padded.clone()]);
            worst_sines::<true>(offsets, directions, verdicts, successor, predecessor);
        } else {
            let [x, y] = directions;
            worst_sines::<false>([x, y, &[]], directions, verdicts, successor, predecessor);
        }
        badness(successor, predecessor, sin_theta_f);
        Ball {
            ids: &self.ids[own.clone()],
            x: &x[own.clone()],
            y: &y[own.clone()],
            angle: &self.angle.as_flattened()[own],
            verdicts,
            badness: &self.successor,
            pairs: &self.pairs,
            first: padded.start,
        }
    }
}

impl Ball<'_> {
    pub(crate) fn len(&self) -> usize {
        self.ids.len()
    }

    /// From the centre to a member.
    pub(crate) fn offset(&self, i: usize) -> Vec3 {
        let i = self.first + i;
        self.pairs[i / BLOCK].d.get(i % BLOCK)
    }

    /// Whether a member is a neighbour: whether it is sure, and does not lie behind its successors and predecessors.
    pub(crate) fn is_neighbor(&self, i: usize) -> bool {
        self.verdicts[i] == SURE && self.badness[i] <= WORST_BADNESS
    }
}

vectorized! {
    fn project[const FUZZY: bool] [FUZZY](
        pairs: &Pairs,
        xs: &mut Column,
        ys: &mut Column,
        verdicts: &mut [Verdict; BLOCK],
    ) {
        for i in 0..BLOCK {
            let (d, normal, other) = pairs.get(i);
            let (x, y) = (pairs.x[i], pairs.y[i]);
            let q2 = x * x + y * y;
            verdicts[i] = if q2 <= 1e-12 * d.dot(d) { OUT } else { SURE };
            let scale = if FUZZY {
                pairs.inverse_radius[i]
            } else {
                (geodesic_distance(d, normal, other) * pairs.inverse_radius[i]) / q2.sqrt()
            };
            (xs[i], ys[i]) = (x * scale, y * scale);
        }
    }

    /// The largest signed squares of `sin α_ij` for every member `i`, over successors and predecessors. They order like the sines
    /// and need no root per pair.
    fn worst_sines[const SPATIAL: bool] [SPATIAL](
        offsets: [&[f32]; 3],
        directions: [&[f32]; 2],
        verdicts: &[Verdict],
        successor: &mut [f32],
        predecessor: &mut [f32],
    ) {
        let ([ox, oy, oz], [x, y]) = (offsets, directions);
        let count = x.len();
        let (ox, oy, oz) = (&ox[..count], &oy[..count], if SPATIAL { &oz[..count] } else { oz });
        let at = |i: usize| Vec3::new(ox[i], oy[i], if SPATIAL { oz[i] } else { 0.0 });
        let (y, successor, predecessor) =
            (&y[..count], &mut successor[..count], &mut predecessor[..count]);
        for j in (0..verdicts.len()).filter(|&j| verdicts[j] == SURE) {
            let (other, xj, yj) = (at(j), x[j], y[j]);
            let length = other.dot(other);
            for i in 0..count {
                let c = at(i) - other;
                let product = length * c.dot(c);
                let along = other.dot(c);
                // The member itself, and others in its place, count for nothing.
                let sine = if product == 0.0 { -2.0 } else { along * along.abs() / product };
                // An exactly collinear point counts as successor.
                let succeeds = x[i] * yj - y[i] * xj >= 0.0;
                let (after, before) = if succeeds { (sine, -2.0) } else { (-2.0, sine) };
                successor[i] = if after > successor[i] { after } else { successor[i] };
                predecessor[i] = if before > predecessor[i] { before } else { predecessor[i] };
            }
        }
    }

    /// Adds up the badness over successors and predecessors, in the place of the former.
    fn badness(successor: &mut [f32], predecessor: &[f32], sin_theta_f: f32) {
        for (after, &before) in successor.iter_mut().zip(predecessor) {
            *after = plane_badness(*after, sin_theta_f) + plane_badness(before, sin_theta_f);
        }
    }
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
            for i in 0..count {
                let d = Vec3::new(coordinate(), coordinate(), 0.1 * coordinate());
                let normal = Vec3::new(coordinate(), coordinate(), 3.0).normalize();
                members.push(i, &center, d, normal);
            }
            members.project(false);
            let doubtful = begin..begin + count as usize / 5;
            doubtful.for_each(|i| members.verdicts[i / BLOCK][i % BLOCK] = DOUBT);
            let ball = members.ball(begin..begin + count as usize, false, 0.5);
            for i in 0..ball.len() {
                let plain = plain_badness(ball.x, ball.y, ball.verdicts, i, 0.5);
                assert_eq!(ball.badness[i].to_bits(), plain.to_bits(), "{i} of {count}");
            }
        }
    }
}
