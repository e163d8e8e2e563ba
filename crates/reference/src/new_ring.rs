//! The new neighbourhood N' of one point while it is refined (section 5). Twin: `shaders/shared/new_ring.wgsl`.

mod choice;
mod discard;
mod gaps;
mod gather;
mod next_radii;

use crate::angles::Angles;
use crate::candidates::Candidates;
use crate::insertion::Stage;
use crate::lists::insertion_sort;
use crate::math::is_apart;
use crate::pairs::Center;
use glam::Vec3;
use rayon::prelude::*;

/// A new point, or a candidate, seen from the centre.
#[derive(Clone, Copy)]
struct Member {
    /// The candidate; after the last one come the points of the level, for members that only bound gaps.
    id: u32,
    /// Its place relative to the centre.
    offset: Vec3,
    normal: Vec3,
    /// Angle on the tangent plane.
    angle: f32,
    /// Angle to the next member of N', or 0 once no candidate splits it.
    gap: f32,
    /// Radius of the sphere in which it discards others: λ2 ρ.
    sphere: f32,
}

/// What the insertion reads of a candidate, side by side.
#[derive(Clone, Copy)]
pub(crate) struct Sample {
    position: Vec3,
    normal: Vec3,
    /// Radius of the sphere in which it discards others: λ2 ρ.
    sphere: f32,
}

impl Sample {
    pub(crate) fn all(candidates: &Candidates, lambda2: f32) -> Vec<Self> {
        let Candidates { positions, normals, rho, .. } = candidates;
        let sample = |c: usize| Self {
            position: positions[c],
            normal: normals[c],
            sphere: lambda2 * rho[c],
        };
        (0..candidates.len()).into_par_iter().map(sample).collect()
    }
}

impl Center {
    /// A candidate, or another point, seen from the centre.
    #[inline(always)]
    fn member(&self, id: u32, sample: &Sample) -> Member {
        let Sample { position, normal, sphere } = *sample;
        Member { id, offset: position - self.position, normal, angle: 0.0, gap: 0.0, sphere }
    }
}

/// The neighbourhood of one point while it is refined.
#[derive(Default)]
pub(crate) struct NewRing {
    p: usize,
    /// Whether the centre lies on a crease or a boundary, where its sheet ends.
    on_curve: bool,
    center: Center,
    /// The new points that were there before.
    there: Vec<u32>,
    /// N', by angle; ties by index.
    ring: Vec<Member>,
    /// `Y_p` (eq. 10).
    outer: Vec<Member>,
    /// The candidates of the fan that are not in N' when it starts, and which of them were not tried yet.
    own: Vec<Member>,
    pending: Vec<bool>,
    /// Whether nothing more is inserted around the point.
    pub(crate) is_complete: bool,
    /// Members whose gaps were asked for, and the place of the first among all such.
    gaps: Vec<usize>,
    first_gap: usize,
}

impl NewRing {
    /// Takes the angles that [`NewRing::gather`] asked for, and asks for all gaps.
    pub(crate) fn start(&mut self, angles: &mut &[f32], gaps: &mut Angles) {
        for members in [&mut self.ring, &mut self.outer, &mut self.own] {
            let (own, rest) = angles.split_at(members.len());
            members.iter_mut().zip(own).for_each(|(member, angle)| member.angle = *angle);
            *angles = rest;
        }
        insertion_sort(&mut self.ring, precedes);
        // Where all candidates are in N', nothing more can be.
        self.is_complete = self.own.is_empty();
        self.gaps.clear();
        if !self.is_complete {
            self.ask_gaps(0..self.ring.len(), gaps);
        }
    }

    /// Tries one candidate: that which splits the widest gap, until none is as wide as `θ_c` or none is left.
    /// Returns it if it was inserted.
    pub(crate) fn step(&mut self, stage: Stage<'_>, gaps: &mut Angles) -> Option<u32> {
        self.gaps.clear();
        let Some(chosen) = self.choose(stage.params.theta_c) else {
            self.is_complete = true;
            return None;
        };
        // Each candidate is tried once.
        self.pending[chosen] = false;
        let candidate = self.own[chosen];
        match self.discarded_by(stage, &candidate) {
            None => {
                self.add(candidate, gaps);
                return Some(candidate.id);
            }
            Some(h) if self.can_join(&h) => self.add(h, gaps),
            Some(_) => {}
        }
        None
    }

    /// Whether a new point is not yet in N' and not in the centre's own place.
    fn can_join(&self, h: &Member) -> bool {
        let apart = is_apart(h.offset.dot(h.offset), self.center.radius);
        apart && self.ring.iter().all(|m| m.id != h.id)
    }

    /// Adds a new point to N' and asks for the two gaps that it makes.
    fn add(&mut self, new: Member, gaps: &mut Angles) {
        let at = self.ring.partition_point(|m| precedes(m, &new));
        self.ring.insert(at, new);
        let before = if at == 0 { self.ring.len() - 1 } else { at - 1 };
        self.ask_gaps([before, at], gaps);
    }
}

/// Whether a member comes before another by angle; ties by index.
fn precedes(a: &Member, b: &Member) -> bool {
    a.angle < b.angle || (a.angle == b.angle && a.id < b.id)
}
