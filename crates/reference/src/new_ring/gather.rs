//! What a new neighbourhood starts with (section 5, eq. 10). Twin: `shaders/shared/gather.wgsl`.

use super::{NewRing, Sample};
use crate::angles::Directions;
use crate::insertion::Stage;
use crate::lists::{choose, offer};
use crate::math::is_apart;
use crate::pairs::Center;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

impl NewRing {
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
}
