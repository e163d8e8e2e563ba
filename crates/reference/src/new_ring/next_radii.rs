//! Radii at the next level (section 5, end). Twin: `shaders/shared/next_radii.wgsl`.

use super::{Member, NewRing};
use crate::insertion::{COVER, Shared, Stage, raise};
use crate::math::PI;
use std::sync::atomic::Ordering::Relaxed;

impl NewRing {
    /// New radii. That of the centre covers N', and stays where there are no new neighbours. The members of N' cover
    /// the centre and their two neighbours in N'.
    pub(crate) fn store_radii(&mut self, stage: Stage<'_>, shared: &Shared) {
        let candidates = stage.candidates.len();
        let is_bound = |member: &Member| member.id as usize >= candidates;
        // The largest square that a member must cover takes the place of its gap.
        let mut farthest = 0.0f32;
        for member in &mut self.ring {
            member.gap = if is_bound(member) { 0.0 } else { member.offset.dot(member.offset) };
            farthest = farthest.max(member.gap);
        }
        for i in 0..self.ring.len() {
            let next = self.next(i);
            let (a, b) = (self.ring[i], self.ring[next]);
            if self.directed_gap(i) < PI && !is_bound(&a) && !is_bound(&b) {
                let side = b.offset - a.offset;
                let d2 = side.dot(side);
                self.ring[i].gap = self.ring[i].gap.max(d2);
                self.ring[next].gap = self.ring[next].gap.max(d2);
            }
        }
        for member in self.ring.iter().filter(|member| !is_bound(member)) {
            let radius = &shared.candidate_radii[member.id as usize];
            raise(radius, COVER * member.gap.sqrt());
        }
        let radius = if farthest == 0.0 { self.center.radius } else { COVER * farthest.sqrt() };
        shared.radii[self.p].store(radius.to_bits(), Relaxed);
    }
}
