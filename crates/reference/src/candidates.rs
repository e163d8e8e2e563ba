//! Candidates `L_p` (section 5, eq. 12): one for each triangle of the fans. Twins: `shaders/candidates*.wgsl`.
//!
//! Most triangles are in the fans of all three corners. They are one candidate, which all of these may insert. It belongs to the
//! first corner, from the smallest index on, whose fan has the triangle.

use crate::columns::BLOCK;
use crate::lists::filled;
use crate::math::TAU;
use crate::neighborhood::{RingEntry, Rings};
use crate::triangles::{self, NewPoints, Triangles};
use crate::visible::Seen;
use crate::{Level, NO_POINT};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use surfine_features::Record;
use surfine_points::RefineParams;

/// A fan triangle needs a gap below π(1 - 1e-4) radians: at π the fan has no triangle there.
pub const WIDEST_GAP: f32 = surfine_features::STRAIGHT;

/// A triangle between a point and both its neighbours on a curve has a gap of no more than 150°, but at corners, radians.
pub const WIDEST_SHEET: f32 = 2.617_994;

/// Radii exceed the distance to the farthest natural neighbour by this factor.
pub const NATURAL: f32 = 1.25;

/// Of a sum of three, their mean.
pub const THIRD: f32 = 1.0 / 3.0;

/// The possible new points of all fans, by the slots to which they belong, then the new points on creases and boundaries,
/// which are inserted in any case.
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
    /// Their sizes, by which the selection goes: ρ, or λ1 times the distance from the corners to their farthest neighbours in the
    /// mean, whichever is larger; by the paper's selection, or if `simplified`, ρ. 0 where there is no candidate.
    pub sizes: Vec<f32>,
    /// Of each point: within this distance new points are new neighbours (section 5). For a selection among all candidates λ1
    /// times the distance to the farthest neighbour; 0 if `simplified`.
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

/// The triangle of each slot, [`NO_POINT`] for slots without one, and the corners of all triangles: they are numbered by the
/// slots to which they belong.
fn number(level: &Level, rings: &Rings) -> (Vec<u32>, Vec<[u32; 3]>) {
    let (mut homes, mut numbers) = (vec![0; rings.len()], vec![0; rings.len()]);
    let mut parts = Part::all(rings, &mut homes, &mut numbers);
    parts.par_iter_mut().for_each(|part| part.find(level, rings));
    let mut corners = vec![[0; 3]; parts.iter().map(|part| part.corners.len()).sum()];
    let (mut rest, mut first) = (corners.as_mut_slice(), 0);
    for part in &mut parts {
        let (own, after) = rest.split_at_mut(part.corners.len());
        (part.first, part.all_corners, rest) = (first, own, after);
        first += part.all_corners.len() as u32;
    }
    parts.into_par_iter().for_each(Part::join);
    let number = |home: &mut u32| *home = numbers.get(*home as usize).copied().unwrap_or(NO_POINT);
    homes.par_iter_mut().with_min_len(1024).for_each(number);
    (homes, corners)
}

/// Points whose triangles one thread finds before it takes the next ones.
const CHUNK: usize = 1024;

/// The triangles of some points.
struct Part<'a> {
    points: Range<usize>,
    /// For each of their slots that to which its triangle belongs; [`NO_POINT`] for slots without a triangle.
    homes: &'a mut [u32],
    /// How many triangles belong to slots before each one.
    numbers: &'a mut [u32],
    /// The corners of the triangles that belong to these slots.
    corners: Vec<[u32; 3]>,
    /// How many belong to the points before these.
    first: u32,
    /// Where the corners go among those of all triangles.
    all_corners: &'a mut [[u32; 3]],
}

impl<'a> Part<'a> {
    /// Parts for all points.
    fn all(rings: &Rings, mut homes: &'a mut [u32], mut numbers: &'a mut [u32]) -> Vec<Self> {
        let points = rings.lists.len();
        let part = |first: usize| {
            let points = first..(first + CHUNK).min(points);
            let starts = &rings.lists.starts;
            let slots = (starts[points.end] - starts[points.start]) as usize;
            let homes = homes.split_off_mut(..slots).expect("a place for each slot");
            let numbers = numbers.split_off_mut(..slots).expect("a place for each slot");
            Part { points, homes, numbers, corners: Vec::new(), first: 0, all_corners: &mut [] }
        };
        (0..points).step_by(CHUNK).map(part).collect()
    }

    /// Finds the homes, and numbers the triangles that belong to these points from 0.
    fn find(&mut self, level: &Level, rings: &Rings) {
        let base = rings.slots(self.points.start).start;
        let (mut fan, mut elsewhere) = (Vec::new(), Vec::new());
        // A little more than two triangles belong to a point in the mean.
        self.corners.reserve(CHUNK * 9 / 4);
        for p in self.points.clone() {
            let slots = rings.slots(p);
            let own = slots.start - base..slots.end - base;
            let homes = &mut self.homes[own.clone()];
            let room = slots.len().max(fan.len());
            fan.resize(room, [0; 3]);
            elsewhere.resize(room, 0);
            let elsewhere = find_fan(level, rings, p, homes, &mut fan, &mut elsewhere);
            for &i in elsewhere {
                homes[i] = home(level, rings, fan[i], p).unwrap_or(homes[i]);
            }
            // All are written and those at home counted: a branch would be guessed wrong often.
            let mut count = self.corners.len();
            self.corners.resize(count + slots.len(), [0; 3]);
            for (i, number) in self.numbers[own].iter_mut().enumerate() {
                *number = count as u32;
                self.corners[count] = fan[i];
                count += usize::from(homes[i] == (slots.start + i) as u32);
            }
            self.corners.truncate(count);
        }
    }

    /// Numbers the triangles among those of all points.
    fn join(self) {
        self.numbers.iter_mut().for_each(|number| *number += self.first);
        self.all_corners.copy_from_slice(&self.corners);
    }
}

/// Finds the triangles of a fan. They belong to their own slots but for those that it returns: their first corner is another one.
#[inline]
fn find_fan<'a>(
    level: &Level,
    rings: &Rings,
    p: usize,
    homes: &mut [u32],
    fan: &mut [[u32; 3]],
    elsewhere: &'a mut [usize],
) -> &'a [usize] {
    let first = rings.slots(p).start;
    let mut count = 0;
    for (i, (home, corners)) in homes.iter_mut().zip(fan).enumerate() {
        let triangle = fan_triangle(level, rings, p, i);
        *home = if triangle.is_some() { (first + i) as u32 } else { NO_POINT };
        *corners = triangle.unwrap_or([p as u32; 3]);
        elsewhere[count] = i;
        count += usize::from(corners[0] != p as u32);
    }
    &elsewhere[..count]
}

/// The slot of a triangle in the fan of the first of its corners that has it, if that comes before `p`, whose fan has it.
#[inline]
fn home(level: &Level, rings: &Rings, [a, b, c]: [u32; 3], p: usize) -> Option<u32> {
    let of_first = || slot_between(level, rings, a, b, c);
    let of_second = || if p as u32 == b { None } else { slot_between(level, rings, b, c, a) };
    of_first().or_else(of_second)
}

/// The slot of a point's triangle between two neighbours.
#[inline]
fn slot_between(level: &Level, rings: &Rings, p: u32, from: u32, to: u32) -> Option<u32> {
    let (p, slots) = (p as usize, rings.slots(p as usize));
    let ring = rings.ring(p);
    let i = place_of(rings, slots.clone(), from)?;
    let follows = ring[if i + 1 == ring.len() { 0 } else { i + 1 }].id == to;
    let is_triangle = follows && fan_triangle(level, rings, p, i).is_some();
    is_triangle.then_some((slots.start + i) as u32)
}

/// Entries of a ring that are compared in any case, and in which most rings fit.
const WINDOW: usize = 8;

/// The place of a point in a ring. As many entries are compared for each ring, with those that follow it if it has fewer: where
/// a search ends would be guessed wrong often.
#[inline]
fn place_of(rings: &Rings, slots: Range<usize>, id: u32) -> Option<usize> {
    let entries = &rings.lists.items[slots.start..];
    match entries.first_chunk::<WINDOW>() {
        Some(window) if slots.len() <= WINDOW => {
            let bit = |(i, entry): (usize, &RingEntry)| u32::from(entry.id == id) << i;
            let bits = window.iter().enumerate().map(bit).fold(0, |bits, bit| bits | bit);
            let place = bits.trailing_zeros() as usize;
            (place < slots.len()).then_some(place)
        }
        _ => entries[..slots.len()].iter().position(|entry| entry.id == id),
    }
}

/// The size of a triangle. Where neighbours are unevenly far, it counts as large as the neighbourhoods of its corners, but if
/// `simplified`.
#[inline(always)]
fn size_of(near: &[f32], corners: [u32; 3], rho: f32, params: &RefineParams) -> f32 {
    if !params.rules.largest_first || params.simplified || rho <= 0.0 {
        return rho.max(0.0);
    }
    let [a, b, c] = corners.map(|corner| near[corner as usize]);
    rho.max((a + b + c) * THIRD)
}

/// `λ1 r`. The radii of the input may be too large, and would take far points for new neighbours: in the first step they
/// count as no more than [`NATURAL`] times the distance to the farthest neighbour. A selection among all candidates has no use
/// for radii, and asks for that distance; if `simplified` for nothing.
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

/// The corners of a fan triangle, smallest index first and orientation kept, so that the copies of one triangle in
/// three fans are computed alike. `None` if the gap is not below π, or goes around the end of a crease point's sheet.
// A call for each slot would cost as much as what is done in it.
#[inline(always)]
pub fn fan_triangle(level: &Level, rings: &Rings, p: usize, i: usize) -> Option<[u32; 3]> {
    let ring = rings.ring(p);
    let last = i + 1 == ring.len();
    let (a, b) = (ring[i], if last { ring[0] } else { ring[i + 1] });
    let turn = [0.0, TAU][usize::from(last)];
    let gap = (b.angle + turn) - a.angle;
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
#[inline(always)]
fn canonical([a, b, c]: [u32; 3]) -> [u32; 3] {
    debug_assert!(a != NO_POINT && b != NO_POINT && c != NO_POINT);
    // Which corner comes first would be guessed wrong often: a place in a table is none to guess.
    let first = if (a < b) & (a < c) { 0 } else { 2 - usize::from(b < c) };
    let twice = [a, b, c, a, b];
    [twice[first], twice[first + 1], twice[first + 2]]
}
