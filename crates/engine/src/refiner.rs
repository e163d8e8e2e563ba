//! The loop over levels (section 2 of the paper) on the device.

use crate::buffers::{self, Buffer};
use crate::commands::Uniforms;
use crate::records::{Counters, Params, Point};
use crate::scan::Scan;
use crate::stages::{Buffers, Constants, Kernels, Sizing, Step, constants};
use crate::{Error, Gpu, choose_adapter};
use std::time::{Duration, Instant};
use surfine_points::{
    Grid, GridShape, LevelReport, PointSet, Progress, RefineParams, Refined, Vec3,
};

/// A device with compiled kernels and buffers, ready to refine one cloud after the other.
#[derive(Debug)]
pub struct Refiner {
    gpu: Gpu,
    /// Compiled once for each variant that was asked for.
    kernels: Vec<(Constants, Kernels)>,
    uniforms: Uniforms,
    buffers: Buffers,
    scan: Scan,
    sizing: Sizing,
}

/// A refined cloud that stays on the device.
#[derive(Debug)]
pub struct GpuRefined {
    /// [`Point`](crate::records::Point)s of 32 bytes: position at offset 0, radius at 12, normal at 16, level at 28.
    /// Usable as vertex or storage buffer and as copy source; it may be longer than [`GpuRefined::len`] points.
    pub points: wgpu::Buffer,
    /// The three corners of each new point's triangle, `u32` indices of points; entry 0 belongs to the first new point.
    pub parents: wgpu::Buffer,
    /// Number of points at each level: entry 0 is the input, the last entry is all of them.
    pub level_sizes: Vec<usize>,
    /// Radii of the points of each level if `RefineParams::keep_radii` asks for them; else empty.
    pub level_radii: Vec<Vec<f32>>,
    /// What happened at each refinement step.
    pub reports: Vec<LevelReport>,
    /// Bytes of the refiner's buffers when the last step ended, the result included.
    pub device_bytes: u64,
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
        let mut refiner = Self { gpu, kernels: Vec::new(), uniforms, buffers, scan, sizing };
        refiner.prepare(&RefineParams::default())?;
        Ok(refiner)
    }

    /// Compiles the kernels for these parameters, so that the first refinement need not. Those for the default
    /// parameters are compiled when the refiner is made.
    ///
    /// # Errors
    /// A kernel is refused.
    pub fn prepare(&mut self, params: &RefineParams) -> Result<(), Error> {
        let constants = constants(params);
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

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
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
        self.gpu.guarded(|| self.read_back(points, result))
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
        params.validate()?;
        points.validate()?;
        self.prepare(params)?;
        let gpu = self.gpu.clone();
        let result = gpu.guarded(|| self.run_levels(points, params, progress));
        if result.is_err() {
            // A buffer that could not be had looks like one that was.
            (self.buffers, self.scan) = (Buffers::new(&gpu)?, Scan::new(&gpu)?);
        }
        result
    }

    fn run_levels(
        &mut self,
        points: &PointSet,
        params: &RefineParams,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<GpuRefined, Error> {
        self.upload(points)?;
        let mut shape = GridShape::fit(&points.positions, &points.radii);
        let mut level_sizes = vec![points.len()];
        let mut level_radii = Vec::new();
        level_radii.extend(params.keep_radii.then(|| points.radii.clone()));
        let mut reports = Vec::new();
        for level in 1..=params.levels {
            let count = level_sizes[level_sizes.len() - 1];
            let at = Progress { level, levels: params.levels, stage: "", points: count };
            let mut clock = Clock { at, progress, times: Vec::new(), begin: Instant::now() };
            let step =
                Params { points: count as u32, level, ..Params::new(params).with_grid(&shape) };
            let input = (level == 1).then_some((&shape, points));
            let earlier = count - points.len();
            let mut report = self.run_step(params, step, input, earlier, &mut clock)?;
            report.stages = clock.stop();
            level_sizes.push(report.points_out);
            if params.keep_radii {
                level_radii.push(self.read_radii(self.buffers.points.raw(), report.points_out)?);
            }
            // The area stays, so the spacing goes with the root of the number of points, and the grid with it.
            let ratio = (count as f32 / report.points_out.max(1) as f32).sqrt();
            shape = GridShape::with_cell(shape.origin, shape.cell * ratio, report.points_out);
            reports.push(report);
        }
        let device_bytes = self.buffers.size();
        let (points, parents) =
            (self.buffers.points.take(&self.gpu)?, self.buffers.parents.take(&self.gpu)?);
        Ok(GpuRefined { points, parents, level_sizes, level_radii, reports, device_bytes })
    }

    /// Runs the stages of one refinement step. The grid of the `input` is built here, later levels make theirs.
    fn run_step(
        &mut self,
        refine: &RefineParams,
        params: Params,
        input: Option<(&GridShape, &PointSet)>,
        earlier: usize,
        clock: &mut Clock<'_>,
    ) -> Result<LevelReport, Error> {
        let Self { gpu, kernels, uniforms, buffers, scan, sizing } = self;
        let constants = constants(refine);
        let kernels = kernels.iter().find(|(c, _)| *c == constants);
        let (_, kernels) = kernels.expect("they were prepared");
        let rules = refine.rules;
        let mut step = Step { gpu, kernels, uniforms, buffers, scan, sizing, rules, params };
        clock.start("grid");
        match input {
            Some((shape, points)) => {
                let positions = points.positions.iter().copied();
                step.upload_grid(&Grid::build(*shape, (0..).zip(positions)))?;
            }
            None => step.grid_points()?,
        }
        clock.start("neighborhood");
        let counters = step.neighborhood()?;
        clock.start("candidates");
        step.candidates()?;
        clock.start("conflicts");
        step.conflicts()?;
        clock.start("coloring");
        let classes = step.coloring()?;
        clock.start("insertion");
        let new = step.insertion(&classes)?;
        clock.start("next_ring");
        step.next_ring()?;
        clock.start("commit");
        step.commit(new, earlier as u32)?;
        let Counters { ball_low, ball_high, isolated, .. } = counters;
        Ok(LevelReport {
            points_in: params.points as usize,
            points_out: params.points as usize + new as usize,
            ball_neighbors: u64::from(ball_high) << 32 | u64::from(ball_low),
            ring_neighbors: u64::from(step.params.slots),
            classes: classes.len() - 1,
            isolated: isolated as usize,
            stages: Vec::new(),
        })
    }

    fn upload(&mut self, points: &PointSet) -> Result<(), Error> {
        let normals = points.unit_normals();
        let records: Vec<Point> = (0..points.len())
            .map(|i| Point {
                position: points.positions[i].to_array(),
                radius: points.radii[i],
                normal: normals[i].to_array(),
                level: 0,
            })
            .collect();
        self.buffers.points = Buffer::with_data(&self.gpu, "points", &records)?;
        self.buffers.counters.reserve(&self.gpu, size_of::<Counters>() as u64)
    }

    fn read_radii(&self, points: &wgpu::Buffer, count: usize) -> Result<Vec<f32>, Error> {
        let bytes = buffers::read(&self.gpu, points, (count * size_of::<Point>()) as u64)?;
        let records: Vec<Point> = bytemuck::pod_collect_to_vec(&bytes);
        Ok(records.iter().map(|p| p.radius).collect())
    }

    fn read_back(&self, input: &PointSet, result: GpuRefined) -> Result<Refined, Error> {
        let bytes = (result.len() * size_of::<Point>()) as u64;
        let points = buffers::read(&self.gpu, &result.points, bytes)?;
        let new = result.len() - input.len();
        let parents = buffers::read(&self.gpu, &result.parents, 12 * new as u64)?;
        let parents: Vec<[u32; 3]> = bytemuck::pod_collect_to_vec(&parents);
        let mut refined = input.clone();
        let records: Vec<Point> = bytemuck::pod_collect_to_vec(&points);
        refined.radii = records.iter().map(|p| p.radius).collect();
        let new = &records[input.len()..];
        refined.positions.extend(new.iter().map(|p| Vec3::from_array(p.position)));
        refined.normals.extend(new.iter().map(|p| Vec3::from_array(p.normal)));
        refined.extend_attributes(&parents);
        let GpuRefined { level_sizes, level_radii, reports, device_bytes, .. } = result;
        let device_bytes = Some(device_bytes);
        Ok(Refined { points: refined, parents, level_sizes, level_radii, reports, device_bytes })
    }
}

/// Times the stages and tells the caller where the run stands.
struct Clock<'a> {
    at: Progress,
    progress: &'a mut dyn FnMut(Progress),
    times: Vec<(&'static str, Duration)>,
    begin: Instant,
}

impl Clock<'_> {
    fn start(&mut self, stage: &'static str) {
        self.close();
        self.at.stage = stage;
        (self.progress)(self.at);
    }

    fn close(&mut self) {
        if !self.at.stage.is_empty() {
            self.times.push((self.at.stage, self.begin.elapsed()));
        }
        self.begin = Instant::now();
    }

    fn stop(mut self) -> Vec<(&'static str, Duration)> {
        self.close();
        self.times
    }
}
