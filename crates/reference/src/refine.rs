//! The loop over levels (section 2).

use crate::candidates::{Candidates, candidates};
use crate::coloring::{Classes, coloring};
use crate::commit::commit;
use crate::conflicts::{Graph, conflicts};
use crate::insertion::{Insertion, Order, Stage, insertion};
use crate::neighborhood::{Rings, neighborhood};
use crate::next_ring::{Covers, next_ring};
use crate::{Level, NO_POINT};
use std::fmt;
use std::time::Instant;
use surfine_points::{
    Grid, GridShape, Invalid, LevelReport, ParamError, PointSet, Progress, RefineParams, Refined,
};

/// Why a refinement did not run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The points are unfit.
    Points(Invalid),
    /// A parameter is out of its range.
    Params(ParamError),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Points(e) => e.fmt(f),
            Self::Params(e) => e.fmt(f),
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
/// are numbered in 32 bits.
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
    let mut level = Level::new(points);
    let mut result = Refined { level_sizes: vec![level.len()], ..Refined::default() };
    let keep = |level: &Level| params.keep_radii.then(|| level.radii.clone());
    result.level_radii.extend(keep(&level));
    for step in 1..=params.levels {
        let points = level.len();
        if points > LARGEST_LEVEL {
            return Err(Invalid::TooMany(points).into());
        }
        let (state, mut report) = run_level(&level, params, order, &mut |stage| {
            progress(Progress { level: step, levels: params.levels, stage, points });
        });
        let begin = Instant::now();
        let parents = commit(&mut level, &state, params);
        report.stages.push(("commit", begin.elapsed()));
        report.points_out = level.len();
        result.parents.extend(parents);
        result.level_sizes.push(level.len());
        result.level_radii.extend(keep(&level));
        result.reports.push(report);
    }
    let mut refined = points.clone();
    let new = points.len()..level.len();
    refined.positions.extend_from_slice(&level.positions[new.clone()]);
    refined.normals.extend_from_slice(&level.normals[new]);
    refined.radii = level.radii;
    refined.extend_attributes(&result.parents);
    result.points = refined;
    Ok(result)
}

/// Everything that one refinement step computes before its commit.
#[derive(Clone, Debug)]
#[expect(missing_docs, reason = "each field is the output of the stage of that name")]
pub struct LevelState {
    pub grid: Grid,
    pub rings: Rings,
    pub candidates: Candidates,
    pub candidate_grid: Grid,
    pub conflicts: Graph,
    pub classes: Classes,
    pub insertion: Insertion,
    pub covers: Covers,
}

/// Runs the stages of one refinement step up to the commit.
pub fn run_level(
    level: &Level,
    params: &RefineParams,
    order: Order,
    progress: &mut dyn FnMut(&'static str),
) -> (LevelState, LevelReport) {
    let mut report = LevelReport { points_in: level.len(), ..LevelReport::default() };
    let mut stage =
        |name: &'static str, begin: Instant| report.stages.push((name, begin.elapsed()));
    let mut start = |name| {
        progress(name);
        Instant::now()
    };

    let begin = start("grid");
    let grid = point_grid(level);
    stage("grid", begin);

    let begin = start("neighborhood");
    let rings = neighborhood(level, &grid, params);
    stage("neighborhood", begin);

    let begin = start("candidates");
    let candidates = candidates(level, &rings, params);
    stage("candidates", begin);

    let begin = start("conflicts");
    let candidate_grid = candidate_grid(&grid.shape, &candidates);
    let conflicts = conflicts(level, &rings, &candidates, &candidate_grid, params);
    stage("conflicts", begin);

    let begin = start("coloring");
    let classes = coloring(&conflicts);
    stage("coloring", begin);

    let begin = start("insertion");
    let inputs = Stage {
        level,
        rings: &rings,
        candidates: &candidates,
        candidate_grid: &candidate_grid,
        params,
    };
    let insertion = insertion(inputs, &classes, order);
    stage("insertion", begin);

    let begin = start("next_ring");
    let covers = next_ring(inputs, &insertion);
    stage("next_ring", begin);

    report.ball_neighbors = rings.ball_neighbors;
    report.ring_neighbors = rings.len() as u64;
    report.classes = classes.members.len();
    report.isolated = (0..level.len()).filter(|&p| rings.ring(p).is_empty()).count();
    let state = LevelState {
        grid,
        rings,
        candidates,
        candidate_grid,
        conflicts,
        classes,
        insertion,
        covers,
    };
    (state, report)
}

/// The points of a level by cell.
pub fn point_grid(level: &Level) -> Grid {
    let shape = GridShape::fit(&level.positions, &level.radii);
    Grid::build(shape, level.positions.iter().enumerate().map(|(i, &x)| (i as u32, x)))
}

/// The existing candidates by cell, in a grid of the same shape as that of the points.
pub fn candidate_grid(shape: &GridShape, candidates: &Candidates) -> Grid {
    debug_assert!(candidates.owners.len() < NO_POINT as usize);
    let slots = (0..candidates.rho.len()).filter(|&s| candidates.exists(s));
    Grid::build(*shape, slots.map(|s| (s as u32, candidates.positions[s])))
}
