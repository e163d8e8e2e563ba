//! Radii that cover the next level's rings (ours). Twin: `shaders/next_ring.wgsl`.
//!
//! The paper's new radius covers the new neighbours N' alone. On irregular samples the ring of a point at the next level
//! also has old points in it, and triangles that N' does not know. So the ring is looked up ahead: the members of the
//! old ring and the new points nearby go through the filter of section 4, and what is left must be within the radii, of
//! the point and of the members alike.

use crate::insertion::{COVER, Insertion, Stage};
use crate::math::{PI, TAU, direction_angle, is_apart};
use crate::neighborhood::{Neighbor, is_behind};
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Radii that the next level's rings ask for, 0 where they ask for none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Covers {
    /// Of the old points.
    pub radii: Vec<f32>,
    /// Of the inserted candidates.
    pub candidate_radii: Vec<f32>,
}

/// Finds the radii that cover the next level's rings; none if the rule is off.
pub fn next_ring(stage: Stage<'_>, insertion: &Insertion) -> Covers {
    let points = stage.level.len();
    let zeros = |count| (0..count).map(|_| AtomicU32::new(0)).collect();
    let covers: Vec<AtomicU32> = zeros(points + stage.candidates.len());
    if stage.params.rules.next_ring {
        (0..points).into_par_iter().for_each_init(Scratch::default, |scratch, p| {
            gather(stage, insertion, p, scratch);
            keep_ring(stage, scratch);
            cover_ring(&scratch.ring, stage.level.record(p).is_some(), p, &covers);
        });
    }
    let mut radii: Vec<f32> =
        covers.into_iter().map(|bits| f32::from_bits(bits.into_inner())).collect();
    let candidate_radii = radii.split_off(points);
    Covers { radii, candidate_radii }
}

/// What a thread uses again for the next point.
#[derive(Default)]
struct Scratch {
    ball: Vec<Neighbor>,
    /// The place of each member of the ball relative to the centre.
    offsets: Vec<Vec3>,
    ring: Vec<Member>,
}

/// A member of the next ring: old points by index, then candidates.
#[derive(Clone, Copy)]
struct Member {
    id: u32,
    offset: Vec3,
    angle: f32,
}

/// The members of the old ring, and the new points within the new radius, on the tangent plane of the centre.
fn gather(stage: Stage<'_>, insertion: &Insertion, p: usize, scratch: &mut Scratch) {
    let Stage { level, rings, candidates, conflicts, params } = stage;
    let (center, normal, radius) = (level.positions[p], level.normals[p], level.radii[p]);
    let (frame, inverse) = (level.frame(p), 1.0 / radius);
    scratch.ball.clear();
    scratch.offsets.clear();
    let mut add = |id: u32, d: Vec3, other: Vec3| {
        if is_apart(d.dot(d), radius)
            && let Some(neighbor) = Neighbor::new(id, d, frame, inverse, [normal, other], params)
        {
            scratch.ball.push(neighbor);
            scratch.offsets.push(d);
        }
    };
    for entry in rings.ring(p) {
        let i = entry.id as usize;
        add(entry.id, level.positions[i] - center, level.normals[i]);
    }
    let new_radius = insertion.radii[p];
    for &c in conflicts.around.of(p) {
        let i = c as usize;
        let d = candidates.positions[i] - center;
        if insertion.is_inserted(i) && d.dot(d) <= new_radius * new_radius {
            add(level.len() as u32 + c, d, candidates.normals[i]);
        }
    }
}

/// Removes the members that lie behind others (section 4) and sorts the rest around the centre.
fn keep_ring(stage: Stage<'_>, Scratch { ball, offsets, ring }: &mut Scratch) {
    let sin_theta_f = stage.params.sin_theta_f();
    ring.clear();
    for (i, (neighbor, &offset)) in ball.iter().zip(&*offsets).enumerate() {
        if !is_behind(ball, i, sin_theta_f) {
            let angle = direction_angle(neighbor.y, neighbor.x);
            ring.push(Member { id: neighbor.id, offset, angle });
        }
    }
    ring.sort_unstable_by(|a, b| a.angle.total_cmp(&b.angle).then(a.id.cmp(&b.id)));
}

/// The point covers the members, they cover it and, over gaps below π, each other. `on_curve` says that the sheet ends at
/// the centre.
fn cover_ring(ring: &[Member], on_curve: bool, p: usize, covers: &[AtomicU32]) {
    let cover = |id: u32, d: Vec3| {
        let radius = COVER * d.dot(d).sqrt();
        covers[id as usize].fetch_max(radius.to_bits(), Relaxed);
    };
    for (i, member) in ring.iter().enumerate() {
        cover(p as u32, member.offset);
        cover(member.id, member.offset);
        let last = i + 1 == ring.len();
        let next = ring[if last { 0 } else { i + 1 }];
        let gap = (if last { next.angle + TAU } else { next.angle }) - member.angle;
        if gap < PI && !(on_curve && last) {
            let side = next.offset - member.offset;
            cover(member.id, side);
            cover(next.id, side);
        }
    }
}
