//! How long each kernel runs on the device, by timestamp queries.

use crate::buffers::Readback;
use crate::{Error, Gpu};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// The time of one kernel over many dispatches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KernelTime {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// How often it ran.
    pub dispatches: u32,
    /// Time on the device, from begin to end of each dispatch.
    pub time: Duration,
}

/// Timestamps around dispatches.
#[derive(Debug)]
pub(crate) struct Stamps {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Nanoseconds of a tick.
    period: f32,
}

/// Bytes of a timestamp.
const TICK: u64 = 8;

impl Stamps {
    /// Room for so many dispatches.
    ///
    /// # Errors
    /// The device has no timestamps.
    pub(crate) fn new(gpu: &Gpu, dispatches: u32) -> Result<Self, Error> {
        if !gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(gpu.error(&"the device was opened without timestamps (TIMESTAMP_QUERY)"));
        }
        let set = gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("surfine times"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * dispatches,
        });
        let resolved = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("surfine times"),
            size: 2 * TICK * u64::from(dispatches),
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Ok(Self { set, resolved, period: gpu.queue.get_timestamp_period() })
    }

    /// Where a dispatch writes its times.
    pub(crate) fn writes(&self, dispatch: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(2 * dispatch),
            end_of_pass_write_index: Some(2 * dispatch + 1),
        }
    }

    /// Sends the times of the first dispatches to the host.
    pub(crate) fn read_back(&self, gpu: &Gpu, dispatches: usize) -> Readback {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.resolve_query_set(&self.set, 0..2 * dispatches as u32, &self.resolved, 0);
        Readback::submit(gpu, encoder, &[(&self.resolved, 0, 2 * TICK * dispatches as u64)])
    }

    /// The times of the dispatches whose stamps were read.
    pub(crate) fn times(&self, bytes: &[u8]) -> Vec<Duration> {
        let ticks: Vec<[u64; 2]> = bytemuck::pod_collect_to_vec(bytes);
        let time = |[begin, end]: [u64; 2]| {
            let nanoseconds = end.saturating_sub(begin) as f64 * f64::from(self.period);
            Duration::from_nanos(nanoseconds as u64)
        };
        ticks.into_iter().map(time).collect()
    }
}

/// The sums so far.
#[derive(Debug, Default)]
pub(crate) struct Profile(Mutex<Vec<KernelTime>>);

impl Profile {
    /// Adds the time of a dispatch.
    pub(crate) fn add(&self, kernel: &'static str, time: Duration) {
        let mut times = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match times.iter_mut().find(|t| t.kernel == kernel) {
            Some(sum) => (sum.dispatches, sum.time) = (sum.dispatches + 1, sum.time + time),
            None => times.push(KernelTime { kernel, dispatches: 1, time }),
        }
    }

    /// The sums since the last call, in the order in which the kernels first ran.
    pub(crate) fn take(&self) -> Vec<KernelTime> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
