//! How fast this machine refines, from a moment's run.

use std::time::{Duration, Instant};
use surfine::{Boundary, PointSet, RefineParams};
use surfine_points::shapes::{Sampling, Shape, sample};

/// Points of the sphere; its levels are refined from them.
const POINTS: usize = 1000;
/// A run that takes so long tells enough.
const ENOUGH: Duration = Duration::from_millis(250);
/// New points that tell enough, however fast they came.
const MOST: u64 = 3_000_000;

/// What refining a small sphere took.
pub(super) struct Pace {
    /// Points of the largest sphere that was made.
    pub(super) points: usize,
    /// New points of that run.
    new: usize,
    pub(super) time: Duration,
    /// One step of a small sphere: a step takes no less.
    step: Duration,
}

impl Pace {
    /// Refines the sphere, by more and more levels until a run tells enough or is as large as what is asked for.
    pub(super) fn measure<E>(
        params: &RefineParams,
        size: u64,
        refine: &mut dyn FnMut(&PointSet, &RefineParams) -> Result<usize, E>,
    ) -> Result<Self, E> {
        let sphere = sample(Shape::Sphere, Sampling::BlueNoise, POINTS, 1);
        let mut run = |levels| {
            let params = on_sphere(params, levels);
            let begin = Instant::now();
            let points = refine(&sphere, &params)?;
            let (new, time) = (points - POINTS, begin.elapsed());
            Ok(Self { points, new, time, step: time / levels })
        };
        // Kernels are compiled, threads start.
        run(1)?;
        let mut pace = run(1)?;
        for levels in 2..=params.levels.max(2) + 8 {
            if pace.time >= ENOUGH || pace.points as u64 >= size.min(MOST) {
                break;
            }
            let step = pace.step;
            pace = Self { step, ..run(levels)? };
        }
        Ok(pace)
    }

    /// Seconds for a cloud of these sizes.
    pub(super) fn seconds(&self, points_by_level: &[u64]) -> f64 {
        let each = self.time.as_secs_f64() / self.new.max(1) as f64;
        let steps = points_by_level.windows(2);
        // A step at least: of a small cloud it costs what its dispatches cost.
        steps.map(|pair| (each * (pair[1] - pair[0]) as f64).max(self.step.as_secs_f64())).sum()
    }
}

/// The same parameters for a sphere, which has no property that marks a boundary.
fn on_sphere(params: &RefineParams, levels: u32) -> RefineParams {
    let boundary = match &params.boundary {
        Boundary::Marked(_) => Boundary::None,
        other => other.clone(),
    };
    RefineParams { levels, boundary, ..params.clone() }
}
