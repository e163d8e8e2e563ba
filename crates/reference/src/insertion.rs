//! The insertion of new points (section 5), class by class. Twin: `shaders/insertion.wgsl`.
//!
//! Radii of the discard test are frozen at insertion and all other radii are maxima, so the points of one class give
//! the same result together, in ascending or in descending order: that of the paper's sequential loop over
//! (class, index).

use crate::Level;
use crate::candidates::Candidates;
use crate::coloring::Classes;
use crate::math::{PI, TAU, angle_between, direction_angle, is_apart};
use crate::neighborhood::Rings;
use crate::pn_triangle::{Corner, curved_angle};
use crate::visible::View;
use glam::Vec3;
use rayon::prelude::*;
use surfine_points::{Grid, RefineParams};

/// Radii exceed the distances they must cover by this factor, so that rounding can't lose the farthest ring.
pub const COVER: f32 = 1.02;
/// A gap or an angle must be wider by this factor to be preferred to an earlier one: regular grids tie.
pub const HYSTERESIS: f32 = 1.0 + 1e-5;
/// A candidate nearer than this to an end of its gap, radians, does not split it.
pub const SMALLEST_SPLIT: f32 = 1e-3;

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
    /// Whether each candidate was inserted.
    pub inserted: Vec<bool>,
    /// Radius of each inserted candidate as a point of the next level.
    pub slot_radii: Vec<f32>,
    /// Radius of each old point at the next level.
    pub radii: Vec<f32>,
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
    /// The existing candidates by cell.
    pub candidate_grid: &'a Grid,
    /// The parameters.
    pub params: &'a RefineParams,
}

impl Stage<'_> {
    /// Whether normals are on one side of the surface, so that their points see each other.
    pub(crate) fn same_side(&self, a: Vec3, b: Vec3) -> bool {
        !self.params.rules.own_side || a.dot(b) > 0.0
    }
}

/// The result of refining one point.
struct Refinement {
    inserted: Vec<u32>,
    radius: f32,
    /// Radii that the members of N' must have at least.
    covers: Vec<(u32, f32)>,
}

/// Refines all points, class by class.
pub fn insertion(stage: Stage<'_>, classes: &Classes, order: Order) -> Insertion {
    let slots = stage.candidates.len();
    let on_curve = stage.candidates.first_on_curve;
    let mut slot_radii = vec![0.0; on_curve];
    slot_radii.extend(stage.level.curve_points.iter().map(|point| point.radius));
    let mut result = Insertion {
        // New points on curves come before the first class.
        inserted: (0..slots).map(|slot| slot >= on_curve).collect(),
        slot_radii,
        radii: stage.level.radii.clone(),
    };
    for members in &classes.members {
        match order {
            Order::Together => {
                let refine = |&p: &u32| (p, refine_point(stage, &result.inserted, p));
                let refinements: Vec<(u32, Refinement)> = members.par_iter().map(refine).collect();
                refinements.into_iter().for_each(|(p, r)| result.apply(p, r));
            }
            Order::Ascending => members.iter().for_each(|&p| {
                let refinement = refine_point(stage, &result.inserted, p);
                result.apply(p, refinement);
            }),
            Order::Descending => members.iter().rev().for_each(|&p| {
                let refinement = refine_point(stage, &result.inserted, p);
                result.apply(p, refinement);
            }),
        }
    }
    result
}

impl Insertion {
    fn apply(&mut self, p: u32, refinement: Refinement) {
        for slot in refinement.inserted {
            self.inserted[slot as usize] = true;
        }
        for (slot, radius) in refinement.covers {
            let own = &mut self.slot_radii[slot as usize];
            *own = own.max(radius);
        }
        self.radii[p as usize] = refinement.radius;
    }
}

/// A member of N', seen from the centre.
#[derive(Clone, Copy)]
struct Member {
    /// A new point's slot; after the last slot come the points of the level, for members that only bound gaps.
    slot: u32,
    /// Angle on the tangent plane.
    angle: f32,
    /// Angle to the next member, or 0 once no candidate splits it.
    gap: f32,
}

/// The neighbourhood of one point while it is refined.
struct Fan<'a> {
    stage: Stage<'a>,
    p: usize,
    view: View<'a>,
    /// Whether the centre lies on a crease or a boundary, where its sheet ends.
    on_curve: bool,
    center: Vec3,
    normal: Vec3,
    /// Within this distance new points are new neighbours.
    near: f32,
    e1: Vec3,
    e2: Vec3,
    radius: f32,
    inverse_radius: f32,
    /// N', by angle; ties by slot.
    ring: Vec<Member>,
    /// `Y_p` (eq. 10).
    outer: Vec<u32>,
}

/// Completes the new neighbourhood N' of one point (section 5).
fn refine_point(stage: Stage<'_>, inserted: &[bool], p: u32) -> Refinement {
    let mut fan = Fan::new(stage, p);
    fan.gather(inserted);
    // Candidates of this fan with their angles; each is tried once.
    let mut pending: Vec<(u32, f32)> = stage
        .rings
        .slots(p as usize)
        .filter(|&s| stage.candidates.exists(s))
        .map(|s| (s as u32, fan.angle_of(s as u32)))
        .collect();
    let mut new = Vec::new();
    loop {
        let chosen = if fan.ring.is_empty() {
            fan.closest(&pending)
        } else {
            let widest = fan.widest_gap();
            if fan.ring[widest].gap < stage.params.theta_c {
                break;
            }
            let best = fan.best_split(widest, &pending);
            if best.is_none() {
                fan.ring[widest].gap = 0.0;
                continue;
            }
            best
        };
        let Some(chosen) = chosen else { break };
        let (slot, angle) = pending.remove(chosen);
        match fan.discarded_by(slot) {
            None => {
                new.push(slot);
                fan.add(slot, angle);
            }
            Some(h) if fan.can_join(h) => fan.add(h, fan.angle_of(h)),
            Some(_) => {}
        }
    }
    Refinement { inserted: new, radius: fan.new_radius(), covers: fan.covers() }
}

impl<'a> Fan<'a> {
    fn new(stage: Stage<'a>, p: u32) -> Self {
        let p = p as usize;
        let normal = stage.level.normals[p];
        let (e1, e2) = stage.level.frame(p);
        let radius = stage.level.radii[p];
        Self {
            stage,
            p,
            view: View::new(stage.level, p, radius, stage.params.rules),
            on_curve: stage.level.record(p).is_some(),
            center: stage.level.positions[p],
            normal,
            near: stage.candidates.near[p],
            e1,
            e2,
            radius,
            inverse_radius: 1.0 / radius,
            ring: Vec::new(),
            outer: Vec::new(),
        }
    }

    /// The point of the level that a member stands for, if it only bounds gaps.
    fn bound(&self, slot: u32) -> Option<usize> {
        (slot as usize).checked_sub(self.stage.candidates.len())
    }

    /// A member relative to the centre.
    fn offset(&self, slot: u32) -> Vec3 {
        let position = match self.bound(slot) {
            Some(point) => self.stage.level.positions[point],
            None => self.stage.candidates.positions[slot as usize],
        };
        position - self.center
    }

    fn normal_of(&self, slot: u32) -> Vec3 {
        match self.bound(slot) {
            Some(point) => self.stage.level.normals[point],
            None => self.stage.candidates.normals[slot as usize],
        }
    }

    fn angle_of(&self, slot: u32) -> f32 {
        let d = self.offset(slot);
        direction_angle(d.dot(self.e2), d.dot(self.e1))
    }

    /// Starts N' with the new points nearer than λ1·r, and Y with the others nearer than r (eq. 10).
    fn gather(&mut self, inserted: &[bool]) {
        let radius = self.radius;
        let near = self.near;
        let mut ring = Vec::new();
        self.stage.candidate_grid.visit_ball(self.center, radius, |slot| {
            let normal = self.stage.candidates.normals[slot as usize];
            if !inserted[slot as usize] || !self.stage.same_side(normal, self.normal) {
                return;
            }
            let d = self.offset(slot);
            let d2 = d.dot(d);
            if d2 >= radius * radius
                || !self.view.sees(self.stage.candidates.seen(slot as usize, self.stage.level))
            {
                return;
            }
            // A new point in the centre's own place has no direction: it can only discard.
            if d2 < near * near && is_apart(d2, radius) {
                ring.push(Member { slot, angle: self.angle_of(slot), gap: 0.0 });
            } else {
                self.outer.push(slot);
            }
        });
        ring.extend(self.bounds());
        ring.sort_by(|a, b| a.angle.total_cmp(&b.angle).then(a.slot.cmp(&b.slot)));
        self.ring = ring;
        for i in 0..self.ring.len() {
            self.ring[i].gap = self.gap(i);
        }
    }

    fn bounds_gaps(&self) -> bool {
        self.stage.params.rules.curve_bounds && self.stage.level.keeps_curves()
    }

    /// Where a step keeps the curves, the neighbours of a point along them bound its gaps, though they are not new.
    fn bounds(&self) -> Vec<Member> {
        let level = self.stage.level;
        let Some(record) = level.record(self.p).filter(|_| self.bounds_gaps()) else {
            return Vec::new();
        };
        let features = level.curves.iter().map(|curves| &curves.features);
        let partners = features
            .flat_map(|f| record.partners.iter().filter_map(|&r| f.records.get(r as usize)));
        let slot = |point: u32| self.stage.candidates.len() as u32 + point;
        partners
            .map(|partner| slot(partner.point))
            .map(|slot| Member { slot, angle: self.angle_of(slot), gap: 0.0 })
            .collect()
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
        let (a, b) = (self.ring[i].slot, self.ring[self.next(i)].slot);
        if self.stage.params.effective_plain_angle() {
            return angle_between(
                self.offset(a) * self.inverse_radius,
                self.offset(b) * self.inverse_radius,
            );
        }
        let corner = |slot: u32| Corner {
            position: self.offset(slot) * self.inverse_radius,
            normal: self.normal_of(slot),
        };
        curved_angle(corner(a), corner(b))
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
    fn closest(&self, pending: &[(u32, f32)]) -> Option<usize> {
        let mut best: Option<(usize, f32)> = None;
        for (i, &(slot, _)) in pending.iter().enumerate() {
            let d = self.offset(slot);
            let d2 = d.dot(d);
            let closer = best.is_none_or(|(_, least)| d2 * HYSTERESIS < least);
            if is_apart(d2, self.radius) && closer {
                best = Some((i, d2));
            }
        }
        best.map(|(i, _)| i)
    }

    /// The candidate strictly inside gap `i` whose smaller angle to the two ends is the largest.
    fn best_split(&self, i: usize, pending: &[(u32, f32)]) -> Option<usize> {
        let from = self.ring[i];
        let to = self.ring[self.next(i)];
        let wraps = i + 1 == self.ring.len();
        let (a, b) = (
            self.offset(from.slot) * self.inverse_radius,
            self.offset(to.slot) * self.inverse_radius,
        );
        let mut best = (None, SMALLEST_SPLIT);
        for (candidate, &(slot, angle)) in pending.iter().enumerate() {
            let after = angle > from.angle;
            let before = angle < to.angle;
            if !(if wraps { after || before } else { after && before }) {
                continue;
            }
            let x = self.offset(slot) * self.inverse_radius;
            let split = angle_between(a, x).min(angle_between(x, b));
            if split > best.1 * HYSTERESIS {
                best = (Some(candidate), split);
            }
        }
        best.0
    }

    /// The new point of Y or N' whose discard sphere (eq. 11) holds the candidate: the closest of them, if any.
    fn discarded_by(&self, slot: u32) -> Option<u32> {
        let x = self.stage.candidates.positions[slot as usize];
        let normal = self.stage.candidates.normals[slot as usize];
        let mut closest: Option<(u32, f32)> = None;
        let ring = self.ring.iter().map(|m| m.slot).filter(|&slot| self.bound(slot).is_none());
        for h in self.outer.iter().copied().chain(ring) {
            let d = x - self.stage.candidates.positions[h as usize];
            let d2 = d.dot(d);
            let sphere = self.stage.params.lambda2 * self.stage.candidates.rho[h as usize];
            if d2 < sphere * sphere
                && self.stage.same_side(normal, self.stage.candidates.normals[h as usize])
                && closest.is_none_or(|(slot, least)| d2 < least || (d2 == least && h < slot))
            {
                closest = Some((h, d2));
            }
        }
        closest.map(|(h, _)| h)
    }

    /// Whether a new point is not yet in N' and not in the centre's own place.
    fn can_join(&self, h: u32) -> bool {
        let d = self.offset(h);
        self.ring.iter().all(|m| m.slot != h) && is_apart(d.dot(d), self.radius)
    }

    /// Adds a new point to N' and measures the two gaps that it makes.
    fn add(&mut self, slot: u32, angle: f32) {
        let at =
            self.ring.partition_point(|m| m.angle < angle || (m.angle == angle && m.slot < slot));
        self.ring.insert(at, Member { slot, angle, gap: 0.0 });
        let before = if at == 0 { self.ring.len() - 1 } else { at - 1 };
        self.ring[before].gap = self.gap(before);
        self.ring[at].gap = self.gap(at);
    }

    /// New radius of the centre: it covers N'. A point without new neighbours keeps its radius.
    fn new_radius(&self) -> f32 {
        let new = self.ring.iter().map(|m| m.slot).filter(|&slot| self.bound(slot).is_none());
        let farthest = new.map(|slot| self.offset(slot)).map(|d| d.dot(d)).fold(0.0, f32::max);
        if farthest == 0.0 { self.radius } else { COVER * farthest.sqrt() }
    }

    /// Radii that the members of N' need to cover the centre and their two neighbours in N'.
    fn covers(&self) -> Vec<(u32, f32)> {
        let mut covers = Vec::new();
        for (i, member) in self.ring.iter().enumerate() {
            if self.bound(member.slot).is_some() {
                continue;
            }
            let d = self.offset(member.slot);
            covers.push((member.slot, COVER * d.dot(d).sqrt()));
            let next = self.ring[self.next(i)].slot;
            if self.directed_gap(i) < PI && self.bound(next).is_none() {
                let d = self.offset(next) - self.offset(member.slot);
                let radius = COVER * d.dot(d).sqrt();
                covers.extend([(member.slot, radius), (next, radius)]);
            }
        }
        covers
    }
}
