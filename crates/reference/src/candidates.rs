//! Candidates `L_p` (section 5, eq. 12): one for each triangle of each fan. Twin: `shaders/candidates.wgsl`.

use crate::math::TAU;
use crate::neighborhood::Rings;
use crate::pn_triangle;
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

/// The possible new points of all fans, one for each ring entry (slot), then the new points on creases and boundaries,
/// which are inserted in any case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Position during this step: displaced by φ, or the centre of gravity if `simplified`.
    pub positions: Vec<Vec3>,
    /// Normal: of the curved triangle, or of the flat one if `simplified`.
    pub normals: Vec<Vec3>,
    /// `ρ`: largest distance to the three corners, or -1 where the slot holds no candidate.
    pub rho: Vec<f32>,
    /// The point whose fan holds the slot; [`NO_POINT`] for a point on a curve.
    pub owners: Vec<u32>,
    /// Of each point: within this distance new points are new neighbours (section 5).
    pub near: Vec<f32>,
    /// The first slot of the new points on creases and boundaries.
    pub first_on_curve: usize,
}

impl Candidates {
    /// Number of slots.
    pub fn len(&self) -> usize {
        self.rho.len()
    }

    /// Whether there are no slots.
    pub fn is_empty(&self) -> bool {
        self.rho.is_empty()
    }

    /// A slot's point as others see it.
    pub fn seen(&self, slot: usize, level: &Level) -> Seen {
        let (position, normal) = (self.positions[slot], self.normals[slot]);
        let rank = slot.checked_sub(self.first_on_curve);
        let record = match (rank, &level.curves) {
            (Some(rank), Some(curves)) => (curves.features.old + rank) as u32,
            _ => NO_POINT,
        };
        Seen { position, normal, record }
    }

    /// Whether the slot holds a candidate.
    pub fn exists(&self, slot: usize) -> bool {
        self.rho[slot] > 0.0
    }
}

/// A slot that holds no candidate.
const NONE: (Vec3, Vec3, f32) = (Vec3::ZERO, Vec3::ZERO, -1.0);

/// Computes the candidates of every fan, and takes the new points on curves.
pub fn candidates(level: &Level, rings: &Rings, params: &RefineParams) -> Candidates {
    let fans: Vec<Vec<(Vec3, Vec3, f32)>> = (0..level.len())
        .into_par_iter()
        .map(|p| {
            let ring = rings.ring(p);
            (0..ring.len()).map(|i| candidate(level, rings, params, p, i)).collect()
        })
        .collect();
    let near = (0..level.len()).map(|p| near_radius(level, rings, params, p)).collect();
    let mut result = Candidates { near, ..Candidates::default() };
    for (p, fan) in fans.into_iter().enumerate() {
        for (position, normal, rho) in fan {
            result.positions.push(position);
            result.normals.push(normal);
            result.rho.push(rho);
            result.owners.push(p as u32);
        }
    }
    result.first_on_curve = result.len();
    for point in &level.curve_points {
        result.positions.push(point.position);
        result.normals.push(point.normal);
        result.rho.push(point.rho);
        result.owners.push(NO_POINT);
    }
    result
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

/// Position, normal and ρ of the candidate of a point's ring entries `i` and `i + 1`.
fn candidate(
    level: &Level,
    rings: &Rings,
    params: &RefineParams,
    p: usize,
    i: usize,
) -> (Vec3, Vec3, f32) {
    let Some(triangle) = fan_triangle(level, rings, p, i) else { return NONE };
    let corners = triangle.map(|c| level.corner(c));
    let position = if params.simplified {
        pn_triangle::center_of_gravity(corners)
    } else {
        pn_triangle::displaced_center(corners)
    };
    let rho = pn_triangle::reach(corners, position);
    if rho == 0.0 {
        return NONE;
    }
    if params.rules.steep_faces && pn_triangle::is_steep(corners, rho) {
        return NONE;
    }
    let normal = if params.simplified {
        // The triangle must have an area; its curved normal is taken when it is inserted.
        pn_triangle::flat_normal(corners, rho)
    } else {
        pn_triangle::new_normal(corners, rho, params.rules)
    };
    normal.map_or(NONE, |normal| (position, normal, rho))
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
