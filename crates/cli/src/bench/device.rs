//! The adapter that is measured.

use super::report::Gpu;
use crate::adapters::{Description, is_preferred, shares_memory};
use crate::args::{BenchArgs, BenchBackend};
use std::fmt::Display;
use std::time::Instant;
use surfine::{Error, Refiner, choose_adapter, wgpu};

/// An open adapter.
pub(super) struct Device {
    pub(super) refiner: Refiner,
    /// Whether its buffers are in the memory of the host.
    pub(super) is_on_host: bool,
    pub(super) report: Gpu,
}

/// What there is to measure beside the CPU.
#[derive(Default)]
pub(super) struct Choice {
    pub(super) device: Option<Device>,
    /// Why there is no device although one might have been.
    pub(super) note: Option<String>,
}

/// The adapter that the arguments ask for.
pub(super) fn open(args: &BenchArgs) -> Result<Choice, Error> {
    let choose = || choose_adapter(args.adapter.as_deref());
    let opened = || Device::new(&choose()?);
    match args.backend() {
        BenchBackend::Cpu => Ok(Choice::default()),
        BenchBackend::Gpu => Ok(Choice::of(opened()?)),
        BenchBackend::Both if args.adapter.is_some() => Ok(Choice::of(opened()?)),
        BenchBackend::Both => Ok(opened().map_or_else(|e| Choice::none(&e), Choice::of)),
        BenchBackend::Auto => Ok(match choose() {
            Ok(adapter) if !is_preferred(&adapter.get_info()) => {
                let name = adapter.get_info().name;
                Choice::none(&format_args!("the GPU adapter {name} is a software one"))
            }
            _ => opened().map_or_else(|e| Choice::none(&e), Choice::of),
        }),
    }
}

impl Choice {
    fn of(device: Device) -> Self {
        Self { device: Some(device), note: None }
    }

    fn none(why: &impl Display) -> Self {
        Self { device: None, note: Some(format!("only the CPU is measured: {why}")) }
    }
}

impl Device {
    fn new(adapter: &wgpu::Adapter) -> Result<Self, Error> {
        let begin = Instant::now();
        let refiner = Refiner::with_gpu(surfine::Gpu::open(adapter)?)?;
        let setup_seconds = begin.elapsed().as_secs_f64();
        let is_on_host = shares_memory(adapter.get_info().device_type);
        let report = Gpu { adapter: Description::new(adapter), setup_seconds };
        Ok(Self { refiner, is_on_host, report })
    }
}
