//! What may happen around each point: the candidates that it may meet, and the conflict graph `T` of the points that
//! must not be refined at the same time.
//! Twins: `shaders/conflicts*.wgsl` and `shaders/shared/around.wgsl`.
//!
//! The insertion around a point (section 5) depends on those before it. Two points commute unless
//! a candidate of one lies within `λ1 r` of the other, so that it would enter its N', or
//! candidates x and y of the two have `|x - y| < λ2 max(ρ_x, ρ_y)`, so that one would discard the other.
//!
//! Both happen only within `max(λ1 r, |x - p| + λ2 ρ_x)` of a point p with candidates x: the corners of all candidates
//! there count as being in conflict with p. That is more than needed (docs/algorithm.md says how much), and needs no
//! look at pairs of candidates.

use crate::candidates::Candidates;
use crate::coloring::scramble;
use crate::columns::vectorized;
use crate::insertion::COVER;
use crate::lists::{Chunk, Lists, TooLong};
use crate::nearby::{Marks, Nearby};
use crate::neighborhood::Rings;
use crate::visible::{Seen, View};
use crate::{Level, NO_POINT};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use surfine_points::{Grid, RefineParams};

/// Widens what lists must hold, so that rounding can't lose an entry.
pub const SLACK: f32 = 1.0 + 1e-5;

/// What may happen around each point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conflicts {
    /// The candidates that a point sees within the largest radius that it may get.
    pub around: Lists,
    /// The neighbours of a point in `T` that choose their class before it.
    pub before: Lists,
}

/// Points whose reaches are found together.
const BATCH: usize = 64;

/// Finds the candidates around each point and computes `T`.
///
/// # Errors
/// Too long lists.
pub fn conflicts(
    level: &Level,
    rings: &Rings,
    candidates: &Candidates,
    candidate_grid: &Grid,
    params: &RefineParams,
) -> Result<Conflicts, TooLong> {
    let widest = candidates.rho.par_iter().copied().reduce(|| 0.0, f32::max) * params.lambda2;
    let search = Search { level, candidates, grid: candidate_grid, params, widest };
    let [around, before, after] = Lists::in_chunks(
        level.len(),
        || Scratch::new(level.len()),
        |scratch, points, lists| {
            for first in points.clone().step_by(BATCH) {
                let batch = first..(first + BATCH).min(points.end);
                let reach = |p| Reach::of(level, rings, candidates, params, p);
                scratch.reaches.clear();
                scratch.reaches.extend(batch.clone().map(reach));
                for p in batch.clone() {
                    search.look(p..batch.end, first, scratch);
                    search.keep(p, p - first, scratch, lists);
                    lists.iter_mut().for_each(Chunk::end);
                }
            }
        },
    )?;
    Ok(Conflicts { around, before: with_others(&before, &after)? })
}

/// What a thread uses again for the next points.
struct Scratch {
    /// Of the points of a batch.
    reaches: Vec<Reach>,
    /// Candidates near some points, and what decides on them.
    nearby: Nearby,
    normals: [Vec<f32>; 3],
    /// Radii of the spheres in which they discard others: λ2 ρ.
    spheres: Vec<f32>,
    marks: Marks,
    /// The last point that met each point.
    met_by: Vec<u32>,
}

impl Scratch {
    fn new(points: usize) -> Self {
        Self {
            reaches: Vec::new(),
            nearby: Nearby::default(),
            normals: [const { Vec::new() }; 3],
            spheres: Vec::new(),
            marks: Marks::default(),
            met_by: vec![NO_POINT; points],
        }
    }
}

/// What is searched.
struct Search<'a> {
    level: &'a Level,
    candidates: &'a Candidates,
    grid: &'a Grid,
    params: &'a RefineParams,
    /// The largest sphere in which a candidate discards others.
    widest: f32,
}

impl Search<'_> {
    /// Gathers the candidates near the first of some points of the batch, and what decides on them.
    fn look(&self, points: Range<usize>, first: usize, scratch: &mut Scratch) {
        let Scratch { reaches, nearby, normals, spheres, .. } = scratch;
        let ball = |p: usize| {
            let reach = &reaches[p - first];
            (self.level.positions[p], reach.conflicts.max(reach.of_candidate(self.widest)))
        };
        if !nearby.look(self.grid, points, ball) {
            return;
        }
        let items = nearby.items.iter().map(|&c| c as usize);
        let all = items.clone().map(|c| self.candidates.normals[c]);
        normals.iter_mut().for_each(Vec::clear);
        for normal in all {
            normals.iter_mut().zip(normal.to_array()).for_each(|(column, n)| column.push(n));
        }
        spheres.clear();
        spheres.extend(items.map(|c| self.params.lambda2 * self.candidates.rho[c]));
    }

    /// Keeps the candidates that the point may meet, and the corners of those that it is in conflict with.
    fn keep(
        &self,
        p: usize,
        rank: usize,
        scratch: &mut Scratch,
        [around, before, after]: &mut [Chunk<u32>; 3],
    ) {
        let Self { level, candidates, params, .. } = self;
        let Scratch { reaches, nearby, normals, spheres, marks, met_by } = scratch;
        let (reach, center) = (&reaches[rank], level.seen(p));
        let view = View::new(level, center, reach.largest, params.rules);
        let normals = [&*normals[0], &*normals[1], &*normals[2]];
        let own_side = params.rules.own_side;
        mark(
            center,
            reach,
            own_side,
            nearby.places(),
            normals,
            spheres,
            marks.prepare(spheres.len()),
        );
        marks.find();
        let marked = &marks.marked;
        let priority = scramble(p as u32);
        met_by[p] = p as u32;
        for &i in marked {
            let (c, mark) = (nearby.items[i as usize], marks.get(i));
            // Points on curves are there before all others: nobody has them.
            let conflicts = mark & CONFLICTS != 0 && (c as usize) < candidates.first_on_curve;
            for q in candidates.corners[c as usize] {
                let met_by = &mut met_by[q as usize];
                let is_new = conflicts & (*met_by != p as u32);
                let chooses_before = scramble(q) > priority;
                before.offer(q, is_new & chooses_before);
                after.offer(q, is_new & !chooses_before);
                *met_by = if conflicts { p as u32 } else { *met_by };
            }
            let sees = |view: &View<'_>| view.sees(candidates.seen(c as usize, level));
            around.offer(c, mark & IN_SIGHT != 0 && view.as_ref().is_none_or(sees));
        }
    }
}

/// Marks of candidates that conflict with others around a point.
const CONFLICTS: u8 = 1;
/// Marks of candidates that the point lists, if no curve is in the way.
const IN_SIGHT: u8 = 2;

vectorized! {
    fn mark(
        center: Seen,
        reach: &Reach,
        own_side: bool,
        places: [&[f32]; 3],
        normals: [&[f32]; 3],
        spheres: &[f32],
        marks: &mut [u8],
    ) {
        let count = marks.len();
        let ([x, y, z], [nx, ny, nz]) =
            (places.map(|column| &column[..count]), normals.map(|column| &column[..count]));
        let spheres = &spheres[..count];
        let all_sides = !own_side;
        for i in 0..count {
            let offset = Vec3::new(x[i], y[i], z[i]) - center.position;
            let squared = offset.dot(offset);
            let within = reach.of_candidate(spheres[i]);
            let faces = Vec3::new(nx[i], ny[i], nz[i]).dot(center.normal) > 0.0;
            let is_in_sight = (squared <= within * within) & (all_sides | faces);
            let conflicts = squared <= reach.conflicts * reach.conflicts;
            marks[i] = (u8::from(conflicts) * CONFLICTS) | (u8::from(is_in_sight) * IN_SIGHT);
        }
    }
}

/// How far what bears on a point may be.
struct Reach {
    /// The largest radius that it may have at the next level: that of now, or as far as its own candidates are.
    largest: f32,
    /// Within this distance are the candidates of all points that it is in conflict with, as far as it can see.
    conflicts: f32,
    /// Within this distance new points are new neighbours.
    near: f32,
    /// The farthest own candidate; infinitely far if there is none.
    own: f32,
}

impl Reach {
    /// Within which distance a candidate with that discard sphere is of interest: others can neither enter
    /// N' nor discard what might.
    #[inline(always)]
    fn of_candidate(&self, sphere: f32) -> f32 {
        self.largest.min(COVER * SLACK * self.near.max(self.own + sphere))
    }

    fn of(
        level: &Level,
        rings: &Rings,
        candidates: &Candidates,
        params: &RefineParams,
        p: usize,
    ) -> Self {
        let near = candidates.near[p];
        let (mut own, mut conflicts) = (0.0f32, near);
        for x in candidates.own(rings, p) {
            let d = candidates.positions[x] - level.positions[p];
            let distance = d.dot(d).sqrt();
            own = own.max(distance);
            conflicts = conflicts.max(distance + params.lambda2 * candidates.rho[x]);
        }
        let largest = COVER * SLACK * level.radii[p].max(own);
        let own = if candidates.own(rings, p).next().is_none() { f32::INFINITY } else { own };
        Self { largest, conflicts: SLACK * conflicts, near, own }
    }
}

/// Both ends of a conflict see it only where their reaches are alike: adds those that the one who
/// chooses before found alone.
fn with_others(before: &Lists, after: &Lists) -> Result<Lists, TooLong> {
    let alone = Lists::make(before.len(), |p, alone| {
        for &q in after.of(p) {
            alone.offer(q, !holds(before.of(q as usize), p as u32));
        }
    })?;
    let others = alone.mirrored();
    Lists::make(before.len(), |p, all| {
        all.items.extend_from_slice(before.of(p));
        all.items.extend_from_slice(others.of(p));
    })
}

/// Whether a short list holds an entry: to look at all entries costs less than to guess where it is.
fn holds(list: &[u32], entry: u32) -> bool {
    list.iter().fold(0, |count, &e| count + u32::from(e == entry)) > 0
}
