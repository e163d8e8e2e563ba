//! The loop over levels (section 2 of the paper) on the device.

use crate::buffers::{self, Buffer};
use crate::curves::{self, Curves};
use crate::forecast::{Forecast, check_step};
use crate::pace::Pace;
use crate::profile::{KernelTime, Profile};
use crate::records::{Counters, LEVEL_BITS, Params, Point};
use crate::scan::Scan;
use crate::stages::{Buffers, Constants, Kernels, Sizing, Step, constants};
use crate::uniforms::Uniforms;
use crate::{Error, Gpu, choose_adapter};
use rayon::prelude::*;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use surfine_features::{
    Cloud, Features, Folded, Records, Refinement, check_marks, fold, may_be_boundary,
};
use surfine_points::{
    Boundary, CurveCounts, GridShape, Invalid, LevelReport, Ordered, PointSet, Progress,
    RefineParams, Refined, Vec3, add_stage_time,
};

/// A device with compiled kernels and buffers, ready to refine one cloud after the other.
#[derive(Debug)]
pub struct Refiner {
    gpu: Gpu,
    /// Compiled once for each variant that was asked for.
    kernels: Vec<(Constants, Kernels)>,
    pub(crate) uniforms: Uniforms,
    /// What is known of the kernels' times, for runs in slices.
    pub(crate) pace: Arc<Mutex<Pace>>,
    buffers: Buffers,
    scan: Scan,
    sizing: Sizing,
}

/// A refined cloud that stays on the device.
#[derive(Debug)]
pub struct GpuRefined {
    /// [`Point`](crate::records::Point)s of 32 bytes: position at offset 0, radius at 12, normal at 16, level in the byte at
    /// 28. Usable as vertex or storage buffer and as copy source; it may be longer than [`GpuRefined::len`] points, and than the device
    /// allows in one binding. They are in the order of
    /// `ordered`. A point on a crease is one of these for each of its sides: those of further normals follow the input points, and the new
    /// ones follow each other.
    pub points: wgpu::Buffer,
    /// The three corners of each new point's triangle, `u32` indices of points; entry 0 belongs to the first new point.
    pub parents: wgpu::Buffer,
    /// Number of records at each level: entry 0 is the input, the last entry is all of them.
    pub level_sizes: Vec<usize>,
    /// Radii of the points of each level if `RefineParams::keep_radii` asks for them; else empty.
    pub level_radii: Vec<Vec<f32>>,
    /// What happened at each refinement step.
    pub reports: Vec<LevelReport>,
    /// Creases and boundaries of the input.
    pub curves: CurveCounts,
    /// Bytes of the refiner's buffers when the last step ended, the result included.
    pub device_bytes: u64,
    /// The input in the order of the device, with the index of each point in the caller's order: the refiner puts points that
    /// are near each other next to each other.
    pub ordered: Ordered,
    /// The same with one record for each normal.
    records: Records,
    /// Creases and boundaries of the last level.
    features: Features,
}

impl GpuRefined {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.level_sizes.last().copied().unwrap_or(0)
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Refiner {
    /// Opens the adapter of that name, or the best one (hardware before software; `WGPU_ADAPTER_NAME` is respected),
    /// and compiles the kernels.
    ///
    /// # Errors
    /// There is no such adapter, or its driver fails.
    pub fn new(adapter: Option<&str>) -> Result<Self, Error> {
        Self::with_gpu(Gpu::open(&choose_adapter(adapter)?)?)
    }

    /// Uses the caller's device. Results are bit-exact if it is a Vulkan device that was opened with
    /// `wgpu::Features::PASSTHROUGH_SHADERS`; see [`Mode`](crate::Mode).
    ///
    /// # Errors
    /// A kernel is refused, for instance because the device's limits are below ten storage buffers a stage.
    pub fn with_device(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, Error> {
        Self::with_gpu(Gpu::from_device(device, queue))
    }

    /// Uses a device that [`Gpu`] describes.
    ///
    /// # Errors
    /// As [`Refiner::with_device`].
    pub fn with_gpu(gpu: Gpu) -> Result<Self, Error> {
        let uniforms = Uniforms::new(&gpu);
        let (buffers, scan) = gpu.guarded(|| Ok((Buffers::new(&gpu)?, Scan::new(&gpu)?)))?;
        let sizing = Sizing::default();
        let (kernels, pace) = (Vec::new(), Arc::default());
        let mut refiner = Self { gpu, kernels, uniforms, pace, buffers, scan, sizing };
        refiner.prepare(&RefineParams::default())?;
        Ok(refiner)
    }

    /// Compiles the kernels for these parameters, so that the first refinement need not. Those for the default
    /// parameters are compiled when the refiner is made.
    ///
    /// # Errors
    /// A kernel is refused.
    pub fn prepare(&mut self, params: &RefineParams) -> Result<(), Error> {
        self.compile(constants(params, Curves::None))
    }

    /// [`Refiner::prepare`] for clouds with creases or boundaries, which have kernels of their own: else these are compiled when
    /// the first one is met.
    ///
    /// # Errors
    /// A kernel is refused.
    pub fn prepare_curves(&mut self, params: &RefineParams) -> Result<(), Error> {
        self.compile(constants(params, Curves::Boundaries))?;
        self.compile(constants(params, Curves::Creases))
    }

    fn compile(&mut self, constants: Constants) -> Result<(), Error> {
        if self.kernels.iter().all(|(c, _)| *c != constants) {
            let kernels = Kernels::new(&self.gpu, &constants)?;
            self.kernels.push((constants, kernels));
        }
        Ok(())
    }

    /// Sets how much is done and provided for at once. No result depends on it; tests shrink it.
    #[doc(hidden)]
    pub fn set_sizing(&mut self, sizing: Sizing) {
        self.sizing = sizing;
    }

    /// Begins to take the times of kernels on the device, or ends it. The host then waits for every submission, so whole runs
    /// take a little longer.
    ///
    /// # Errors
    /// The device was opened without `wgpu::Features::TIMESTAMP_QUERY`; [`Gpu::open`] asks for it where the adapter has it.
    pub fn set_profiling(&mut self, on: bool) -> Result<(), Error> {
        self.uniforms.set_profiling(&self.gpu, on)
    }

    /// The times of the kernels since the last call, in the order in which they first ran; empty unless
    /// [`Refiner::set_profiling`] asked for them.
    pub fn take_profile(&mut self) -> Vec<KernelTime> {
        self.uniforms.profile.as_ref().map(Profile::take).unwrap_or_default()
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// What a refinement will need, about.
    ///
    /// # Errors
    /// As [`Refiner::refine`], as far as that is sure before anything is computed.
    pub fn forecast(&self, points: &PointSet, params: &RefineParams) -> Result<Forecast, Error> {
        params.validate()?;
        points.validate()?;
        check_marks(points, params)?;
        let records = Records::split(points)?.len();
        if params.levels > 0 {
            check_step(&self.gpu, &self.sizing, params, (1, records))?;
        }
        let limit = self.gpu.largest_binding();
        Ok(Forecast::new(points.len(), records, params, &self.sizing, limit))
    }

    /// Refines a point set and reads the result back.
    ///
    /// # Errors
    /// Unfit points or parameters, or the device fails or is too small.
    pub fn refine(&mut self, points: &PointSet, params: &RefineParams) -> Result<Refined, Error> {
        self.refine_with(points, params, &mut |_| ())
    }

    /// [`Refiner::refine`], with a call at the start of each stage.
    ///
    /// # Errors
    /// As [`Refiner::refine`].
    pub fn refine_with(
        &mut self,
        points: &PointSet,
        params: &RefineParams,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Refined, Error> {
        let result = self.refine_on_device(points, params, progress)?;
        self.gpu.guarded(|| self.read_back(points, params, result))
    }

    /// Refines a point set and leaves the result on the device. Attributes stay behind: interpolate them from the
    /// parents, or use [`Refiner::refine`].
    ///
    /// # Errors
    /// As [`Refiner::refine`].
    pub fn refine_on_device(
        &mut self,
        points: &PointSet,
        params: &RefineParams,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<GpuRefined, Error> {
        let gpu = self.gpu.clone();
        // Nothing suspends the run: the device is waited for.
        let run = self.run(points, params, progress);
        let result = gpu.guarded(|| pollster::block_on(run));
        if result.is_err() {
            self.renew()?;
        }
        result
    }

    /// Makes the buffers anew: after a failure one that could not be had looks like one that was.
    pub(crate) fn renew(&mut self) -> Result<(), Error> {
        self.uniforms.forget();
        (self.buffers, self.scan) = (Buffers::new(&self.gpu)?, Scan::new(&self.gpu)?);
        Ok(())
    }

    /// A whole run. If the uniforms have a pace, it is suspended wherever it waits for the device, and ends when that has
    /// finished.
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
        let ordered = Ordered::new(points);
        let points = &ordered.points;
        let records = Records::split(points).map_err(|e| e.in_order(&ordered.order))?;
        let Records { positions, normals, radii, groups, .. } = &records;
        let mut features = Features::creases(Cloud { positions, normals, radii }, groups);
        self.upload(&records, &features)?;
        let mut shape = GridShape::fit(positions, radii);
        let mut level_sizes = vec![records.len()];
        let mut level_radii = Vec::new();
        level_radii.extend(params.keep_radii.then(|| radii.clone()));
        let mut reports = Vec::new();
        let mut counts = CurveCounts::default();
        for level in 1..=params.levels {
            let count = level_sizes[level_sizes.len() - 1];
            check_step(&self.gpu, &self.sizing, params, (level, count))?;
            let at = Progress { level, levels: params.levels, stage: "", points: count };
            let mut clock = Clock { at, progress, times: Vec::new(), begin: Instant::now() };
            let step =
                Params { points: count as u32, level, ..Params::new(params).with_grid(&shape) };
            let mut rings = None;
            if level == 1 && params.boundary != Boundary::None {
                let input = (points, &records);
                let found = self.find_boundary(params, step, input, &mut features, &mut clock);
                rings = found.await?;
            }
            if level == 1 {
                counts = features.counts();
            }
            let new = if Features::splits_at(level, params.rules) {
                features.split()
            } else {
                Vec::new()
            };
            if features.records.len() > MOST_RECORDS {
                return Err(Invalid::TooMany(features.records.len()).into());
            }
            let table = curves::upload(&self.gpu, &mut self.buffers.curves, &features, &new)?;
            let step = step.with_curves(&table);
            let on_curves = OnCurves::of(&features, new.len());
            let earlier = count - records.len();
            let report = self.run_step(params, step, rings, on_curves, earlier, &mut clock);
            let mut report = report.await?;
            report.stages = clock.stop();
            level_sizes.push(report.points_out);
            features.commit(report.points_out - new.len());
            if params.keep_radii {
                level_radii.push(self.read_radii(report.points_out).await?);
            }
            // The area stays, so the spacing goes with the root of the number of points, and the grid with it.
            let ratio = (count as f32 / report.points_out.max(1) as f32).sqrt();
            shape = GridShape::with_cell(shape.origin, shape.cell * ratio, report.points_out);
            reports.push(report);
        }
        let device_bytes = self.buffers.size();
        let (points, parents) =
            (self.buffers.points.take(&self.gpu)?, self.buffers.parents.take(&self.gpu)?);
        Ok(GpuRefined {
            points,
            parents,
            level_sizes,
            level_radii,
            reports,
            curves: counts,
            device_bytes,
            ordered,
            records,
            features,
        })
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
        (points, records): (&PointSet, &Records),
        features: &mut Features,
        clock: &mut Clock<'_, P>,
    ) -> Result<Option<Rings>, Error> {
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
        let mut gaps = step.boundary_gaps(theta_b).await?;
        let slots = step.params.slots;
        gaps.retain(|gap| may_be_boundary(points, refine, gap));
        let Records { positions, normals, radii, .. } = records;
        let before = features.records.len();
        features.add_boundary(Cloud { positions, normals, radii }, &gaps);
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
        let (new, left_over, classes) = if refine.rules.largest_first {
            clock.start("selection");
            let (new, left_over) = step.selection().await?;
            (new, left_over, 0)
        } else {
            clock.start("conflicts");
            let left_over = step.conflicts().await?.left_over;
            clock.start("coloring");
            let classes = step.coloring().await?;
            clock.start("insertion");
            (step.insertion(&classes, left_over).await?, left_over, classes.len() - 1)
        };
        clock.start("next_ring");
        step.next_ring(left_over).await?;
        clock.start("commit");
        step.commit(new, earlier as u32).await?;
        let Counters { ball_low, ball_high, isolated, .. } = counters;
        Ok(LevelReport {
            points_in: params.points as usize,
            points_out: params.points as usize + new as usize,
            ball_neighbors: u64::from(ball_high) << 32 | u64::from(ball_low),
            ring_neighbors: u64::from(step.params.slots),
            classes,
            isolated: isolated as usize,
            stages: Vec::new(),
        })
    }

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

    async fn read_radii(&self, count: usize) -> Result<Vec<f32>, Error> {
        let bytes = (count * size_of::<Point>()) as u64;
        let parts = [(self.buffers.points.raw(), 0, bytes)];
        let points = self.uniforms.read(&self.gpu, &parts).await?;
        let points: Vec<Point> = bytemuck::pod_collect_to_vec(&points);
        Ok(points.iter().map(|p| p.radius).collect())
    }

    fn read_back(
        &self,
        input: &PointSet,
        params: &RefineParams,
        result: GpuRefined,
    ) -> Result<Refined, Error> {
        let new = result.len() - result.records.len();
        let (positions, normals, radii) =
            buffers::read(&self.gpu, &result.points, result.len(), columns)?;
        let parents = buffers::read(&self.gpu, &result.parents, new, <[[u32; 3]]>::to_vec)?;
        let GpuRefined { level_sizes, level_radii, reports, curves, device_bytes, .. } = result;
        let (ordered, records, features) = (result.ordered, result.records, result.features);
        let refinement =
            Refinement { positions, normals, radii, parents, level_sizes, level_radii };
        let folded =
            fold(&ordered.points, &records, &features, refinement, params.boundary.property());
        let mut reports = reports;
        folded.count_points(&mut reports);
        let Folded { points, parents, level_sizes, level_radii } = folded;
        let device_bytes = Some(device_bytes);
        let mut refined =
            Refined { points, parents, level_sizes, level_radii, reports, curves, device_bytes };
        ordered.restore(input, &mut refined);
        Ok(refined)
    }
}

/// Positions, normals and radii of points.
fn columns(points: &[Point]) -> (Vec<Vec3>, Vec<Vec3>, Vec<f32>) {
    let vectors = |of: fn(&Point) -> [f32; 3]| {
        points.par_iter().map(|point| Vec3::from_array(of(point))).collect()
    };
    let radii = points.par_iter().map(|point| point.radius).collect();
    (vectors(|point| point.position), vectors(|point| point.normal), radii)
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

/// Times the stages and tells the caller where the run stands.
struct Clock<'a, P> {
    at: Progress,
    progress: &'a mut P,
    times: Vec<(&'static str, Duration)>,
    begin: Instant,
}

impl<P: FnMut(Progress)> Clock<'_, P> {
    fn start(&mut self, stage: &'static str) {
        self.close();
        self.at.stage = stage;
        (self.progress)(self.at);
    }

    fn close(&mut self) {
        if !self.at.stage.is_empty() {
            add_stage_time(&mut self.times, self.at.stage, self.begin.elapsed());
        }
        self.begin = Instant::now();
    }

    fn stop(mut self) -> Vec<(&'static str, Duration)> {
        self.close();
        self.times
    }
}
