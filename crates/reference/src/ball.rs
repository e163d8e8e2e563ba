//! The members of neighbourhoods on the tangent planes of their centres (section 4, eq. 9).
//! Twin: `shaders/shared/ball.wgsl`.

use crate::angles::direction_angles;
use crate::columns::{BLOCK, Column, LANES, vectorized};
use crate::fuzzy_planes::{WORST_BADNESS, badness, worst_sines};
use crate::pairs::{Block, Center, OUT, Pairs, SURE, Verdict};
use crate::pn_triangle::geodesic_distance;
use crate::sort_ring::RingOrder;
use glam::Vec3;
use std::ops::Range;

/// The members of many neighbourhoods, one after the other. Columns are longer than there are members.
#[derive(Default)]
pub(crate) struct Members {
    len: usize,
    /// Where the members of each neighbourhood end.
    ends: Vec<usize>,
    pub(crate) ids: Vec<u32>,
    pairs: Pairs,
    /// Orthogonal projections `q_i`, up to positive factors, in units of the radius; for the accurate
    /// neighbourhood `q'_i` (eq. 9).
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
    pub(crate) badness: &'a [f32],
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

    /// Adds a member to the neighbourhood that is being made, if it is wanted; there must be room. It is written in any
    /// case and counted conditionally: a branch would be guessed wrong often.
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

    /// Finds the places of all on the tangent planes. Those exactly along the normal have no
    /// direction there: they are out.
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
    pub(crate) fn neighbors(&self, kept: &mut RingOrder) {
        kept.prepare(self.len());
        for i in 0..self.len() {
            kept.offer(i as u32, self.angle[i], self.ids[i], self.is_neighbor(i));
        }
    }
}

vectorized! {
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
}
