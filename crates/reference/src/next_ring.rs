//! Radii that cover the next level's rings (ours). Twins: `shaders/next_ring.wgsl` and `shaders/shared/ahead.wgsl`.
//!
//! The paper's new radius covers the new neighbours N' alone. On irregular samples the ring of a point at the next
//! level also has old points in it, and triangles that N' does not know. So the ring is looked up ahead: the members of
//! the old ring and of N' (by the paper's loop all new points nearby) go through the filter of section 4, and what is
//! left must be within the radii, of the point and of the members alike.

use crate::ball::Members;
use crate::insertion::{COVER, Insertion, Stage, raise};
use crate::lists::filled;
use crate::math::{PI, TAU, is_apart};
use crate::pairs::Center;
use crate::sort_ring::RingOrder;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::AtomicU32;
use surfine_points::Neighborhood;

/// Radii that the next level's rings ask for, 0 where they ask for none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Covers {
    /// Of the old points.
    pub radii: Vec<f32>,
    /// Of the inserted candidates.
    pub candidate_radii: Vec<f32>,
}

/// Points whose rings are found together.
const BATCH: usize = 32;

/// Finds the radii that cover the next level's rings; none if the rule is off.
pub fn next_ring(stage: Stage<'_>, insertion: &Insertion) -> Covers {
    let points = stage.level.len();
    if !stage.params.effective_next_ring() {
        let candidate_radii = filled(0.0, stage.candidates.len());
        return Covers { radii: filled(0.0, points), candidate_radii };
    }
    let zeros = |count| (0..count).map(|_| AtomicU32::new(0)).collect();
    let squares: Vec<AtomicU32> = zeros(points + stage.candidates.len());
    let batches = (0..points.div_ceil(BATCH)).into_par_iter();
    batches.with_min_len(8).for_each_init(Scratch::default, |scratch, batch| {
        let batch = batch * BATCH..((batch + 1) * BATCH).min(points);
        cover_rings(stage, insertion, batch, scratch, &squares);
    });
    let cover = |square: AtomicU32| COVER * f32::from_bits(square.into_inner()).sqrt();
    let mut radii: Vec<f32> = squares.into_par_iter().map(cover).collect();
    let candidate_radii = radii.split_off(points);
    Covers { radii, candidate_radii }
}

/// What a thread uses again for the next points.
#[derive(Default)]
struct Scratch {
    /// What may be on the next rings of a batch: old points by index, then candidates.
    members: Members,
    kept: RingOrder,
    ring: Vec<Member>,
}

/// A member of the next ring.
#[derive(Clone, Copy, Default)]
struct Member {
    id: u32,
    offset: Vec3,
    angle: f32,
    /// The square of the largest distance that it must cover.
    squared: f32,
}

/// Covers the next rings of a batch of points.
fn cover_rings(
    stage: Stage<'_>,
    insertion: &Insertion,
    batch: Range<usize>,
    scratch: &mut Scratch,
    squares: &[AtomicU32],
) {
    let Stage { level, params, .. } = stage;
    let (fuzzy, sin_theta_f) =
        (params.effective_neighborhood() == Neighborhood::Fuzzy, params.sin_theta_f());
    scratch.members.clear();
    for p in batch.clone() {
        gather(stage, insertion, p, scratch);
    }
    scratch.members.project(fuzzy);
    for (rank, p) in batch.enumerate() {
        keep_ring(scratch, rank, fuzzy, sin_theta_f);
        cover_ring(&mut scratch.ring, level.record(p).is_some(), p, squares);
    }
}

/// The members of the old ring, and those of the list around the point that are inserted and within
/// the new radius: of N', all.
fn gather(stage: Stage<'_>, insertion: &Insertion, p: usize, scratch: &mut Scratch) {
    let Stage { level, rings, candidates, conflicts, .. } = stage;
    let center = Center::of(level, p);
    let members = &mut scratch.members;
    let (ring, around) = (rings.ring(p), conflicts.around.of(p));
    members.prepare(ring.len() + around.len());
    let mut add = |id: u32, d: Vec3, other: Vec3, is_wanted: bool| {
        members.offer(id, d, other, is_wanted & is_apart(d.dot(d), center.radius));
    };
    for entry in ring {
        let i = entry.id as usize;
        add(entry.id, level.positions[i] - center.position, level.normals[i], true);
    }
    let limit = insertion.radii[p] * insertion.radii[p];
    for &c in around {
        let i = c as usize;
        let d = candidates.positions[i] - center.position;
        let is_near = insertion.is_inserted(i) & (d.dot(d) <= limit);
        add(level.len() as u32 + c, d, candidates.normals[i], is_near);
    }
    members.end(&center);
}

/// Removes the members that lie behind others (section 4) and sorts the rest around the centre.
fn keep_ring(scratch: &mut Scratch, rank: usize, fuzzy: bool, sin_theta_f: f32) {
    let Scratch { members, kept, ring, .. } = scratch;
    let ball = members.ball(members.own(rank), fuzzy, sin_theta_f);
    kept.clear();
    ball.neighbors(kept);
    let sorted = kept.sorted();
    ring.resize(sorted.len(), Member::default());
    for (i, rank) in sorted {
        let (id, offset) = (ball.ids[i], ball.offset(i));
        ring[rank] = Member { id, offset, angle: ball.angle[i], squared: offset.dot(offset) };
    }
}

/// The point covers the members, they cover it and, over gaps below π, each other: raises the squares of what they
/// cover. `on_curve` says that the sheet ends at the centre.
fn cover_ring(ring: &mut [Member], on_curve: bool, p: usize, squares: &[AtomicU32]) {
    let farthest = ring.iter().map(|member| member.squared).fold(0.0, f32::max);
    raise(&squares[p], farthest);
    for i in 0..ring.len() {
        let last = i + 1 == ring.len();
        let after = if last { 0 } else { i + 1 };
        let (member, next) = (ring[i], ring[after]);
        let gap = (if last { next.angle + TAU } else { next.angle }) - member.angle;
        if gap < PI && !(on_curve && last) {
            let side = next.offset - member.offset;
            let squared = side.dot(side);
            ring[i].squared = ring[i].squared.max(squared);
            ring[after].squared = ring[after].squared.max(squared);
        }
    }
    for member in ring {
        raise(&squares[member.id as usize], member.squared);
    }
}
