//! Crease segments that run between two points (section 6). Twin: `shaders/shared/fences.wgsl`.

use super::{Curves, Seen, View};
use crate::math::is_apart;
use glam::Vec3;
use surfine_features::NONE;
use surfine_points::Rules;

/// Segments can separate two points if their middle is within this share of the points' distance, and half of the
/// longest segment, from the middle of the points.
pub const FENCE_REACH: f32 = 0.75;

impl Curves {
    /// The segments that may separate a point from others within a radius.
    pub(super) fn fences(&self, center: Vec3, radius: f32, rules: Rules) -> Vec<u32> {
        let mut fences = Vec::new();
        if rules.separating_segments && !self.grid.items.is_empty() {
            let reach = (FENCE_REACH + 0.5) * radius + self.reach;
            self.grid.visit_ball(center, reach, |s, _| fences.push(s));
        }
        fences
    }

    /// Whether a crease segment runs between two points: they lie on different sides of it at an end, and the shortest
    /// way between them over the unfolded sides crosses it.
    fn separates(&self, segment: u32, a: Seen, b: Seen, rules: Rules) -> bool {
        let sides = self.features.segments[segment as usize].sides;
        let ends = sides[0].map(|r| self.record(r));
        let touches = |x: Seen| {
            x.record != NONE
                && (self.record(x.record).segment == segment
                    || ends.iter().any(|end| end.first == self.record(x.record).first))
        };
        if touches(a) || touches(b) || !crosses(ends.map(|end| end.position), a, b) {
            return false;
        }
        (0..2).any(|end| {
            // At a corner either may lie on a third side: this end can't tell then.
            let own = [sides[0][end], sides[1][end]];
            let (side_a, side_b) = (self.side(own[0], a, rules), self.side(own[0], b, rules));
            side_a != side_b && own.contains(&side_a) && own.contains(&side_b)
        })
    }
}

impl View<'_> {
    /// Whether a crease runs between the point and another one within the radius.
    pub(super) fn is_fenced(&self, other: Seen) -> bool {
        let curves = self.curves;
        let d = other.position - self.center.position;
        let d2 = d.dot(d);
        let turns = self.center.normal.dot(other.normal) <= curves.softest;
        if !turns || !is_apart(d2, self.radius) {
            return false;
        }
        let middle = self.center.position + d * 0.5;
        let reach = FENCE_REACH * d2.sqrt() + curves.reach;
        self.fences.iter().any(|&s| {
            let ends = curves.features.segments[s as usize].sides[0];
            let [a, b] = ends.map(|r| curves.record(r).position);
            let off = (a + b) * 0.5 - middle;
            off.dot(off) <= reach * reach && curves.separates(s, self.center, other, self.rules)
        })
    }
}

/// Whether the straight way between two points over the unfolded sides of a segment meets it.
fn crosses([from, to]: [Vec3; 2], a: Seen, b: Seen) -> bool {
    let v = to - from;
    let inverse = 1.0 / v.dot(v);
    let place = |x: Seen| {
        let d = x.position - from;
        let t = d.dot(v) * inverse;
        let off = d - v * t;
        (t, off.dot(off).sqrt())
    };
    let ((ta, ha), (tb, hb)) = (place(a), place(b));
    let crossing = ta * hb + tb * ha;
    crossing >= 0.0 && crossing <= ha + hb
}
