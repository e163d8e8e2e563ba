//! The refiner and what it gives.

use crate::curves::Curves;
use crate::forecast::{Forecast, check_step};
use crate::pace::Pace;
use crate::profile::{KernelTime, Profile};
use crate::scan::Scan;
use crate::sizing::Sizing;
use crate::step::{Buffers, Constants, Kernels, constants};
use crate::uniforms::Uniforms;
use crate::{Error, Gpu, choose_adapter};
use std::sync::{Arc, Mutex};
use surfine_features::{Features, Records, check_marks};
use surfine_points::{
    CurveCounts, LevelReport, Ordered, PointSet, Progress, RefineParams, Refined,
};

/// A device with compiled kernels and buffers, ready to refine one cloud after the other.
#[derive(Debug)]
pub struct Refiner {
    pub(crate) gpu: Gpu,
    /// Compiled once for each variant that was asked for.
    pub(crate) kernels: Vec<(Constants, Kernels)>,
    pub(crate) uniforms: Uniforms,
    /// What is known of the kernels' times, for runs in slices.
    pub(crate) pace: Arc<Mutex<Pace>>,
    pub(crate) buffers: Buffers,
    pub(crate) scan: Scan,
    pub(crate) sizing: Sizing,
}

/// A refined cloud that stays on the device.
#[derive(Debug)]
pub struct GpuRefined {
    /// [`Point`](crate::Point)s of 32 bytes: position at offset 0, radius at 12, normal at 16, level in the byte at
    /// 28. Usable as vertex or storage buffer and as copy source; it may be longer than [`GpuRefined::len`] of them,
    /// and than the device allows in one binding. The input comes first, in the order of `ordered`. A point on a crease
    /// is one of these records for each of its sides: those of further normals follow the input points, and the new
    /// ones follow each other.
    pub points: wgpu::Buffer,
    /// The three corners of each new record's triangle, `u32` indices into `points`; entry 0 belongs to the first new
    /// one. A new point on a crease or boundary lies between two: the nearer one stands there twice.
    pub parents: wgpu::Buffer,
    /// Number of records at each level: entry 0 is the input, the last entry is all of them.
    pub level_sizes: Vec<usize>,
    /// Radii of the records of each level, in the order of `points`, if `RefineParams::keep_radii` asks for them; else
    /// empty.
    pub level_radii: Vec<Vec<f32>>,
    /// What happened at each refinement step, in records: a point on a crease counts once for each side.
    pub reports: Vec<LevelReport>,
    /// Creases and boundaries of the input.
    pub curves: CurveCounts,
    /// Bytes of the refiner's buffers when the last step ended, the result included. A buffer that grows and keeps its
    /// content is there twice for a moment: at most the points before the last step come on top.
    pub device_bytes: u64,
    /// The input in the order of the device, with the index of each point in the caller's order: the refiner puts
    /// points that are near each other next to each other.
    pub ordered: Ordered,
    /// The same with one record for each normal.
    pub(crate) records: Records,
    /// Creases and boundaries of the last level.
    pub(crate) features: Features,
}

impl GpuRefined {
    /// Number of records in `points`: a point on a crease counts once for each side.
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

    /// Uses the caller's device. On a Vulkan device that was opened with `wgpu::Features::PASSTHROUGH_SHADERS`, and
    /// whose driver rounds divisions and square roots correctly, results have the bytes of the CPU reference; see
    /// [`Mode`](crate::Mode).
    ///
    /// # Errors
    /// A kernel is refused, for instance because the device was opened with limits below ten storage buffers a stage.
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

    /// [`Refiner::prepare`] for clouds with creases or boundaries, which have kernels of their own: else these are
    /// compiled when the first one is met.
    ///
    /// # Errors
    /// A kernel is refused.
    pub fn prepare_curves(&mut self, params: &RefineParams) -> Result<(), Error> {
        self.compile(constants(params, Curves::Boundaries))?;
        self.compile(constants(params, Curves::Creases))
    }

    pub(crate) fn compile(&mut self, constants: Constants) -> Result<(), Error> {
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

    /// Begins to take the times of kernels on the device, or ends it. The host then waits for every submission, so
    /// whole runs take a little longer.
    ///
    /// # Errors
    /// The device was opened without `wgpu::Features::TIMESTAMP_QUERY`; [`Gpu::open`] asks for it where the adapter has
    /// it.
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
    /// * [`Error::Points`], [`Error::Params`]: unfit input.
    /// * [`Error::TooLarge`], [`Error::Limit`], [`Error::Bindings`]: the device has too little room.
    /// * [`Error::Curves`]: more points on creases and boundaries than a word numbers beside the level.
    /// * [`Error::Crowded`]: the driver ends long loops, as software drivers do.
    /// * [`Error::Kernel`], [`Error::Device`]: the driver fails, or the device was lost.
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
            self.renew();
        }
        result
    }

    /// Makes the buffers anew: after a failure one that could not be had looks like one that was.
    pub(crate) fn renew(&mut self) {
        self.uniforms.forget();
        let gpu = &self.gpu;
        // Where that fails too, the next run tells.
        if let Ok(fresh) = gpu.guarded(|| Ok((Buffers::new(gpu)?, Scan::new(gpu)?))) {
            (self.buffers, self.scan) = fresh;
        }
    }
}
