//! How long each kernel runs on the device, by timestamp queries.

use crate::buffers;
use crate::{Error, Gpu};
use std::sync::Mutex;
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

/// Timestamps around the dispatches of a submission, and the sums so far.
#[derive(Debug)]
pub(crate) struct Profile {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Nanoseconds of a tick.
    period: f32,
    times: Mutex<Vec<KernelTime>>,
}

/// Bytes of a timestamp.
const TICK: u64 = 8;

impl Profile {
    /// Room for so many dispatches a submission.
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
        let period = gpu.queue.get_timestamp_period();
        Ok(Self { set, resolved, period, times: Mutex::default() })
    }

    /// Where a dispatch writes its times.
    pub(crate) fn writes(&self, dispatch: u32) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.set,
            beginning_of_pass_write_index: Some(2 * dispatch),
            end_of_pass_write_index: Some(2 * dispatch + 1),
        }
    }

    /// Records that the times of these dispatches are wanted.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder, dispatches: u32) {
        encoder.resolve_query_set(&self.set, 0..2 * dispatches, &self.resolved, 0);
    }

    /// Waits for the submission of these kernels and adds up their times.
    pub(crate) fn collect(&self, gpu: &Gpu, kernels: &[&'static str]) -> Result<(), Error> {
        let bytes = buffers::read(gpu, &self.resolved, 2 * TICK * kernels.len() as u64)?;
        let ticks: Vec<[u64; 2]> = bytemuck::pod_collect_to_vec(&bytes);
        let mut times = self.times.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        for (&kernel, [begin, end]) in kernels.iter().zip(ticks) {
            let nanoseconds = end.saturating_sub(begin) as f64 * f64::from(self.period);
            let time = Duration::from_nanos(nanoseconds as u64);
            match times.iter_mut().find(|t| t.kernel == kernel) {
                Some(sum) => (sum.dispatches, sum.time) = (sum.dispatches + 1, sum.time + time),
                None => times.push(KernelTime { kernel, dispatches: 1, time }),
            }
        }
        Ok(())
    }

    /// The sums since the last call, in the order in which the kernels first ran.
    pub(crate) fn take(&self) -> Vec<KernelTime> {
        std::mem::take(&mut *self.times.lock().unwrap_or_else(std::sync::PoisonError::into_inner))
    }
}
