//! Where the refinement is computed.

use crate::Failure;
use crate::adapters::{is_named, is_software};
use crate::args::{BackendChoice, RefineArgs};
use crate::need::Need;
use crate::watch::Watch;
use std::time::{Duration, Instant};
use surfine::{Error, Gpu, Mode, PointSet, RefineParams, Refined, Refiner, choose_adapter, wgpu};
use surfine_reference::insertion::Order;

/// A refined cloud and how it came about.
pub(super) struct Computed {
    pub(super) refined: Refined,
    pub(super) backend: Backend,
    /// Choosing an adapter, opening it and building the kernels.
    pub(super) setup: Duration,
    /// The refinement, with the way of the points to the device and back.
    pub(super) refine: Duration,
    /// Why the CPU was taken although a GPU might have been.
    pub(super) fallback: Option<String>,
}

impl Computed {
    /// What a refinement that began then gave, up to now; the caller knows of setup and fallback.
    fn new(refined: Refined, backend: Backend, begin: Instant) -> Self {
        Self { refined, backend, setup: Duration::ZERO, refine: begin.elapsed(), fallback: None }
    }
}

/// What a refinement was computed with.
pub(super) enum Backend {
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

/// Where a refinement is to be computed.
pub(super) enum Choice {
    Cpu {
        /// Why, although a GPU might have been taken.
        fallback: Option<String>,
    },
    Gpu {
        adapter: wgpu::Adapter,
        /// Whether the CPU takes over if it fails.
        or_cpu: bool,
    },
}

impl Choice {
    /// What the arguments ask for. Without a wish it is a hardware GPU if there is one, else the CPU; an adapter that
    /// `WGPU_ADAPTER_NAME` asks for is taken whatever it is.
    pub(super) fn of(args: &RefineArgs) -> Result<Self, Error> {
        let wanted = args.adapter.as_deref();
        match args.backend() {
            BackendChoice::Cpu => Ok(Self::Cpu { fallback: None }),
            BackendChoice::Gpu => Ok(Self::Gpu { adapter: choose_adapter(wanted)?, or_cpu: false }),
            BackendChoice::Auto if is_named() => {
                Ok(Self::Gpu { adapter: choose_adapter(None)?, or_cpu: false })
            }
            BackendChoice::Auto => Ok(match choose_adapter(None) {
                Err(error) => Self::instead_of_gpu(&error.to_string()),
                Ok(adapter) if is_software(&adapter.get_info()) => {
                    let name = adapter.get_info().name;
                    let reason =
                        format!("the GPU adapter {name} is a software one, which is slower");
                    Self::instead_of_gpu(&reason)
                }
                Ok(adapter) => Self::Gpu { adapter, or_cpu: true },
            }),
        }
    }

    fn instead_of_gpu(reason: &str) -> Self {
        Self::Cpu { fallback: Some(format!("using the CPU: {reason}")) }
    }
}

/// Why the CPU is taken after a GPU has failed, unless the CPU would refuse the same.
pub(super) fn fallback_after(error: Error) -> Result<String, Error> {
    match error {
        Error::Points(_) | Error::Params(_) => Err(error),
        _ => Ok(format!("using the CPU: the GPU failed: {error}")),
    }
}

/// Refines with the backend that the arguments ask for.
pub(super) fn compute(
    args: &RefineArgs,
    points: &PointSet,
    watch: &Watch,
) -> Result<Computed, Failure> {
    let begin = Instant::now();
    let mut computed = compute_on(Choice::of(args)?, points, &args.params(), watch)?;
    computed.setup = begin.elapsed().saturating_sub(computed.refine);
    Ok(computed)
}

fn compute_on(
    choice: Choice,
    points: &PointSet,
    params: &RefineParams,
    watch: &Watch,
) -> Result<Computed, Failure> {
    let fallback = match choice {
        Choice::Cpu { fallback } => fallback,
        Choice::Gpu { adapter, or_cpu } => match on_gpu(&adapter, points, params, watch) {
            Err(error) if or_cpu => Some(fallback_after(error)?),
            result => return Ok(result?),
        },
    };
    fallback.iter().for_each(|fallback| watch.warn(fallback));
    Ok(Computed { fallback, ..on_cpu(points, params, watch)? })
}

fn on_cpu(points: &PointSet, params: &RefineParams, watch: &Watch) -> Result<Computed, Failure> {
    Need::of_cpu(points, params).fits()?.warn(watch);
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
    if let Ok(fits) = Need::of_gpu(&refiner, points, params)?.fits() {
        fits.warn(watch);
    }
    let begin = Instant::now();
    let refined = refiner.refine_with(points, params, &mut |at| watch.at(at))?;
    let backend = Backend::Gpu { adapter, mode, software };
    Ok(Computed::new(refined, backend, begin))
}
