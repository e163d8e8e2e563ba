//! Radii that cover the next level's rings (ours). Twin: `shaders/next_ring.wgsl`.
//!
//! The paper's new radius covers the new neighbours N' alone. On irregular samples the ring of a point at the next level
//! also has old points in it, and triangles that N' does not know. So the ring is looked up ahead: the members of the
//! old ring and the new points nearby go through the filter of section 4, and what is left must be within the radii, of
//! the point and of the members alike.

use crate::Level;
use crate::insertion::{COVER, Insertion, Stage};
use crate::math::{PI, TAU, direction_angle, is_apart};
use crate::neighborhood::{Neighbor, is_behind};
use crate::visible::View;
use glam::Vec3;
use rayon::prelude::*;

/// Radii that the next level's rings ask for, 0 where they ask for none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Covers {
    /// Of the old points.
    pub radii: Vec<f32>,
    /// Of the inserted candidates.
    pub slot_radii: Vec<f32>,
}

/// Finds the radii that cover the next level's rings; none if the rule is off.
pub fn next_ring(stage: Stage<'_>, insertion: &Insertion) -> Covers {
    let points = stage.level.len();
    let mut result =
        Covers { radii: vec![0.0; points], slot_radii: vec![0.0; stage.candidates.len()] };
    if !stage.params.rules.next_ring {
        return result;
    }
    let covers = |p| covers(stage, insertion, p);
    let covers: Vec<Vec<(u32, f32)>> = (0..points).into_par_iter().map(covers).collect();
    for (id, radius) in covers.into_iter().flatten() {
        let own = match (id as usize).checked_sub(points) {
            Some(slot) => &mut result.slot_radii[slot],
            None => &mut result.radii[id as usize],
        };
        *own = own.max(radius);
    }
    result
}

/// Radii that the next ring of a point asks for. Members are old points by index, then slots.
fn covers(stage: Stage<'_>, insertion: &Insertion, p: usize) -> Vec<(u32, f32)> {
    let Stage { level, rings, candidates, .. } = stage;
    let (center, normal) = (level.positions[p], level.normals[p]);
    let radius = insertion.radii[p];
    let mut around = Around::new(stage, p);
    let view = View::new(level, p, radius, stage.params.rules);
    for entry in rings.ring(p) {
        let i = entry.id as usize;
        around.add(entry.id, level.positions[i], level.normals[i]);
    }
    stage.candidate_grid.visit_ball(center, radius, |slot| {
        let i = slot as usize;
        let d = candidates.positions[i] - center;
        let near = d.dot(d) <= radius * radius;
        let sees = insertion.inserted[i] && near && stage.same_side(candidates.normals[i], normal);
        if sees && view.sees(candidates.seen(i, level)) {
            around.add(level.len() as u32 + slot, candidates.positions[i], candidates.normals[i]);
        }
    });
    around.covers(p as u32)
}

/// Points around a centre on its tangent plane.
struct Around<'a> {
    stage: Stage<'a>,
    /// Whether the centre lies on a crease or a boundary, where its sheet ends.
    on_curve: bool,
    center: Vec3,
    normal: Vec3,
    e1: Vec3,
    e2: Vec3,
    inverse: f32,
    radius: f32,
    members: Vec<Neighbor>,
    offsets: Vec<Vec3>,
}

impl<'a> Around<'a> {
    fn new(stage: Stage<'a>, p: usize) -> Self {
        let Level { positions, normals, radii, .. } = stage.level;
        let (e1, e2) = stage.level.frame(p);
        let (center, normal, radius) = (positions[p], normals[p], radii[p]);
        let (members, offsets) = (Vec::new(), Vec::new());
        let on_curve = stage.level.record(p).is_some();
        Self {
            stage,
            on_curve,
            center,
            normal,
            e1,
            e2,
            inverse: 1.0 / radius,
            radius,
            members,
            offsets,
        }
    }

    fn add(&mut self, id: u32, position: Vec3, normal: Vec3) {
        let d = position - self.center;
        if !is_apart(d.dot(d), self.radius) {
            return;
        }
        let project = Neighbor::new(
            id,
            d,
            (self.e1, self.e2),
            self.inverse,
            [self.normal, normal],
            self.stage.params,
        );
        if let Some(neighbor) = project {
            self.members.push(neighbor);
            self.offsets.push(d);
        }
    }

    fn covers(&self, p: u32) -> Vec<(u32, f32)> {
        let sin_theta_f = self.stage.params.sin_theta_f();
        let mut ring: Vec<(f32, u32, Vec3)> = (0..self.members.len())
            .filter(|&i| !is_behind(&self.members, i, sin_theta_f))
            .map(|i| {
                let Neighbor { id, x, y, .. } = self.members[i];
                (direction_angle(y, x), id, self.offsets[i])
            })
            .collect();
        ring.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut covers = Vec::new();
        for (i, &(angle, id, d)) in ring.iter().enumerate() {
            let own = COVER * d.dot(d).sqrt();
            covers.extend([(p, own), (id, own)]);
            let (next_angle, next, next_d) = ring[if i + 1 == ring.len() { 0 } else { i + 1 }];
            let gap =
                if i + 1 == ring.len() { (next_angle + TAU) - angle } else { next_angle - angle };
            let goes_around = self.on_curve && i + 1 == ring.len();
            if gap < PI && !goes_around {
                let side = next_d - d;
                let radius = COVER * side.dot(side).sqrt();
                covers.extend([(id, radius), (next, radius)]);
            }
        }
        covers
    }
}
