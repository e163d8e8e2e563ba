//! What a refinement returns, whichever backend ran it.

use crate::PointSet;
use std::time::Duration;

/// A refined cloud with the origin of every new point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Refined {
    /// The input points, first and unchanged but for their radii, then the new points level by level.
    pub points: PointSet,
    /// The corners of the triangle of each new point, earlier points all: entry 0 belongs to the first new point.
    pub parents: Vec<[u32; 3]>,
    /// Number of points at each level: entry 0 is the input, the last entry is all of them.
    pub level_sizes: Vec<usize>,
    /// Radii of the points of each level, entry 0 the input's, if `RefineParams::keep_radii` asks for them; else empty.
    pub level_radii: Vec<Vec<f32>>,
    /// What happened at each refinement step.
    pub reports: Vec<LevelReport>,
    /// Creases and boundaries of the input.
    pub curves: CurveCounts,
    /// Bytes of the refiner's device buffers when the last step ended; `None` where no device was used.
    pub device_bytes: Option<u64>,
}

/// Creases and boundaries of a cloud (section 6).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CurveCounts {
    /// Points with two sides.
    pub crease_points: usize,
    /// Points with three sides or more.
    pub corners: usize,
    /// Pieces of creases between two of these.
    pub crease_segments: usize,
    /// Points on boundaries.
    pub boundary_points: usize,
    /// Pieces of boundaries between two of these.
    pub boundary_segments: usize,
}

/// Measures of one refinement step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LevelReport {
    /// Points before the step.
    pub points_in: usize,
    /// Points after the step.
    pub points_out: usize,
    /// Sum over all points of the size of the Euclidean neighbourhood `N^E` (eq. 7).
    pub ball_neighbors: u64,
    /// Sum over all points of the size of the one-ring `N_p`: the number of triangle fan corners.
    pub ring_neighbors: u64,
    /// Number of classes that the conflict graph was coloured with; 0 where new points are selected largest first, which needs
    /// none.
    pub classes: usize,
    /// Points without any one-ring: they have no neighbour that passed, so nothing is inserted around them.
    pub isolated: usize,
    /// Time by stage, in the order of the stages.
    pub stages: Vec<(&'static str, Duration)>,
}

impl Refined {
    /// The level of each point: 0 for input points, `l` for those that step `l` inserted.
    pub fn levels(&self) -> Vec<u8> {
        let mut levels = Vec::with_capacity(self.points.len());
        for (level, &size) in self.level_sizes.iter().enumerate() {
            levels.resize(size, level as u8);
        }
        levels
    }
}

impl LevelReport {
    /// Points after the step for each point before it.
    pub fn growth(&self) -> f64 {
        self.points_out as f64 / self.points_in.max(1) as f64
    }

    /// Time of the whole step.
    pub fn duration(&self) -> Duration {
        self.stages.iter().map(|(_, t)| *t).sum()
    }
}

/// Adds to the time of a stage: where boundaries are found the rings are made twice.
pub fn add_stage_time(
    stages: &mut Vec<(&'static str, Duration)>,
    stage: &'static str,
    time: Duration,
) {
    match stages.iter_mut().find(|(name, _)| *name == stage) {
        Some((_, sum)) => *sum += time,
        None => stages.push((stage, time)),
    }
}

/// Where a refinement stands: passed to progress callbacks at the start of each stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The step that runs, from 1.
    pub level: u32,
    /// Number of steps.
    pub levels: u32,
    /// Name of the stage that starts.
    pub stage: &'static str,
    /// Points before the step.
    pub points: usize,
}
