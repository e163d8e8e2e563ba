//! The loop over levels (section 2).

use crate::Level;
use crate::boundary::boundary;
use crate::candidates::{Candidates, candidates};
use crate::coloring::{Classes, coloring};
use crate::commit::commit;
use crate::conflicts::{Conflicts, conflicts};
use crate::contested::{asks_contested_alone, contested_overlaps};
use crate::insertion::{Insertion, Order, Stage, insertion};
use crate::lists::{Lists, TooLong};
use crate::neighborhood::{Rings, neighborhood};
use crate::next_ring::{Covers, next_ring};
use crate::selection::{overlaps, selection};
use rayon::prelude::*;
use std::fmt;
use std::mem::take;
use std::time::{Duration, Instant};
use surfine_features::{Folded, Records, Refinement, check_marks, fold};
use surfine_points::{
    Boundary, Grid, GridShape, Invalid, LevelReport, Ordered, ParamError, PointSet, Progress,
    RefineParams, Refined, add_stage_time,
};

/// Why a refinement did not run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The points are unfit.
    Points(Invalid),
    /// A parameter is out of its range.
    Params(ParamError),
    /// The lists around the points of a step have more entries than 32 bits number: radii are far too large, or there are
    /// hundreds of millions of points.
    Lists {
        /// The refinement step, from 1.
        step: u32,
        /// Points before the step, each normal of a point on a crease counted.
        points: usize,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Points(e) => e.fmt(f),
            Self::Params(e) => e.fmt(f),
            Self::Lists { step, points } => write!(
                f,
                "step {step} has {points} points to refine, and the lists around them are too long for indices of 32 \
                 bits: lower generous radii, use fewer levels, or split the cloud"
            ),
        }
    }
}

impl std::error::Error for Error {}

impl From<Invalid> for Error {
    fn from(e: Invalid) -> Self {
        Self::Points(e)
    }
}

impl From<ParamError> for Error {
    fn from(e: ParamError) -> Self {
        Self::Params(e)
    }
}

/// Points of a level that is refined: seven candidates a point are the most that occur in the mean, and their slots
/// are numbered in 32 bits. Lists of other lengths are counted when they are made ([`TooLong`]).
const LARGEST_LEVEL: usize = (u32::MAX / 7) as usize;

/// Refines a point set.
///
/// # Errors
/// Unfit points or parameters; see [`PointSet::validate`] and [`RefineParams::validate`].
pub fn refine(points: &PointSet, params: &RefineParams) -> Result<Refined, Error> {
    refine_with(points, params, Order::Together, &mut |_| ())
}

/// [`refine`], with the order inside classes (which can't change the result) and a call at the start of each stage.
///
/// # Errors
/// As [`refine`].
pub fn refine_with(
    points: &PointSet,
    params: &RefineParams,
    order: Order,
    progress: &mut dyn FnMut(Progress),
) -> Result<Refined, Error> {
    params.validate()?;
    points.validate()?;
    check_marks(points, params)?;
    let ordered = Ordered::new(points);
    let (input, points) = (points, &ordered.points);
    let records = Records::split(points).map_err(|e| e.in_order(&ordered.order))?;
    let mut level = Level::new(&records);
    let mut result = Refined { level_sizes: vec![level.len()], ..Refined::default() };
    let keep = |level: &Level| params.keep_radii.then(|| level.radii.clone());
    result.level_radii.extend(keep(&level));
    for step in 1..=params.levels {
        let size = level.len();
        if size > LARGEST_LEVEL {
            return Err(Invalid::TooMany(size).into());
        }
        let mut tell = |stage| {
            progress(Progress { level: step, levels: params.levels, stage, points: size });
        };
        let mut clock = Clock { start: &mut tell, times: Vec::new() };
        let sight = look(&mut level, points, params, &mut clock);
        if let (1, Some(curves)) = (step, &level.curves) {
            result.curves = curves.features.counts();
        }
        level.begin_step(params.rules);
        let stages = run_stages(&level, sight, params, order, &mut clock);
        let (state, mut report) = stages.map_err(|TooLong| Error::Lists { step, points: size })?;
        let parents = clock.time("commit", || commit(&mut level, &state));
        report.stages = clock.times;
        report.points_out = level.len();
        result.parents.par_extend(parents);
        result.level_sizes.push(level.len());
        result.level_radii.extend(keep(&level));
        result.reports.push(report);
    }
    let folded = fold_level(points, &records, level, &mut result, params);
    folded.count_points(&mut result.reports);
    let Folded { points, parents, level_sizes, level_radii } = folded;
    let mut refined = Refined { points, parents, level_sizes, level_radii, ..result };
    ordered.restore(input, &mut refined);
    Ok(refined)
}

/// The points of the last level with their attributes, from its records; takes these and what the result has of them.
fn fold_level(
    input: &PointSet,
    records: &Records,
    level: Level,
    result: &mut Refined,
    params: &RefineParams,
) -> Folded {
    let Level { positions, normals, radii, curves, .. } = level;
    let (parents, level_sizes) = (take(&mut result.parents), take(&mut result.level_sizes));
    let level_radii = take(&mut result.level_radii);
    let features = curves.map(|curves| curves.features).unwrap_or_default();
    let refinement = Refinement { positions, normals, radii, parents, level_sizes, level_radii };
    fold(input, records, &features, refinement, params.boundary.property())
}

/// Times the stages and tells the caller where the run stands.
struct Clock<'a> {
    start: &'a mut dyn FnMut(&'static str),
    times: Vec<(&'static str, Duration)>,
}

impl Clock<'_> {
    fn time<T>(&mut self, stage: &'static str, work: impl FnOnce() -> T) -> T {
        (self.start)(stage);
        let begin = Instant::now();
        let result = work();
        add_stage_time(&mut self.times, stage, begin.elapsed());
        result
    }
}

/// The neighbourhoods of a level.
struct Sight {
    grid: Grid,
    rings: Rings,
}

impl Sight {
    fn of(level: &Level, params: &RefineParams, clock: &mut Clock<'_>) -> Self {
        let grid = clock.time("grid", || point_grid(level));
        let rings = clock.time("neighborhood", || neighborhood(level, &grid, params));
        Self { grid, rings }
    }
}

/// The neighbourhoods of a level; of the input once its boundaries are found, which bound them.
fn look(
    level: &mut Level,
    points: &PointSet,
    params: &RefineParams,
    clock: &mut Clock<'_>,
) -> Sight {
    let sight = Sight::of(level, params, clock);
    let searches = level.step == 0 && params.boundary != Boundary::None;
    if searches && clock.time("boundary", || boundary(level, &sight.rings, points, params)) {
        return Sight::of(level, params, clock);
    }
    sight
}

/// Everything that one refinement step computes before its commit.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "each field is the output of the stage of that name")]
pub struct LevelState {
    pub grid: Grid,
    pub rings: Rings,
    pub candidates: Candidates,
    /// None where only contested candidates are asked.
    pub candidate_grid: Option<Grid>,
    /// Of the selection, which has no conflicts but candidates around points.
    pub overlaps: Lists,
    pub conflicts: Conflicts,
    pub classes: Classes,
    pub insertion: Insertion,
    pub covers: Covers,
}

/// Runs the stages of one refinement step up to the commit.
///
/// # Panics
/// If there are so many points that their lists have more entries than 32 bits number.
pub fn run_level(
    level: &Level,
    params: &RefineParams,
    order: Order,
    progress: &mut dyn FnMut(&'static str),
) -> (LevelState, LevelReport) {
    let mut clock = Clock { start: progress, times: Vec::new() };
    let sight = Sight::of(level, params, &mut clock);
    let stages = run_stages(level, sight, params, order, &mut clock);
    let (state, report) = stages.expect("32 bits number the entries of all lists");
    (state, LevelReport { stages: clock.times, ..report })
}

/// The stages from the candidates on.
fn run_stages(
    level: &Level,
    Sight { grid, rings }: Sight,
    params: &RefineParams,
    order: Order,
    clock: &mut Clock<'_>,
) -> Result<(LevelState, LevelReport), TooLong> {
    let candidates = clock.time("candidates", || candidates(level, &rings, params));
    let first = if params.rules.largest_first { "selection" } else { "conflicts" };
    let candidate_grid = clock.time(first, || {
        let is_needed = !asks_contested_alone(level, params);
        is_needed.then(|| candidate_grid(&grid.shape, &candidates))
    });
    let mut state = LevelState {
        grid,
        rings,
        candidates,
        candidate_grid,
        overlaps: Lists::default(),
        conflicts: Conflicts::default(),
        classes: Classes::default(),
        insertion: Insertion::default(),
        covers: Covers::default(),
    };
    if params.rules.largest_first {
        clock.time("selection", || state.select(level, params))?;
    } else {
        let LevelState { rings, candidates, candidate_grid, .. } = &state;
        let grid = candidate_grid.as_ref().expect("only a selection of the largest does without");
        let graph = || conflicts(level, rings, candidates, grid, params);
        state.conflicts = clock.time("conflicts", graph)?;
        state.classes = clock.time("coloring", || coloring(&state.conflicts.before));
        let insert = || insertion(state.stage(level, params), &state.classes, order);
        state.insertion = clock.time("insertion", insert);
    }
    let cover = || next_ring(state.stage(level, params), &state.insertion);
    state.covers = clock.time("next_ring", cover);
    let rings = &state.rings;
    let report = LevelReport {
        points_in: level.len(),
        ball_neighbors: rings.ball_neighbors,
        ring_neighbors: rings.len() as u64,
        classes: state.classes.members.len(),
        isolated: (0..level.len()).filter(|&p| rings.ring(p).is_empty()).count(),
        ..LevelReport::default()
    };
    Ok((state, report))
}

impl LevelState {
    /// What the stages after the candidates read.
    pub fn stage<'a>(&'a self, level: &'a Level, params: &'a RefineParams) -> Stage<'a> {
        let Self { rings, candidates, conflicts, .. } = self;
        Stage { level, rings, candidates, conflicts, params }
    }

    /// Selects the new points, the largest triangles first.
    fn select(&mut self, level: &Level, params: &RefineParams) -> Result<(), TooLong> {
        let Self { rings, candidates, candidate_grid, .. } = self;
        self.overlaps = match candidate_grid {
            Some(grid) => overlaps(level, candidates, grid, params),
            None => contested_overlaps(rings, candidates, params),
        }?;
        (self.insertion, self.conflicts.around) =
            selection(level, rings, candidates, &self.overlaps, params)?;
        Ok(())
    }
}

/// The points of a level by cell.
pub fn point_grid(level: &Level) -> Grid {
    let shape = GridShape::fit(&level.positions, &level.radii);
    Grid::sort(shape, &level.positions, |i| i as u32)
}

/// The existing candidates by cell, in a grid of the same shape as that of the points.
pub fn candidate_grid(shape: &GridShape, candidates: &Candidates) -> Grid {
    if candidates.rho.iter().all(|&rho| rho > 0.0) {
        return Grid::sort(*shape, &candidates.positions, |c| c as u32);
    }
    let existing = (0..candidates.len()).filter(|&c| candidates.exists(c));
    Grid::build(*shape, existing.map(|c| (c as u32, candidates.positions[c])))
}
