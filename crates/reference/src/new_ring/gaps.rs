//! Angles between the members of N' that follow each other (section 5, eq. 5). Twin: `shaders/shared/gaps.wgsl`.

use super::{Member, NewRing};
use crate::angles::Angles;
use crate::insertion::HYSTERESIS;
use crate::math::{PI, TAU};
use crate::pn_triangle::Corner;

impl NewRing {
    /// Directed angle on the tangent plane from member `i` to the next one, in [0, 2π]. A sheet that ends at the centre
    /// has no next one after the last.
    pub(super) fn directed_gap(&self, i: usize) -> f32 {
        if self.on_curve && i + 1 == self.ring.len() {
            TAU
        } else if i + 1 == self.ring.len() {
            (self.ring[0].angle + TAU) - self.ring[i].angle
        } else {
            self.ring[i + 1].angle - self.ring[i].angle
        }
    }

    pub(super) fn next(&self, i: usize) -> usize {
        if i + 1 == self.ring.len() { 0 } else { i + 1 }
    }

    /// Asks for the angles from some members to the next ones: curved (eq. 5), or plain; directed from π on.
    pub(super) fn ask_gaps(&mut self, members: impl IntoIterator<Item = usize>, gaps: &mut Angles) {
        self.gaps.clear();
        self.first_gap = gaps.len();
        for i in members {
            let directed = self.directed_gap(i);
            if self.on_curve && i + 1 == self.ring.len() {
                self.ring[i].gap = 0.0;
            } else if directed >= PI {
                self.ring[i].gap = directed;
            } else {
                let corner = |member: Member| Corner {
                    position: member.offset * self.center.inverse_radius,
                    normal: member.normal,
                };
                gaps.ask_gap(corner(self.ring[i]), corner(self.ring[self.next(i)]));
                self.gaps.push(i);
            }
        }
    }

    /// Takes the gaps that were asked for.
    pub(crate) fn take_gaps(&mut self, gaps: &Angles) {
        for (at, &i) in (self.first_gap..).zip(&self.gaps) {
            self.ring[i].gap = gaps.get(at);
        }
    }

    /// The first of the widest gaps.
    pub(super) fn widest_gap(&self) -> usize {
        let mut widest = 0;
        for i in 1..self.ring.len() {
            if self.ring[i].gap > self.ring[widest].gap * HYSTERESIS {
                widest = i;
            }
        }
        widest
    }
}
