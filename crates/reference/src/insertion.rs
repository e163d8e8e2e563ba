//! The insertion of new points (section 5), class by class. Twin: `shaders/insertion.wgsl`.
//!
//! Radii of the discard test are frozen at insertion and all other radii are maxima, so the points of one class give
//! the same result together, in ascending or in descending order: that of the paper's sequential loop over
//! (class, index).

use crate::Level;
use crate::candidates::Candidates;
use crate::coloring::Classes;
use crate::conflicts::Conflicts;
use crate::math::{PI, TAU, angle_between, direction_angle, is_apart, unit};
use crate::neighborhood::Rings;
use crate::pn_triangle::{Corner, curved_angle};
use crate::visible::same_side;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use surfine_points::RefineParams;

/// Radii exceed the distances they must cover by this factor, so that rounding can't lose the farthest ring.
pub const COVER: f32 = 1.02;
/// A gap or an angle must be wider by this factor to be preferred to an earlier one: regular grids tie.
pub const HYSTERESIS: f32 = 1.0 + 1e-5;
/// A candidate nearer than 1e-3 radians to an end of its gap, here its cosine, does not split it.
pub const SMALLEST_SPLIT: f32 = 0.999_999_5;
/// A cosine must be less by this to be preferred to an earlier one.
pub const LESS: f32 = 1e-5;

/// The order in which the points of one class are refined. All give the same result; tests hold that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// All at once, on all cores.
    #[default]
    Together,
    /// One after the other by index, each seeing those before it.
    Ascending,
    /// The same from the last index to the first.
    Descending,
}

/// What the insertion decided.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Insertion {
    /// One more than the class that inserted each candidate; 0 for the new points on curves, which come before the first class,
    /// and [`FREE`] for what was not inserted.
    pub states: Vec<u32>,
    /// Radius of each inserted candidate as a point of the next level.
    pub candidate_radii: Vec<f32>,
    /// Radius of each old point at the next level.
    pub radii: Vec<f32>,
}

/// State of a candidate that is not inserted.
pub const FREE: u32 = u32::MAX;

impl Insertion {
    /// Whether a candidate was inserted.
    pub fn is_inserted(&self, c: usize) -> bool {
        self.states[c] != FREE
    }
}

/// Everything that the insertion reads.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// The points of this level.
    pub level: &'a Level,
    /// Their rings.
    pub rings: &'a Rings,
    /// The candidates of their fans.
    pub candidates: &'a Candidates,
    /// What is around each point.
    pub conflicts: &'a Conflicts,
    /// The parameters.
    pub params: &'a RefineParams,
}

/// What the points of a class write. Nobody else of the class reads it, and maxima have no order: so the threads need none.
struct Shared {
    states: Vec<AtomicU32>,
    /// Bits of the radii, which are ordered like their values.
    candidate_radii: Vec<AtomicU32>,
    radii: Vec<AtomicU32>,
}

/// Refines all points, class by class.
pub fn insertion(stage: Stage<'_>, classes: &Classes, order: Order) -> Insertion {
    let on_curve = stage.candidates.first_on_curve;
    let free = (0..on_curve).map(|_| (FREE, 0.0));
    let curve_points = stage.level.curve_points.iter().map(|point| (0, point.radius));
    let candidates = free.chain(curve_points);
    let shared = Shared {
        states: candidates.clone().map(|(state, _)| AtomicU32::new(state)).collect(),
        candidate_radii: candidates.map(|(_, radius)| AtomicU32::new(radius.to_bits())).collect(),
        radii: (0..stage.level.len()).map(|_| AtomicU32::new(0)).collect(),
    };
    for (class, members) in (1..).zip(&classes.members) {
        let refine = |scratch: &mut Scratch, &p: &u32| {
            // One after the other, the points of a class see what those before them inserted.
            let limit = if order == Order::Together { class } else { class + 1 };
            Fan::new(stage, p as usize, scratch).refine(&shared, class, limit);
        };
        match order {
            Order::Together => members.par_iter().for_each_init(Scratch::default, refine),
            Order::Ascending => {
                members.iter().for_each(|p| refine(&mut Scratch::default(), p));
            }
            Order::Descending => {
                members.iter().rev().for_each(|p| refine(&mut Scratch::default(), p));
            }
        }
    }
    let floats = |bits: Vec<AtomicU32>| {
        bits.into_iter().map(|bits| f32::from_bits(bits.into_inner())).collect()
    };
    Insertion {
        states: shared.states.into_iter().map(AtomicU32::into_inner).collect(),
        candidate_radii: floats(shared.candidate_radii),
        radii: floats(shared.radii),
    }
}

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

/// What a thread uses again for the next point.
#[derive(Default)]
struct Scratch {
    /// N', by angle; ties by index.
    ring: Vec<Member>,
    /// `Y_p` (eq. 10).
    outer: Vec<Member>,
    /// The candidates of the fan that were not tried yet.
    pending: Vec<Member>,
}

/// The neighbourhood of one point while it is refined.
struct Fan<'a> {
    stage: Stage<'a>,
    p: usize,
    /// Whether the centre lies on a crease or a boundary, where its sheet ends.
    on_curve: bool,
    center: Vec3,
    e1: Vec3,
    e2: Vec3,
    radius: f32,
    inverse_radius: f32,
    ring: &'a mut Vec<Member>,
    outer: &'a mut Vec<Member>,
    pending: &'a mut Vec<Member>,
}

impl<'a> Fan<'a> {
    fn new(stage: Stage<'a>, p: usize, scratch: &'a mut Scratch) -> Self {
        let (e1, e2) = stage.level.frame(p);
        let radius = stage.level.radii[p];
        let Scratch { ring, outer, pending } = scratch;
        Self {
            stage,
            p,
            on_curve: stage.level.record(p).is_some(),
            center: stage.level.positions[p],
            e1,
            e2,
            radius,
            inverse_radius: 1.0 / radius,
            ring,
            outer,
            pending,
        }
    }

    /// Completes the new neighbourhood N' (section 5) and notes what was inserted.
    fn refine(mut self, shared: &Shared, class: u32, limit: u32) {
        self.gather(shared, limit);
        while let Some(chosen) = self.choose() {
            // Each candidate is tried once.
            let candidate = self.pending.remove(chosen);
            match self.discarded_by(&candidate) {
                None => {
                    shared.states[candidate.id as usize].store(class, Relaxed);
                    self.add(candidate);
                }
                Some(h) if self.can_join(&h) => self.add(h),
                Some(_) => {}
            }
        }
        self.store_radii(shared);
    }

    fn member(&self, id: u32, position: Vec3, normal: Vec3, sphere: f32) -> Member {
        let offset = position - self.center;
        let angle = direction_angle(offset.dot(self.e2), offset.dot(self.e1));
        Member { id, offset, normal, angle, gap: 0.0, sphere }
    }

    fn candidate(&self, c: usize) -> Member {
        let Candidates { positions, normals, rho, .. } = self.stage.candidates;
        self.member(c as u32, positions[c], normals[c], self.stage.params.lambda2 * rho[c])
    }

    /// Starts N' with the new points nearer than λ1·r, and Y with the others nearer than r (eq. 10).
    fn gather(&mut self, shared: &Shared, limit: u32) {
        let (radius, near) = (self.radius, self.stage.candidates.near[self.p]);
        self.ring.clear();
        self.outer.clear();
        for &c in self.stage.conflicts.around.of(self.p) {
            if shared.states[c as usize].load(Relaxed) >= limit {
                continue;
            }
            let new = self.candidate(c as usize);
            let d2 = new.offset.dot(new.offset);
            // A new point in the centre's own place has no direction: it can only discard.
            if d2 < near * near && is_apart(d2, radius) {
                self.ring.push(new);
            } else if d2 < radius * radius {
                self.outer.push(new);
            }
        }
        self.add_bounds();
        self.ring.sort_unstable_by(|a, b| a.angle.total_cmp(&b.angle).then(a.id.cmp(&b.id)));
        for i in 0..self.ring.len() {
            self.ring[i].gap = self.gap(i);
        }
        self.pending.clear();
        for c in self.stage.candidates.own(self.stage.rings, self.p) {
            self.pending.push(self.candidate(c));
        }
    }

    /// Where a step keeps the curves, the neighbours of a point along them bound its gaps, though they are not new.
    fn add_bounds(&mut self) {
        let level = self.stage.level;
        let Some(record) = level.record(self.p) else { return };
        if !self.stage.params.rules.curve_bounds || !level.keeps_curves() {
            return;
        }
        let features = level.curves.iter().map(|curves| &curves.features);
        let partners = features
            .flat_map(|f| record.partners.iter().filter_map(|&r| f.records.get(r as usize)));
        for point in partners.map(|partner| partner.point) {
            let id = self.stage.candidates.len() as u32 + point;
            let (position, normal) =
                (level.positions[point as usize], level.normals[point as usize]);
            self.ring.push(self.member(id, position, normal, 0.0));
        }
    }

    /// Whether a member is no new point and only bounds gaps.
    fn is_bound(&self, member: &Member) -> bool {
        member.id as usize >= self.stage.candidates.len()
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

    /// Angle from member `i` to the next one: curved (eq. 5), or plain; directed from π on.
    fn gap(&self, i: usize) -> f32 {
        if self.on_curve && i + 1 == self.ring.len() {
            return 0.0;
        }
        let directed = self.directed_gap(i);
        if directed >= PI {
            return directed;
        }
        let corner = |member: Member| Corner {
            position: member.offset * self.inverse_radius,
            normal: member.normal,
        };
        let (a, b) = (corner(self.ring[i]), corner(self.ring[self.next(i)]));
        if self.stage.params.effective_plain_angle() {
            angle_between(a.position, b.position)
        } else {
            curved_angle(a, b)
        }
    }

    /// The candidate that is tried next: that which splits the widest gap, until none is as wide as `θ_c` or none is left.
    fn choose(&mut self) -> Option<usize> {
        if self.ring.is_empty() {
            return self.closest();
        }
        loop {
            let widest = self.widest_gap();
            if self.ring[widest].gap < self.stage.params.theta_c {
                return None;
            }
            let best = self.best_split(widest);
            if best.is_some() {
                return best;
            }
            self.ring[widest].gap = 0.0;
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

    /// For an empty N': the candidate closest to the centre, the first of equals.
    fn closest(&self) -> Option<usize> {
        let mut best: Option<(usize, f32)> = None;
        for (i, candidate) in self.pending.iter().enumerate() {
            let d2 = candidate.offset.dot(candidate.offset);
            let closer = best.is_none_or(|(_, least)| d2 * HYSTERESIS < least);
            if is_apart(d2, self.radius) && closer {
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
        for (candidate, Member { offset, angle, .. }) in self.pending.iter().enumerate() {
            let (after, before) = (*angle > from.angle, *angle < to.angle);
            if !(if wraps { after || before } else { after && before }) {
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
    fn discarded_by(&self, candidate: &Member) -> Option<Member> {
        let mut closest: Option<(&Member, f32)> = None;
        for h in self.outer.iter().chain(self.ring.iter()) {
            let d = candidate.offset - h.offset;
            let d2 = d.dot(d);
            // Members that only bound gaps have no sphere.
            if d2 < h.sphere * h.sphere
                && same_side(self.stage.params.rules, candidate.normal, h.normal)
                && closest.is_none_or(|(c, least)| d2 < least || (d2 == least && h.id < c.id))
            {
                closest = Some((h, d2));
            }
        }
        closest.map(|(h, _)| *h)
    }

    /// Whether a new point is not yet in N' and not in the centre's own place.
    fn can_join(&self, h: &Member) -> bool {
        self.ring.iter().all(|m| m.id != h.id) && is_apart(h.offset.dot(h.offset), self.radius)
    }

    /// Adds a new point to N' and measures the two gaps that it makes.
    fn add(&mut self, new: Member) {
        let precedes = |m: &Member| m.angle < new.angle || (m.angle == new.angle && m.id < new.id);
        let at = self.ring.partition_point(precedes);
        self.ring.insert(at, new);
        let before = if at == 0 { self.ring.len() - 1 } else { at - 1 };
        self.ring[before].gap = self.gap(before);
        self.ring[at].gap = self.gap(at);
    }

    /// New radii. That of the centre covers N', and stays where there are no new neighbours. The members of N' cover the centre
    /// and their two neighbours in N'.
    fn store_radii(&self, shared: &Shared) {
        let cover = |member: &Member, d: Vec3| {
            let radius = COVER * d.dot(d).sqrt();
            shared.candidate_radii[member.id as usize].fetch_max(radius.to_bits(), Relaxed);
        };
        let mut farthest = 0.0f32;
        for (i, member) in self.ring.iter().enumerate().filter(|(_, m)| !self.is_bound(m)) {
            farthest = farthest.max(member.offset.dot(member.offset));
            cover(member, member.offset);
            let next = &self.ring[self.next(i)];
            if self.directed_gap(i) < PI && !self.is_bound(next) {
                let side = next.offset - member.offset;
                cover(member, side);
                cover(next, side);
            }
        }
        let radius = if farthest == 0.0 { self.radius } else { COVER * farthest.sqrt() };
        shared.radii[self.p].store(radius.to_bits(), Relaxed);
    }
}
