//! The candidate that is tried next (section 5). Twin: `shaders/shared/choice.wgsl`.

use super::{Member, NewRing};
use crate::insertion::{HYSTERESIS, LESS, SMALLEST_SPLIT};
use crate::math::{is_apart, unit};

impl NewRing {
    /// The candidate that is tried next.
    pub(super) fn choose(&mut self, theta_c: f32) -> Option<usize> {
        if self.ring.is_empty() {
            return self.closest();
        }
        loop {
            let widest = self.widest_gap();
            if self.ring[widest].gap < theta_c {
                return None;
            }
            let best = self.best_split(widest);
            if best.is_some() {
                return best;
            }
            self.ring[widest].gap = 0.0;
        }
    }

    /// For an empty N': the candidate closest to the centre, the first of equals.
    fn closest(&self) -> Option<usize> {
        let mut best: Option<(usize, f32)> = None;
        for (i, candidate) in self.own.iter().enumerate().filter(|(i, _)| self.pending[*i]) {
            let d2 = candidate.offset.dot(candidate.offset);
            let closer = best.is_none_or(|(_, least)| d2 * HYSTERESIS < least);
            if is_apart(d2, self.center.radius) && closer {
                best = Some((i, d2));
            }
        }
        best.map(|(i, _)| i)
    }

    /// The candidate strictly inside gap `i` whose smaller angle to the two ends is the largest: angles are
    /// compared by their cosines.
    fn best_split(&self, i: usize) -> Option<usize> {
        let (from, to) = (&self.ring[i], &self.ring[self.next(i)]);
        let wraps = i + 1 == self.ring.len();
        let (a, b) = (unit(from.offset), unit(to.offset));
        let mut best = (None, SMALLEST_SPLIT);
        for (candidate, Member { offset, angle, .. }) in self.own.iter().enumerate() {
            let (after, before) = (*angle > from.angle, *angle < to.angle);
            let is_inside = if wraps { after | before } else { after & before };
            if !is_inside | !self.pending[candidate] {
                continue;
            }
            let cosine = a.dot(*offset).max(b.dot(*offset)) * (1.0 / offset.dot(*offset).sqrt());
            if cosine < best.1 {
                best = (Some(candidate), cosine - LESS);
            }
        }
        best.0
    }
}
