//! The loop over levels (section 2 of the paper) on the device.

use crate::Error;
use crate::buffers::Buffer;
use crate::clock::Clock;
use crate::curves::{self, Curves};
use crate::forecast::check_step;
use crate::records::{Counters, LEVEL_BITS, Params, Point};
use crate::refiner::{GpuRefined, Refiner};
use crate::sizing::{boundary_gaps, counted};
use crate::step::{Step, constants};
use surfine_features::{Cloud, Features, Records, check_marks, may_be_boundary};
use surfine_points::{
    Boundary, CurveCounts, GridShape, LevelReport, Ordered, PointSet, Progress, RefineParams,
};

/// What is known of a cloud between two steps of its refinement.
struct Levels {
    /// The input in the order of the device.
    ordered: Ordered,
    records: Records,
    features: Features,
    curves: CurveCounts,
    /// The grid of the next step.
    shape: GridShape,
    sizes: Vec<usize>,
    radii: Vec<Vec<f32>>,
    reports: Vec<LevelReport>,
}

impl Levels {
    fn new(points: &PointSet, params: &RefineParams) -> Result<Self, Error> {
        let ordered = Ordered::new(points);
        let records = Records::split(&ordered.points).map_err(|e| e.in_order(&ordered.order))?;
        let features = Features::creases(cloud(&records), &records.groups);
        let shape = GridShape::fit(&records.positions, &records.radii);
        let radii = params.keep_radii.then(|| records.radii.clone());
        Ok(Self {
            sizes: vec![records.len()],
            radii: Vec::from_iter(radii),
            reports: Vec::new(),
            curves: CurveCounts::default(),
            ordered,
            records,
            features,
            shape,
        })
    }

    /// Records of the last level.
    fn len(&self) -> usize {
        self.sizes[self.sizes.len() - 1]
    }

    /// Notes a step that made `on_curves` new points on creases and boundaries.
    fn add(&mut self, report: LevelReport, on_curves: usize) {
        let LevelReport { points_in, points_out, .. } = report;
        self.sizes.push(points_out);
        self.features.commit(points_out - on_curves);
        // The area stays, so the spacing goes with the root of the number of points, and the grid with it.
        let ratio = (points_in as f32 / points_out.max(1) as f32).sqrt();
        self.shape = GridShape::with_cell(self.shape.origin, self.shape.cell * ratio, points_out);
        self.reports.push(report);
    }
}

fn cloud(records: &Records) -> Cloud<'_> {
    let Records { positions, normals, radii, .. } = records;
    Cloud { positions, normals, radii }
}

impl Refiner {
    /// A whole run. If the uniforms have a pace, it is suspended wherever it waits for the device, and ends when that
    /// has finished.
    pub(crate) async fn run(
        &mut self,
        points: &PointSet,
        params: &RefineParams,
        mut progress: impl FnMut(Progress),
    ) -> Result<GpuRefined, Error> {
        params.validate()?;
        points.validate()?;
        check_marks(points, params)?;
        self.prepare(params)?;
        let result = self.run_levels(points, params, &mut progress).await?;
        if self.uniforms.is_paced() {
            self.uniforms.settle(&self.gpu).await?;
        }
        Ok(result)
    }

    async fn run_levels(
        &mut self,
        points: &PointSet,
        params: &RefineParams,
        progress: &mut impl FnMut(Progress),
    ) -> Result<GpuRefined, Error> {
        let mut levels = Levels::new(points, params)?;
        self.upload(&levels.records, &levels.features)?;
        for level in 1..=params.levels {
            let step = self.run_level(level, params, &mut levels, progress).await;
            step.map_err(|e| e.of_input(&levels.ordered.order, &levels.records.owners))?;
            if params.keep_radii {
                levels.radii.push(self.read_radii(levels.len()).await?);
            }
        }
        let device_bytes = self.buffers.size();
        Ok(GpuRefined {
            points: self.buffers.points.take(&self.gpu)?,
            parents: self.buffers.parents.take(&self.gpu)?,
            level_sizes: levels.sizes,
            level_radii: levels.radii,
            reports: levels.reports,
            curves: levels.curves,
            device_bytes,
            ordered: levels.ordered,
            records: levels.records,
            features: levels.features,
        })
    }

    /// One refinement step.
    async fn run_level(
        &mut self,
        level: u32,
        params: &RefineParams,
        levels: &mut Levels,
        progress: &mut impl FnMut(Progress),
    ) -> Result<(), Error> {
        let count = levels.len();
        check_step(&self.gpu, &self.sizing, params, (level, count))?;
        let at = Progress { level, levels: params.levels, stage: "", points: count };
        let mut clock = Clock::new(at, progress);
        let step =
            Params { points: count as u32, level, ..Params::new(params).with_grid(&levels.shape) };
        let mut rings = None;
        if level == 1 {
            if params.boundary != Boundary::None {
                rings = self.find_boundary(params, step, levels, &mut clock).await?;
            }
            levels.curves = levels.features.counts();
        }
        let features = &mut levels.features;
        let splits = Features::splits_at(level, params.rules);
        let new = if splits { features.split() } else { Vec::new() };
        if features.records.len() > MOST_RECORDS {
            let (records, most) = (features.records.len(), MOST_RECORDS);
            return Err(Error::Curves { level, records, most });
        }
        let table = curves::upload(&self.gpu, &mut self.buffers.curves, features, &new)?;
        let step = step.with_curves(&table);
        let on_curves = OnCurves::of(features, new.len());
        let earlier = count - levels.records.len();
        let report = self.run_step(params, step, rings, on_curves, earlier, &mut clock);
        let report = report.await?;
        levels.add(LevelReport { stages: clock.stop(), ..report }, new.len());
        Ok(())
    }

    fn step(
        &mut self,
        refine: &RefineParams,
        params: Params,
        on_curves: OnCurves,
    ) -> Result<Step<'_>, Error> {
        let constants = constants(refine, on_curves.curves);
        self.compile(constants.clone())?;
        let Self { gpu, kernels, uniforms, buffers, scan, sizing, .. } = self;
        let kernels = kernels.iter().find(|(c, _)| *c == constants);
        let (_, kernels) = kernels.expect("they were compiled");
        let params = Params { records: on_curves.records, ..params };
        Ok(Step {
            gpu,
            kernels,
            uniforms,
            buffers,
            scan,
            sizing,
            largest_first: refine.rules.largest_first,
            // New points on curves, which no fan has, discard others wherever these are.
            asks_contested_alone: refine.effective_contested() && on_curves.new == 0,
            next_ring: refine.effective_next_ring(),
            params,
            curve_points: on_curves.new,
        })
    }

    /// Finds the boundaries of the input (section 6). The rings that show that there are none serve the first step.
    async fn find_boundary<P: FnMut(Progress)>(
        &mut self,
        refine: &RefineParams,
        params: Params,
        levels: &mut Levels,
        clock: &mut Clock<'_, P>,
    ) -> Result<Option<Rings>, Error> {
        let Levels { ordered, records, features, .. } = levels;
        let table = curves::upload(&self.gpu, &mut self.buffers.curves, features, &[])?;
        let params = params.with_curves(&table);
        let on_curves = OnCurves::of(features, 0);
        let mut step = self.step(refine, params, on_curves)?;
        clock.start("grid");
        step.grid_points().await?;
        clock.start("neighborhood");
        let counters = step.neighborhood().await?;
        clock.start("boundary");
        let theta_b = match refine.boundary {
            Boundary::Angle(theta_b) => theta_b,
            // Whatever the gap.
            Boundary::None | Boundary::Marked(_) => 0.0,
        };
        let room = boundary_gaps(refine, step.params.points.into());
        let mut gaps = step.boundary_gaps(theta_b, room).await?;
        let slots = step.params.slots;
        gaps.retain(|gap| may_be_boundary(&ordered.points, refine, gap));
        let before = features.records.len();
        features.add_boundary(cloud(records), &gaps);
        if features.records.len() == before {
            return Ok(Some(Rings { counters, slots }));
        }
        self.upload(records, features)?;
        Ok(None)
    }

    /// Runs the stages of one refinement step. `rings` says that they are there already.
    async fn run_step<P: FnMut(Progress)>(
        &mut self,
        refine: &RefineParams,
        params: Params,
        rings: Option<Rings>,
        on_curves: OnCurves,
        earlier: usize,
        clock: &mut Clock<'_, P>,
    ) -> Result<LevelReport, Error> {
        let mut step = self.step(refine, params, on_curves)?;
        let counters = if let Some(Rings { counters, slots }) = rings {
            step.params.slots = slots;
            counters
        } else {
            clock.start("grid");
            step.grid_points().await?;
            clock.start("neighborhood");
            step.neighborhood().await?
        };
        clock.start("candidates");
        step.candidates().await?;
        let (new, before, classes) = if refine.rules.largest_first {
            clock.start("selection");
            let (new, counters) = step.selection().await?;
            (new, counters, 0)
        } else {
            clock.start("conflicts");
            let counters = step.conflicts().await?;
            clock.start("coloring");
            let classes = step.coloring().await?;
            clock.start("insertion");
            let new = step.insertion(&classes, counters.left_over).await?;
            (new, counters, classes.len() - 1)
        };
        clock.start("next_ring");
        step.next_ring(&before).await?;
        clock.start("commit");
        step.commit(new, earlier as u32).await?;
        let Counters { ball_low, ball_high, isolated, .. } = counters;
        Ok(LevelReport {
            points_in: params.points as usize,
            points_out: params.points as usize + new as usize,
            ball_neighbors: counted(ball_low, ball_high),
            ring_neighbors: u64::from(step.params.slots),
            classes,
            isolated: isolated as usize,
            stages: Vec::new(),
        })
    }

    /// Puts the input on the device.
    fn upload(&mut self, records: &Records, features: &Features) -> Result<(), Error> {
        let record_of = features.by_point(records.len());
        let points: Vec<Point> = (0..records.len())
            .map(|i| Point {
                position: records.positions[i].to_array(),
                radius: records.radii[i],
                normal: records.normals[i].to_array(),
                // No record is the largest index.
                level: record_of[i].wrapping_add(1) << LEVEL_BITS,
            })
            .collect();
        self.buffers.points = Buffer::with_data(&self.gpu, "points", &points)?;
        self.buffers.counters.reserve(&self.gpu, size_of::<Counters>() as u64)
    }
}

/// Records that fit beside the level in a word of a point.
const MOST_RECORDS: usize = (1 << (32 - LEVEL_BITS)) - 2;

/// What curves a step has.
#[derive(Clone, Copy)]
struct OnCurves {
    curves: Curves,
    /// Records before the step.
    records: u32,
    /// New points on them.
    new: u32,
}

impl OnCurves {
    fn of(features: &Features, new: usize) -> Self {
        Self { curves: Curves::of(features), records: features.old as u32, new: new as u32 }
    }
}

/// The rings of the first step.
struct Rings {
    counters: Counters,
    slots: u32,
}
