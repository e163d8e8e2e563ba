//! What a point sees when there are creases and boundaries (section 6). Twins: `visible.wgsl`, `segments.wgsl` and
//! `same_side.wgsl` in `shaders/shared`.
//!
//! The paper splits a crease point's neighbourhood by the most similar normal. That is not enough: eq. 6 never rejects
//! a pair across an edge of 90°, so fans would cross the crease. Here points see each other only if they lie on one
//! sheet as far as the curves nearby can tell. It filters `N^E` and who discards whom, by the paper's loop N' and Y; no
//! step averages across a crease.

mod fences;

pub use fences::FENCE_REACH;

use crate::Level;
use crate::math::{direction_angle, is_apart};
use glam::Vec3;
use surfine_features::{Features, NONE, Record};
use surfine_points::{Grid, Rules};

/// Squared distances below have no direction: the smallest normal numbers are near.
pub const SAME_PLACE: f32 = 1e-37;
/// A point belongs to a side only if their normals differ by less than this cosine says,
pub const LIKE: f32 = 0.3;
/// the sine of its elevation over the side's tangent plane is below this,
pub const STEEP: f32 = 0.75;
/// and it does not lie behind the side by more than this cosine.
pub const BEHIND: f32 = -0.35;
/// Crease points see each other if neither lies behind the other by more than this cosine.
pub const CREASE_BEHIND: f32 = -0.3;

/// The curves of a level, ready for queries.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// Records and segments.
    pub features: Features,
    /// The record of each point of the level, or [`NONE`].
    pub record_of: Vec<u32>,
    /// Segments by the cell of their middle.
    grid: Grid,
    /// Half of the longest segment.
    reach: f32,
    /// Points of a larger cosine between their normals lie on one side of every crease.
    softest: f32,
}

/// A point of the level or a new one, as others see it.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// Position.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Its record, or [`NONE`].
    pub record: u32,
}

impl Curves {
    /// The curves of a level of so many points.
    pub fn new(features: Features, points: usize) -> Self {
        let (grid, reach) = features.segment_grid();
        let record_of = features.by_point(points);
        let softest = features.softest();
        Self { features, record_of, grid, reach, softest }
    }

    fn record(&self, index: u32) -> &Record {
        &self.features.records[index as usize]
    }

    /// The side of a crease point on which another point lies, if any; for a boundary point itself, if the
    /// other one lies in its fan.
    fn side(&self, of: u32, other: Seen, rules: Rules) -> u32 {
        let d = other.position - self.record(of).position;
        let d2 = d.dot(d);
        if d2 < SAME_PLACE {
            return NONE;
        }
        let u = d * (1.0 / d2.sqrt());
        if self.record(of).is_boundary() {
            let like = other.normal.dot(self.record(of).normal) > LIKE;
            return if like && in_wedge(self.record(of), d) { of } else { NONE };
        }
        let sides = self.features.sides_of(of);
        let mut best = (sides.start as u32, 0.0);
        for k in sides.clone() {
            let Record { normal, conormal, .. } = self.features.records[k];
            let score = other.normal.dot(normal) + u.dot(conormal);
            if k == sides.start || score > best.1 {
                best = (k as u32, score);
            }
        }
        let Record { normal, conormal, .. } = *self.record(best.0);
        let valid = other.normal.dot(normal) > LIKE
            && u.dot(normal).abs() < STEEP
            && u.dot(conormal) > BEHIND;
        if valid || !rules.valid_sides { best.0 } else { NONE }
    }

    /// Whether records of two points see each other. Those next to each other on a curve do on their own side only.
    fn records_see(&self, a: Seen, b: Seen, rules: Rules) -> bool {
        let (r, q) = (*self.record(a.record), *self.record(b.record));
        if r.first == q.first {
            return false;
        }
        let joined = |from: u32, to: &Record| {
            let first = |&p: &u32| p != NONE && self.record(p).first == to.first;
            self.features
                .sides_of(from)
                .any(|k| self.features.records[k].partners.iter().any(first))
        };
        if joined(a.record, &q) || joined(b.record, &r) {
            return r.partners.contains(&b.record) || q.partners.contains(&a.record);
        }
        let d = q.position - r.position;
        let u = d * (1.0 / d.dot(d).sqrt());
        self.side(a.record, b, rules) == a.record
            && self.side(b.record, a, rules) == b.record
            && (r.is_boundary() || u.dot(r.conormal) > CREASE_BEHIND)
            && (q.is_boundary() || -u.dot(q.conormal) > CREASE_BEHIND)
    }
}

/// Whether normals are on one side of the surface, so that their points see each other.
pub(crate) fn same_side(rules: Rules, a: Vec3, b: Vec3) -> bool {
    !rules.own_side || a.dot(b) > 0.0
}

/// Whether a direction lies between the curves that bound a record's sheet, or a little beyond.
pub fn in_wedge(record: &Record, d: Vec3) -> bool {
    let (e1, e2) = record.frame();
    let angle = direction_angle(d.dot(e2), d.dot(e1));
    angle >= record.wedge[0] && angle <= record.wedge[1]
}

/// What one point sees.
pub(crate) struct View<'a> {
    curves: &'a Curves,
    center: Seen,
    /// Segments that may separate it from points within its reach.
    fences: Vec<u32>,
    /// Within this distance.
    radius: f32,
    rules: Rules,
}

impl<'a> View<'a> {
    /// The view of a point, old or new, as far as the radius; `None` where there are no curves, and
    /// every point sees all others.
    pub(crate) fn new(level: &'a Level, center: Seen, radius: f32, rules: Rules) -> Option<Self> {
        let curves = level.curves.as_ref()?;
        let fences = curves.fences(center.position, radius, rules);
        Some(Self { curves, center, fences, radius, rules })
    }

    /// Whether it sees a point within the radius. Off the curves that is easily said.
    #[inline]
    pub(crate) fn sees(&self, other: Seen) -> bool {
        let is_smooth = self.center.record == NONE && other.record == NONE;
        (is_smooth && self.fences.is_empty()) || (self.sides_agree(other) && !self.is_fenced(other))
    }

    /// Whether each of two points, if it lies on a curve, has the other one on its side.
    fn sides_agree(&self, other: Seen) -> bool {
        let d = other.position - self.center.position;
        // In the same place there is nothing between.
        if !is_apart(d.dot(d), self.radius) {
            return self.center.record == NONE || other.record == NONE;
        }
        let Self { curves, rules, .. } = *self;
        match (self.center.record, other.record) {
            (NONE, NONE) => true,
            (r, NONE) => in_wedge(curves.record(r), d) && curves.side(r, other, rules) == r,
            (NONE, r) => curves.side(r, self.center, rules) == r,
            (r, _) => {
                in_wedge(curves.record(r), d) && curves.records_see(self.center, other, rules)
            }
        }
    }
}
