//! Candidates `L_p` (section 5, eq. 12): one for each triangle of the fans. Twins: `shaders/candidates*.wgsl`.
//!
//! Most triangles are in the fans of all three corners. They are one candidate, which all of these may insert. It
//! belongs to the first corner, from the smallest index on, whose fan has the triangle.

use crate::columns::BLOCK;
use crate::lists::filled;
use crate::neighborhood::Rings;
use crate::triangle_homes::number;
use crate::triangles::{self, NewPoints, Triangles};
use crate::visible::Seen;
use crate::{Level, NO_POINT};
use glam::Vec3;
use rayon::prelude::*;
use surfine_points::RefineParams;

pub use crate::fan_triangle::{WIDEST_GAP, WIDEST_SHEET, fan_triangle};

/// Radii exceed the distance to the farthest natural neighbour by this factor.
pub const NATURAL: f32 = 1.25;

/// Of a sum of three, their mean.
pub const THIRD: f32 = 1.0 / 3.0;

/// The possible new points of all fans, by the slots to which they belong, then the new points on creases and
/// boundaries, which are inserted in any case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    /// Position, displaced by φ.
    pub positions: Vec<Vec3>,
    /// Normal of the curved triangle.
    pub normals: Vec<Vec3>,
    /// `ρ`: largest distance to the three corners, or -1 where the triangle has no candidate.
    pub rho: Vec<f32>,
    /// The corners, smallest index first and orientation kept; of a point on a curve those between which it lies.
    pub corners: Vec<[u32; 3]>,
    /// The candidate of each slot; [`NO_POINT`] for slots without a triangle.
    pub of_slot: Vec<u32>,
    /// Their sizes, by which the selection goes: ρ, or λ1 times the distance from the corners to their
    /// farthest neighbours in the mean, whichever is larger; by the paper's loop, or if `simplified`, ρ. 0
    /// where there is no candidate.
    pub sizes: Vec<f32>,
    /// Of each point: within this distance new points are new neighbours (section 5). For a selection among all
    /// candidates λ1 times the distance to the farthest neighbour; 0 if `simplified`.
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
    let (of_slot, corners) = number(level, rings);
    let near = |p| near_radius(level, rings, params, p);
    let near = (0..level.len()).into_par_iter().map(near).collect();
    let mut result = Candidates {
        positions: filled(Vec3::ZERO, corners.len()),
        normals: filled(Vec3::ZERO, corners.len()),
        rho: vec![0.0; corners.len()],
        sizes: vec![0.0; corners.len()],
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
        result.sizes.push(point.rho);
        result.corners.push(point.parents);
    }
    result
}

impl Candidates {
    /// Finds position, normal, ρ and size of the candidates of all triangles.
    fn find_all(&mut self, level: &Level, params: &RefineParams) {
        let safe = params.rules.sliver_normals;
        let formula = if safe { triangles::new_points } else { triangles::literal_points };
        let chunks = (self.positions.par_chunks_mut(BLOCK))
            .zip(self.normals.par_chunks_mut(BLOCK))
            .zip(self.rho.par_chunks_mut(BLOCK))
            .zip(self.sizes.par_chunks_mut(BLOCK))
            .zip(self.corners.par_chunks(BLOCK));
        let near = &self.near;
        let scratch = || (Triangles::EMPTY, NewPoints::EMPTY);
        chunks.with_min_len(32).for_each_init(scratch, |(triangles, new), chunk| {
            let ((((positions, normals), rho), sizes), corners) = chunk;
            triangles.gather(level, corners);
            formula(triangles, params.rules, new);
            for i in 0..corners.len() {
                (positions[i], normals[i]) = (new.positions.get(i), new.normals.get(i));
            }
            rho.copy_from_slice(&new.rho[..corners.len()]);
            for ((size, &rho), corners) in sizes.iter_mut().zip(&*rho).zip(corners) {
                *size = size_of(near, *corners, rho, params);
            }
        });
    }
}

/// The size of a triangle. Where neighbours are unevenly far, it counts as large as the neighbourhoods of its
/// corners, but if `simplified`.
#[inline(always)]
fn size_of(near: &[f32], corners: [u32; 3], rho: f32, params: &RefineParams) -> f32 {
    if !params.rules.largest_first || params.simplified || rho <= 0.0 {
        return rho.max(0.0);
    }
    let [a, b, c] = corners.map(|corner| near[corner as usize]);
    rho.max((a + b + c) * THIRD)
}

/// `λ1 r`. The radii of the input may be too large, and would take far points for new neighbours: in the first step
/// they count as no more than [`NATURAL`] times the distance to the farthest neighbour. A selection among all
/// candidates has no use for radii, and asks for that distance; if `simplified` for nothing.
fn near_radius(level: &Level, rings: &Rings, params: &RefineParams, p: usize) -> f32 {
    let (radius, rules) = (level.radii[p], params.rules);
    let believes_radii = !rules.first_radii || level.step > 0 || rings.ring(p).is_empty();
    if !rules.largest_first && believes_radii {
        return params.lambda1 * radius;
    }
    if rules.largest_first && params.simplified {
        return 0.0;
    }
    let mut farthest = 0.0f32;
    for entry in rings.ring(p) {
        let d = level.positions[entry.id as usize] - level.positions[p];
        farthest = farthest.max(d.dot(d));
    }
    if rules.largest_first {
        return params.lambda1 * farthest.sqrt();
    }
    params.lambda1 * radius.min(NATURAL * farthest.sqrt())
}
