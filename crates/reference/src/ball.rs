//! The members of neighbourhoods on the tangent planes of their centres, and the fuzzy planes between them (section 4).
//! Twins: `ball.wgsl` and `fuzzy_planes.wgsl` in `shaders/shared`.

use crate::Level;
use crate::angles::direction_angles;
use crate::columns::{BLOCK, Column, LANES, vectorized};
use crate::neighborhood::WORST_BADNESS;
use crate::pn_triangle::geodesic_distance;
use glam::Vec3;
use std::ops::Range;

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

/// Centres with one member each, in columns.
#[derive(Default)]
pub(crate) struct Pairs {
    /// From the centre to the member.
    d: [Vec<f32>; 3],
    normal: [Vec<f32>; 3],
    other: [Vec<f32>; 3],
    /// Of `d` in the frame of the tangent plane.
    plane: [Vec<f32>; 2],
    inverse_radius: Vec<f32>,
}

impl Pairs {
    fn resize(&mut self, room: usize) {
        let Self { d, normal, other, plane, inverse_radius } = self;
        let columns = d.iter_mut().chain(normal).chain(other).chain(plane).chain([inverse_radius]);
        columns.for_each(|column| column.resize(room, 0.0));
    }

    #[inline(always)]
    fn set(&mut self, i: usize, d: Vec3, other: Vec3) {
        for axis in 0..3 {
            (self.d[axis][i], self.other[axis][i]) = (d[axis], other[axis]);
        }
    }

    /// Gives pairs their centre.
    fn set_center(&mut self, own: Range<usize>, center: &Center) {
        let Self { d, normal, plane, inverse_radius, .. } = self;
        for (column, value) in normal.iter_mut().zip(center.normal.to_array()) {
            column[own.clone()].fill(value);
        }
        inverse_radius[own.clone()].fill(center.inverse_radius);
        let d = d.each_ref().map(|column| &column[own.clone()]);
        let [x, y] = plane.each_mut().map(|column| &mut column[own.clone()]);
        along(d, center.frame.0, x);
        along(d, center.frame.1, y);
    }

    fn block(&self, block: usize) -> Block<'_> {
        fn of(column: &[f32], block: usize) -> &Column {
            &column.as_chunks().0[block]
        }
        Block {
            d: self.d.each_ref().map(|column| of(column, block)),
            normal: self.normal.each_ref().map(|column| of(column, block)),
            other: self.other.each_ref().map(|column| of(column, block)),
            plane: self.plane.each_ref().map(|column| of(column, block)),
            inverse_radius: of(&self.inverse_radius, block),
        }
    }
}

/// A block of [`Pairs`].
#[derive(Clone, Copy)]
pub(crate) struct Block<'a> {
    d: [&'a Column; 3],
    normal: [&'a Column; 3],
    other: [&'a Column; 3],
    plane: [&'a Column; 2],
    inverse_radius: &'a Column,
}

impl Block<'_> {
    /// The vector between the points of a pair, and their normals.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> (Vec3, Vec3, Vec3) {
        let at = |columns: [&Column; 3]| Vec3::from_array(columns.map(|column| column[i]));
        (at(self.d), at(self.normal), at(self.other))
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

/// The members of many neighbourhoods, one after the other. Columns are longer than there are members.
#[derive(Default)]
pub(crate) struct Members {
    len: usize,
    /// Where the members of each neighbourhood end.
    ends: Vec<usize>,
    pub(crate) ids: Vec<u32>,
    pairs: Pairs,
    /// Orthogonal projections `q_i`, up to positive factors, in units of the radius; for the accurate neighbourhood `q'_i` (eq. 9).
    x: Vec<f32>,
    y: Vec<f32>,
    angle: Vec<f32>,
    /// Heights over the tangent planes, for the fuzzy neighbourhood.
    height: Vec<f32>,
    pub(crate) verdicts: Vec<Verdict>,
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
    d: [&'a [f32]; 3],
}

impl Members {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
        self.ends.clear();
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Makes room for so many more members.
    pub(crate) fn prepare(&mut self, count: usize) {
        // Whole blocks are read, and the members of a neighbourhood in multiples of `LANES`.
        let room = self.len + count + BLOCK;
        if self.ids.len() >= room {
            return;
        }
        let room = (2 * room).next_multiple_of(BLOCK);
        self.ids.resize(room, 0);
        self.verdicts.resize(room, OUT);
        self.pairs.resize(room);
        let columns = [&mut self.x, &mut self.y, &mut self.height, &mut self.angle];
        columns.into_iter().for_each(|column| column.resize(room, 0.0));
    }

    /// Adds a member to the neighbourhood that is being made, if it is wanted; there must be room. It is written in any case and
    /// counted conditionally: a branch would be guessed wrong often.
    #[inline(always)]
    pub(crate) fn offer(&mut self, id: u32, d: Vec3, other: Vec3, is_wanted: bool) {
        self.ids[self.len] = id;
        self.pairs.set(self.len, d, other);
        self.len += usize::from(is_wanted);
    }

    /// Ends the neighbourhood of a centre.
    pub(crate) fn end(&mut self, center: &Center) {
        let first = self.ends.last().copied().unwrap_or(0);
        self.ends.push(self.len);
        self.pairs.set_center(padded(&(first..self.len)), center);
    }

    /// The members of the neighbourhood of that rank.
    pub(crate) fn own(&self, rank: usize) -> Range<usize> {
        let first = if rank == 0 { 0 } else { self.ends[rank - 1] };
        first..self.ends[rank]
    }

    /// Calls a function for each block of pairs and the verdicts on them.
    pub(crate) fn judge(&mut self, judge: impl Fn(Block<'_>, &mut [Verdict; BLOCK])) {
        let blocks = self.verdicts.as_chunks_mut().0.iter_mut().take(self.len.div_ceil(BLOCK));
        blocks.enumerate().for_each(|(i, verdicts)| judge(self.pairs.block(i), verdicts));
    }

    /// Finds the places of all on the tangent planes. Those exactly along the normal have no direction there: they are out.
    pub(crate) fn project(&mut self, fuzzy: bool) {
        let Self { pairs, x, y, height, angle, verdicts, .. } = self;
        let project = if fuzzy { project::<true> } else { project::<false> };
        let blocks = self.len.div_ceil(BLOCK);
        for i in 0..blocks {
            let [x, y, height] =
                [&mut *x, y, height].map(|column| &mut column.as_chunks_mut().0[i]);
            project(pairs.block(i), x, y, height, &mut verdicts.as_chunks_mut().0[i]);
            direction_angles(y, x, &mut angle[i * BLOCK..(i + 1) * BLOCK]);
        }
    }

    /// The members of a neighbourhood, after their badness `w_i` (eq. 8) was found.
    pub(crate) fn ball(&mut self, own: Range<usize>, fuzzy: bool, sin_theta_f: f32) -> Ball<'_> {
        let all = padded(&own);
        let [x, y, height] = [&self.x, &self.y, &self.height].map(|column| &column[all.clone()]);
        let verdicts = &self.verdicts[own.clone()];
        let (successor, predecessor) = (&mut self.successor, &mut self.predecessor);
        for sines in [&mut *successor, predecessor] {
            sines.clear();
            // Less than any square of a sine.
            sines.resize(all.len(), -2.0);
        }
        let worst_sines = if fuzzy { worst_sines::<true> } else { worst_sines::<false> };
        worst_sines(x, y, height, verdicts, successor, predecessor);
        badness(successor, predecessor, sin_theta_f);
        Ball {
            ids: &self.ids[own.clone()],
            x: &self.x[own.clone()],
            y: &self.y[own.clone()],
            angle: &self.angle[own.clone()],
            verdicts,
            badness: &self.successor[..own.len()],
            d: self.pairs.d.each_ref().map(|column| &column[own.clone()]),
        }
    }
}

/// A range filled up to a multiple of [`LANES`].
fn padded(own: &Range<usize>) -> Range<usize> {
    own.start..own.start + own.len().next_multiple_of(LANES)
}

impl Ball<'_> {
    pub(crate) fn len(&self) -> usize {
        self.ids.len()
    }

    /// From the centre to a member.
    pub(crate) fn offset(&self, i: usize) -> Vec3 {
        Vec3::from_array(self.d.map(|column| column[i]))
    }

    /// Whether a member is a neighbour: whether it is sure, and does not lie behind its successors and predecessors.
    #[inline(always)]
    pub(crate) fn is_neighbor(&self, i: usize) -> bool {
        (self.verdicts[i] == SURE) & (self.badness[i] <= WORST_BADNESS)
    }

    /// Appends the neighbours.
    pub(crate) fn neighbors(&self, around: &mut Around) {
        around.prepare(self.len());
        for i in 0..self.len() {
            around.offer(i as u32, self.angle[i], self.ids[i], self.is_neighbor(i));
        }
    }
}

/// Members in the order of their angles, ties by index.
#[derive(Default)]
pub(crate) struct Around {
    len: usize,
    /// Which members these are in their ball.
    members: Vec<u32>,
    /// Angles are not negative, so their bits order like they do. Those of the index follow them.
    keys: Vec<u64>,
    /// How many keys are smaller than each.
    ranks: Vec<u64>,
}

impl Around {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for so many more.
    pub(crate) fn prepare(&mut self, count: usize) {
        let room = (self.len + count + 1).next_multiple_of(LANES);
        if self.keys.len() < room {
            self.members.resize(room, 0);
            self.keys.resize(room, 0);
            self.ranks.resize(room, 0);
        }
    }

    /// Adds a member if it is wanted; there must be room. It is written in any case: a branch would be guessed wrong often.
    #[inline(always)]
    pub(crate) fn offer(&mut self, member: u32, angle: f32, id: u32, is_wanted: bool) {
        self.members[self.len] = member;
        self.keys[self.len] = u64::from(angle.to_bits()) << 32 | u64::from(id);
        self.len += usize::from(is_wanted);
    }

    /// The members, in any order.
    pub(crate) fn members(&self) -> &[u32] {
        &self.members[..self.len]
    }

    /// The members, each with its rank among all. To count what comes before each takes as many comparisons as there are pairs,
    /// but they are made in vector registers, and none has to be guessed.
    pub(crate) fn sorted(&mut self) -> impl ExactSizeIterator<Item = (usize, usize)> {
        find_ranks(&self.keys[..self.len.next_multiple_of(LANES)], self.len, &mut self.ranks);
        let members = &self.members[..self.len];
        members.iter().zip(&self.ranks).map(|(&member, &rank)| (member as usize, rank as usize))
    }
}

vectorized! {
    fn along(d: [&[f32]; 3], axis: Vec3, places: &mut [f32]) {
        let count = places.len();
        let [x, y, z] = d.map(|column| &column[..count]);
        for i in 0..count {
            places[i] = Vec3::new(x[i], y[i], z[i]).dot(axis);
        }
    }

    fn project[const FUZZY: bool] [FUZZY](
        pairs: Block<'_>,
        xs: &mut Column,
        ys: &mut Column,
        heights: &mut Column,
        verdicts: &mut [Verdict; BLOCK],
    ) {
        for i in 0..BLOCK {
            let (d, normal, other) = pairs.get(i);
            let [x, y] = pairs.plane.map(|column| column[i]);
            let q2 = x * x + y * y;
            verdicts[i] = if q2 <= 1e-12 * d.dot(d) { OUT } else { SURE };
            let scale = if FUZZY {
                pairs.inverse_radius[i]
            } else {
                (geodesic_distance(d, normal, other) * pairs.inverse_radius[i]) / q2.sqrt()
            };
            (xs[i], ys[i]) = (x * scale, y * scale);
            if FUZZY {
                heights[i] = d.dot(normal) * scale;
            }
        }
    }

    /// The largest signed squares of `sin α_ij` for every member `i`, over successors and predecessors. They order like the sines
    /// and need no root per pair. The vectors whose fuzzy planes are tested are (x, y), `q'_i - p`, for the accurate neighbourhood, and
    /// (x, y, height), `p_i - p`, for the fuzzy one.
    fn worst_sines[const FUZZY: bool] [FUZZY](
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
    fn badness(successor: &mut [f32], predecessor: &[f32], sin_theta_f: f32) {
        for (after, &before) in successor.iter_mut().zip(predecessor) {
            *after = plane_badness(*after, sin_theta_f) + plane_badness(before, sin_theta_f);
        }
    }

    /// How many of the first `count` keys are smaller than each.
    fn find_ranks(keys: &[u64], count: usize, ranks: &mut [u64]) {
        let blocks = keys.as_chunks::<LANES>().0.iter().zip(ranks.as_chunks_mut::<LANES>().0);
        for (own, ranks) in blocks {
            let mut smaller = [0; LANES];
            for &key in &keys[..count] {
                for lane in 0..LANES {
                    smaller[lane] += u64::from(key < own[lane]);
                }
            }
            *ranks = smaller;
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

    #[test]
    fn members_are_ranked_by_angle_then_index() {
        for count in [0u32, 1, 7, 8, 9, 30] {
            let (mut around, mut expected) = (Around::default(), Vec::new());
            around.prepare(count as usize);
            for i in 0..count {
                let (angle, id) = ((i * 7 % 5) as f32, i * 11 % 31);
                around.offer(i, angle, id, i % 4 != 3);
                expected.extend((i % 4 != 3).then_some((angle.to_bits(), id, i as usize)));
            }
            expected.sort_unstable();
            for (member, rank) in around.sorted() {
                assert_eq!(expected[rank].2, member, "of {count}");
            }
        }
    }
}
