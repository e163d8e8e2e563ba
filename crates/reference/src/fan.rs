//! The new neighbourhood N' of one point while it is refined (section 5). Twins: `new_ring.wgsl`, `choice.wgsl`,
//! `discard.wgsl` and `next_radii.wgsl` in `shaders/shared`.

use crate::angles::{Angles, Directions};
use crate::candidates::Candidates;
use crate::insertion::{COVER, HYSTERESIS, LESS, SMALLEST_SPLIT, Shared, Stage, raise};
use crate::lists::{choose, insertion_sort, offer};
use crate::math::{PI, TAU, is_apart, unit};
use crate::pairs::Center;
use crate::pn_triangle::Corner;
use crate::visible::same_side;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

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
pub(crate) struct Fan {
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

impl Fan {
    /// Starts N' with the new points nearer than λ1·r, and Y with the others nearer than r (eq. 10).
    pub(crate) fn gather(
        &mut self,
        stage: Stage<'_>,
        p: usize,
        samples: &[Sample],
        states: &[AtomicU32],
        limit: u32,
        directions: &mut Directions,
    ) {
        let Stage { level, rings, candidates, conflicts, .. } = stage;
        self.p = p;
        self.on_curve = level.record(p).is_some();
        self.center = Center::of(level, p);
        let (radius, near) = (self.center.radius, candidates.near[p]);
        self.ring.clear();
        self.outer.clear();
        let is_there = |c: u32| states[c as usize].load(Relaxed) < limit;
        for &c in choose(conflicts.around.of(p), is_there, &mut self.there) {
            let new = self.center.member(c, &samples[c as usize]);
            let d2 = new.offset.dot(new.offset);
            // A new point in the centre's own place has no direction: it can only discard.
            if d2 < near * near && is_apart(d2, radius) {
                self.ring.push(new);
            } else if d2 < radius * radius {
                self.outer.push(new);
            }
        }
        self.add_bounds(stage);
        self.own.clear();
        for c in candidates.own(rings, p) {
            let own = self.center.member(c as u32, &samples[c]);
            let d2 = own.offset.dot(own.offset);
            let is_new = is_there(own.id) & (d2 < near * near) & is_apart(d2, radius);
            offer(&mut self.own, own, !is_new);
        }
        self.pending.clear();
        self.pending.resize(self.own.len(), true);
        let (e1, e2) = self.center.frame;
        for members in [&self.ring, &self.outer, &self.own] {
            let places = members.iter().map(|m| (m.offset.dot(e1), m.offset.dot(e2)));
            places.for_each(|(x, y)| directions.ask(x, y));
        }
    }

    /// Where a step keeps the curves, the neighbours of a point along them bound its gaps, though they are not new.
    fn add_bounds(&mut self, stage: Stage<'_>) {
        let level = stage.level;
        let Some(record) = level.record(self.p) else { return };
        if !stage.params.rules.curve_bounds || !level.keeps_curves() {
            return;
        }
        let features = level.curves.iter().map(|curves| &curves.features);
        let partners = features
            .flat_map(|f| record.partners.iter().filter_map(|&r| f.records.get(r as usize)));
        for point in partners.map(|partner| partner.point) {
            let id = stage.candidates.len() as u32 + point;
            let (position, normal) =
                (level.positions[point as usize], level.normals[point as usize]);
            self.ring.push(self.center.member(id, &Sample { position, normal, sphere: 0.0 }));
        }
    }

    /// Takes the angles that [`Fan::gather`] asked for, and asks for all gaps.
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

    /// Directed angle on the tangent plane from member `i` to the next one, in [0, 2π]. A sheet that ends at the centre has
    /// no next one after the last.
    fn directed_gap(&self, i: usize) -> f32 {
        if self.on_curve && i + 1 == self.ring.len() {
            TAU
        } else if i + 1 == self.ring.len() {
            (self.ring[0].angle + TAU) - self.ring[i].angle
        } else {
            self.ring[i + 1].angle - self.ring[i].angle
        }
    }

    fn next(&self, i: usize) -> usize {
        if i + 1 == self.ring.len() { 0 } else { i + 1 }
    }

    /// Asks for the angles from some members to the next ones: curved (eq. 5), or plain; directed from π on.
    fn ask_gaps(&mut self, members: impl IntoIterator<Item = usize>, gaps: &mut Angles) {
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
    fn widest_gap(&self) -> usize {
        let mut widest = 0;
        for i in 1..self.ring.len() {
            if self.ring[i].gap > self.ring[widest].gap * HYSTERESIS {
                widest = i;
            }
        }
        widest
    }

    /// Tries one candidate: that which splits the widest gap, until none is as wide as `θ_c` or none is left. Returns it if it was
    /// inserted.
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

    /// The candidate that is tried next.
    fn choose(&mut self, theta_c: f32) -> Option<usize> {
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

    /// The candidate strictly inside gap `i` whose smaller angle to the two ends is the largest: angles are compared by their
    /// cosines.
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

    /// The new point of Y or N' whose discard sphere (eq. 11) holds the candidate: the closest of them, if any.
    fn discarded_by(&self, stage: Stage<'_>, candidate: &Member) -> Option<Member> {
        let mut closest: Option<(&Member, f32)> = None;
        for members in [&self.outer, &self.ring] {
            for h in members {
                let d = candidate.offset - h.offset;
                let d2 = d.dot(d);
                // Members that only bound gaps have no sphere.
                if d2 < h.sphere * h.sphere
                    && same_side(stage.params.rules, candidate.normal, h.normal)
                    && closest.is_none_or(|(c, least)| d2 < least || (d2 == least && h.id < c.id))
                {
                    closest = Some((h, d2));
                }
            }
        }
        closest.map(|(h, _)| *h)
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

    /// New radii. That of the centre covers N', and stays where there are no new neighbours. The members of N' cover the centre
    /// and their two neighbours in N'.
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

/// Whether a member comes before another by angle; ties by index.
fn precedes(a: &Member, b: &Member) -> bool {
    a.angle < b.angle || (a.angle == b.angle && a.id < b.id)
}
