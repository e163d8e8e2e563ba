//! Where the refinement is computed.

use crate::Failure;
use crate::adapters::is_software;
use crate::args::{BackendChoice, RefineArgs};
use crate::watch::Watch;
use std::time::{Duration, Instant};
use surfine::{Error, Gpu, Mode, PointSet, RefineParams, Refined, Refiner, choose_adapter, wgpu};
use surfine_reference::insertion::Order;

/// A refined cloud and how it came about.
pub(crate) struct Computed {
    pub(crate) refined: Refined,
    pub(crate) backend: Backend,
    /// Choosing an adapter, opening it and building the kernels.
    pub(crate) setup: Duration,
    /// The refinement, with the way of the points to the device and back.
    pub(crate) refine: Duration,
    /// Why the CPU was taken although a GPU might have been.
    pub(crate) fallback: Option<String>,
}

impl Computed {
    /// What a refinement that began then gave, up to now; the caller knows of setup and fallback.
    fn new(refined: Refined, backend: Backend, begin: Instant) -> Self {
        Self { refined, backend, setup: Duration::ZERO, refine: begin.elapsed(), fallback: None }
    }
}

/// What a refinement was computed with.
pub(crate) enum Backend {
    Gpu {
        adapter: String,
        mode: Mode,
        /// Whether the adapter computes on the CPU.
        software: bool,
    },
    Cpu {
        threads: usize,
    },
}

/// Gives the CPU backend its threads; without a wish, those of `RAYON_NUM_THREADS` or one a core.
pub(crate) fn start_threads(wanted: Option<u16>) -> Result<(), Failure> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(wanted.unwrap_or(0).into());
    let failed = |e| Failure(format!("threads cannot be started: {e}: ask for fewer (--threads)"));
    builder.build_global().map_err(failed)
}

/// Refines with the backend that the arguments ask for.
pub(crate) fn compute(
    args: &RefineArgs,
    points: &PointSet,
    watch: &Watch,
) -> Result<Computed, Failure> {
    let params = args.params();
    let begin = Instant::now();
    let mut computed = match args.backend() {
        BackendChoice::Cpu => on_cpu(points, &params, watch)?,
        BackendChoice::Gpu => {
            let adapter = choose_adapter(args.adapter.as_deref())?;
            on_gpu(&adapter, points, &params, watch)?
        }
        BackendChoice::Auto => on_either(points, &params, watch)?,
    };
    computed.setup = begin.elapsed().saturating_sub(computed.refine);
    Ok(computed)
}

/// A hardware GPU if there is one that can do it, else the CPU. An adapter that `WGPU_ADAPTER_NAME` asks for is taken
/// whatever it is.
fn on_either(points: &PointSet, params: &RefineParams, watch: &Watch) -> Result<Computed, Failure> {
    if std::env::var("WGPU_ADAPTER_NAME").is_ok_and(|name| !name.is_empty()) {
        return Ok(on_gpu(&choose_adapter(None)?, points, params, watch)?);
    }
    let reason = match choose_adapter(None) {
        Err(error) => error.to_string(),
        Ok(adapter) if is_software(&adapter.get_info()) => {
            let name = adapter.get_info().name;
            format!("the GPU adapter {name} is a software one, which is slower")
        }
        Ok(adapter) => match on_gpu(&adapter, points, params, watch) {
            Ok(computed) => return Ok(computed),
            // The CPU would refuse them too.
            Err(error @ (Error::Points(_) | Error::Params(_))) => return Err(error.into()),
            Err(error) => format!("the GPU failed: {error}"),
        },
    };
    let fallback = format!("using the CPU: {reason}");
    watch.warn(&fallback);
    Ok(Computed { fallback: Some(fallback), ..on_cpu(points, params, watch)? })
}

fn on_cpu(points: &PointSet, params: &RefineParams, watch: &Watch) -> Result<Computed, Failure> {
    let begin = Instant::now();
    let refined =
        surfine_reference::refine_with(points, params, Order::Together, &mut |at| watch.at(at))?;
    let backend = Backend::Cpu { threads: rayon::current_num_threads() };
    Ok(Computed::new(refined, backend, begin))
}

fn on_gpu(
    adapter: &wgpu::Adapter,
    points: &PointSet,
    params: &RefineParams,
    watch: &Watch,
) -> Result<Computed, Error> {
    let mut refiner = Refiner::with_gpu(Gpu::open(adapter)?)?;
    let software = is_software(&adapter.get_info());
    let Gpu { mode, name: adapter, .. } = refiner.gpu().clone();
    let begin = Instant::now();
    let refined = refiner.refine_with(points, params, &mut |at| watch.at(at))?;
    let backend = Backend::Gpu { adapter, mode, software };
    Ok(Computed::new(refined, backend, begin))
}

/// Whether an adapter is taken where the user leaves the choice: a hardware one, or one that `WGPU_ADAPTER_NAME` names.
pub(crate) fn is_preferred(adapter: &wgpu::Adapter) -> bool {
    let named = std::env::var("WGPU_ADAPTER_NAME").is_ok_and(|name| !name.is_empty());
    named || !is_software(&adapter.get_info())
}
