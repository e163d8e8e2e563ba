//! Candidates `L_p` (section 5, eq. 12): one for each triangle of the fans. Twins: `shaders/candidates*.wgsl`.
//!
//! Most triangles are in the fans of all three corners. They are one candidate, which all of these may insert. It belongs to the
//! first corner, from the smallest index on, whose fan has the triangle.

use crate::columns::BLOCK;
use crate::lists::Lists;
use crate::math::TAU;
use crate::neighborhood::Rings;
use crate::triangles::{self, NewPoints, Triangles};
use crate::visible::Seen;
use crate::{Level, NO_POINT};
use glam::Vec3;
use rayon::prelude::*;
use surfine_features::Record;
use surfine_points::RefineParams;

/// A fan triangle needs a gap below π(1 - 1e-4) radians: at π the fan has no triangle there.
pub const WIDEST_GAP: f32 = surfine_features::STRAIGHT;

/// A triangle between a point and both its neighbours on a curve has a gap of no more than 150°, but at corners, radians.
pub const WIDEST_SHEET: f32 = 2.617_994;

/// Radii exceed the distance to the farthest natural neighbour by this factor.
pub const NATURAL: f32 = 1.25;

/// The possible new points of all fans, by the slots to which they belong, then the new points on creases and boundaries,
/// which are inserted in any case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Position during this step: displaced by φ, or the centre of gravity if `simplified`.
    pub positions: Vec<Vec3>,
    /// Normal: of the curved triangle, or of the flat one if `simplified`.
    pub normals: Vec<Vec3>,
    /// `ρ`: largest distance to the three corners, or -1 where the triangle has no candidate.
    pub rho: Vec<f32>,
    /// The corners, smallest index first and orientation kept; of a point on a curve those between which it lies.
    pub corners: Vec<[u32; 3]>,
    /// The candidate of each slot; [`NO_POINT`] for slots without a triangle.
    pub of_slot: Vec<u32>,
    /// Of each point: within this distance new points are new neighbours (section 5).
    pub near: Vec<f32>,
    /// The first of the new points on creases and boundaries.
    pub first_on_curve: usize,
}

impl Candidates {
    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.rho.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rho.is_empty()
    }

    /// A candidate as others see it.
    pub fn seen(&self, c: usize, level: &Level) -> Seen {
        let (position, normal) = (self.positions[c], self.normals[c]);
        let rank = c.checked_sub(self.first_on_curve);
        let record = match (rank, &level.curves) {
            (Some(rank), Some(curves)) => (curves.features.old + rank) as u32,
            _ => NO_POINT,
        };
        Seen { position, normal, record }
    }

    /// Whether the triangle has a candidate.
    pub fn exists(&self, c: usize) -> bool {
        self.rho[c] > 0.0
    }

    /// The candidates of a point's own fan, `L_p`.
    pub fn own<'a>(&'a self, rings: &Rings, p: usize) -> impl Iterator<Item = usize> + Clone + 'a {
        let slots = self.of_slot[rings.slots(p)].iter();
        slots.filter(|&&c| c != NO_POINT).map(|&c| c as usize).filter(|&c| self.exists(c))
    }
}

/// Computes the candidates of every fan, and takes the new points on curves.
pub fn candidates(level: &Level, rings: &Rings, params: &RefineParams) -> Candidates {
    let homes = homes(level, rings);
    let (of_slot, corners) = number(level, rings, &homes);
    let near = |p| near_radius(level, rings, params, p);
    let near = (0..level.len()).into_par_iter().map(near).collect();
    let mut result = Candidates {
        positions: vec![Vec3::ZERO; corners.len()],
        normals: vec![Vec3::ZERO; corners.len()],
        rho: vec![0.0; corners.len()],
        first_on_curve: corners.len(),
        corners,
        of_slot,
        near,
    };
    result.find_all(level, params);
    for point in &level.curve_points {
        result.positions.push(point.position);
        result.normals.push(point.normal);
        result.rho.push(point.rho);
        result.corners.push(point.parents);
    }
    result
}

impl Candidates {
    /// Finds position, normal and ρ of the candidates of all triangles.
    fn find_all(&mut self, level: &Level, params: &RefineParams) {
        let formula = match (params.simplified, params.rules.sliver_normals) {
            (true, _) => triangles::simplified_points,
            (false, true) => triangles::new_points,
            (false, false) => triangles::literal_points,
        };
        let chunks = (self.positions.par_chunks_mut(BLOCK))
            .zip(self.normals.par_chunks_mut(BLOCK))
            .zip(self.rho.par_chunks_mut(BLOCK))
            .zip(self.corners.par_chunks(BLOCK));
        let scratch = || (Triangles::EMPTY, NewPoints::EMPTY);
        chunks.with_min_len(32).for_each_init(scratch, |(triangles, new), chunk| {
            let (((positions, normals), rho), corners) = chunk;
            triangles.gather(level, corners);
            formula(triangles, params.rules, new);
            for i in 0..corners.len() {
                (positions[i], normals[i]) = (new.positions.get(i), new.normals.get(i));
            }
            rho.copy_from_slice(&new.rho[..corners.len()]);
        });
    }
}

/// For each slot the slot to which its triangle belongs; [`NO_POINT`] for slots without a triangle.
fn homes(level: &Level, rings: &Rings) -> Vec<u32> {
    let homes = Lists::make(level.len(), |p, homes| {
        homes.items.extend((0..rings.ring(p).len()).map(|i| {
            match fan_triangle(level, rings, p, i) {
                Some(corners) => home(level, rings, corners, rings.slots(p).start + i),
                None => NO_POINT,
            }
        }));
    });
    homes.items
}

/// The slot of a triangle in the fan of the first of its corners that has it; `own` is one that is known.
fn home(level: &Level, rings: &Rings, [a, b, c]: [u32; 3], own: usize) -> u32 {
    for [p, from, to] in [[a, b, c], [b, c, a]] {
        let slots = rings.slots(p as usize);
        if slots.contains(&own) {
            break;
        }
        let ring = rings.ring(p as usize);
        let place = ring.iter().position(|entry| entry.id == from);
        let follows = |i: &usize| ring[if i + 1 == ring.len() { 0 } else { i + 1 }].id == to;
        let is_triangle = |i: &usize| fan_triangle(level, rings, p as usize, *i).is_some();
        if let Some(i) = place.filter(follows).filter(is_triangle) {
            return (slots.start + i) as u32;
        }
    }
    own as u32
}

/// Numbers the triangles by the slots to which they belong: the number of each slot's, and their corners.
fn number(level: &Level, rings: &Rings, homes: &[u32]) -> (Vec<u32>, Vec<[u32; 3]>) {
    let triangles = Lists::make(level.len(), |p, triangles| {
        for (i, slot) in rings.slots(p).enumerate().filter(|&(_, slot)| homes[slot] == slot as u32)
        {
            let corners = fan_triangle(level, rings, p, i).expect("a home has a triangle");
            triangles.items.push((slot as u32, corners));
        }
    });
    let mut numbers = vec![NO_POINT; rings.len()];
    for (number, &(slot, _)) in (0..).zip(&triangles.items) {
        numbers[slot as usize] = number;
    }
    let of_slot =
        homes.par_iter().map(|&home| numbers.get(home as usize).copied().unwrap_or(NO_POINT));
    (of_slot.collect(), triangles.items.iter().map(|&(_, corners)| corners).collect())
}

/// `λ1 r`. The radii of the input may be too large, and would take far points for new neighbours: in the first step they
/// count as no more than [`NATURAL`] times the distance to the farthest neighbour.
fn near_radius(level: &Level, rings: &Rings, params: &RefineParams, p: usize) -> f32 {
    let radius = level.radii[p];
    if !params.rules.first_radii || level.step > 0 || rings.ring(p).is_empty() {
        return params.lambda1 * radius;
    }
    let mut farthest = 0.0f32;
    for entry in rings.ring(p) {
        let d = level.positions[entry.id as usize] - level.positions[p];
        farthest = farthest.max(d.dot(d));
    }
    params.lambda1 * radius.min(NATURAL * farthest.sqrt())
}

/// The corners of a fan triangle, smallest index first and orientation kept, so that the copies of one triangle in
/// three fans are computed alike. `None` if the gap is not below π, or goes around the end of a crease point's sheet.
pub fn fan_triangle(level: &Level, rings: &Rings, p: usize, i: usize) -> Option<[u32; 3]> {
    let ring = rings.ring(p);
    let last = i + 1 == ring.len();
    let (a, b) = (ring[i], if last { ring[0] } else { ring[i + 1] });
    let gap = if last { (b.angle + TAU) - a.angle } else { b.angle - a.angle };
    if gap >= WIDEST_GAP {
        return None;
    }
    if let Some(record) = level.record(p)
        && (last || spans_sheet(level, record, a.id, b.id, gap))
    {
        return None;
    }
    Some(canonical([p as u32, a.id, b.id]))
}

/// Whether a triangle lies between a curve's point and both its neighbours there, almost in a line: a sheet does not end so.
fn spans_sheet(level: &Level, record: &Record, a: u32, b: u32, gap: f32) -> bool {
    let is_partner = |id: u32, k: usize| {
        let partner = record.partners[k];
        partner != NO_POINT && level.seen(id as usize).record == partner
    };
    record.sides < 3 && gap > WIDEST_SHEET && is_partner(a, 0) && is_partner(b, 1)
}

/// The triangle turned until its smallest index comes first.
fn canonical([a, b, c]: [u32; 3]) -> [u32; 3] {
    debug_assert!(a != NO_POINT && b != NO_POINT && c != NO_POINT);
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
