//! What the submissions of a refiner share: the uniforms of the kernels, and the clock that times these.

use crate::buffers::Readback;
use crate::pace::Pace;
use crate::profile::{Profile, Stamps};
use crate::records::{Dispatch, Params};
use crate::{Error, Gpu};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::task::Poll;
use std::time::{Duration, Instant};

/// Distance between the uniforms of two dispatches: the largest alignment that adapters ask for.
pub(crate) const STRIDE: u64 = 256;
/// Dispatches of one submission.
pub(crate) const CAPACITY: u64 = 512;

/// The two uniforms of every kernel: that of the step, and one for each dispatch of a submission.
#[derive(Debug)]
pub struct Uniforms {
    step: wgpu::Buffer,
    dispatches: wgpu::Buffer,
    stamps: Option<Stamps>,
    /// The times of the kernels, if they are wanted.
    pub(crate) profile: Option<Profile>,
    /// Says how much may be submitted at once, if the run goes in slices.
    pub(crate) pace: Option<Arc<Mutex<Pace>>>,
    /// What was dispatched since the last wait, if it is timed.
    timed: Mutex<Timed>,
}

/// Dispatches whose times are not known yet.
#[derive(Debug, Default)]
struct Timed {
    /// Kernels and invocations; none where their number is not known.
    dispatches: Vec<(&'static str, u32)>,
    begin: Option<Instant>,
}

impl Uniforms {
    /// Allocates both.
    pub fn new(gpu: &Gpu) -> Self {
        let create = |label, size| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Self {
            step: create("surfine params", size_of::<Params>() as u64),
            dispatches: create("surfine dispatches", CAPACITY * STRIDE),
            stamps: None,
            profile: None,
            pace: None,
            timed: Mutex::default(),
        }
    }

    /// Begins to take the times of kernels, or ends it.
    ///
    /// # Errors
    /// The device has no timestamps.
    pub(crate) fn set_profiling(&mut self, gpu: &Gpu, on: bool) -> Result<(), Error> {
        if on && self.stamps.is_none() {
            self.stamps = Some(Stamps::new(gpu, CAPACITY as u32)?);
        }
        self.profile = on.then(Profile::default);
        Ok(())
    }

    /// Begins to submit in slices.
    pub(crate) fn begin_pace(&mut self, gpu: &Gpu, pace: Arc<Mutex<Pace>>) {
        if self.stamps.is_none() {
            // Without timestamps the end of each slice is seen from the host.
            self.stamps = Stamps::new(gpu, CAPACITY as u32).ok();
        }
        self.pace = Some(pace);
    }

    /// Ends it.
    pub(crate) fn end_pace(&mut self) {
        self.pace = None;
        self.forget();
    }

    /// Forgets the dispatches of a run that was dropped or failed.
    pub(crate) fn forget(&mut self) {
        *self.timed() = Timed::default();
    }

    /// Whether the run goes in slices.
    pub(crate) fn is_paced(&self) -> bool {
        self.pace.is_some()
    }

    /// Sets the parameters of the following submissions.
    pub fn set(&self, gpu: &Gpu, params: &Params) {
        gpu.queue.write_buffer(&self.step, 0, bytemuck::bytes_of(params));
    }

    /// Sets the uniforms of the dispatches of the next submission.
    pub(crate) fn set_dispatches(&self, gpu: &Gpu, words: &[u8]) {
        gpu.queue.write_buffer(&self.dispatches, 0, words);
    }

    /// Bindings 0 and 1 of every kernel.
    pub(crate) fn resources(&self) -> [wgpu::BindingResource<'_>; 2] {
        let dispatch = wgpu::BufferBinding {
            buffer: &self.dispatches,
            offset: 0,
            // As drivers round them.
            size: std::num::NonZeroU64::new((size_of::<Dispatch>() as u64).next_multiple_of(16)),
        };
        [self.step.as_entire_binding(), wgpu::BindingResource::Buffer(dispatch)]
    }

    /// Takes what fits of so many invocations from the slice: all of them if the run does not go in slices.
    pub(crate) fn take(&self, gpu: &Gpu, kernel: &'static str, wanted: u32) -> u32 {
        let Some(mut pace) = self.pace() else { return wanted };
        // In further rows the workgroups of a part could reach into the next one.
        let row = gpu.device.limits().max_compute_workgroups_per_dimension;
        let most = row.saturating_mul(crate::kernel::WORKGROUP_SIZE);
        pace.take(kernel, wanted.min(most))
    }

    /// Notes that so many words are zeroed.
    pub(crate) fn note_clear(&self, words: u64) {
        if let Some(mut pace) = self.pace() {
            pace.take_clear(words);
        }
    }

    /// Notes a dispatch whose time is wanted, and says where to write it.
    pub(crate) fn time(
        &self,
        kernel: &'static str,
        invocations: u32,
    ) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        if self.profile.is_none() && self.pace.is_none() {
            return None;
        }
        let mut timed = self.timed();
        timed.begin.get_or_insert_with(Instant::now);
        timed.dispatches.push((kernel, invocations));
        self.stamps.as_ref().map(|stamps| stamps.writes(timed.dispatches.len() as u32 - 1))
    }

    /// Number of dispatches whose times are not known yet.
    pub(crate) fn timed_dispatches(&self) -> usize {
        self.timed().dispatches.len()
    }

    /// Waits for everything that was submitted, and takes the times of its dispatches where they are wanted. A run in
    /// slices is suspended meanwhile.
    ///
    /// # Errors
    /// The device was lost or took too long.
    pub(crate) async fn settle(&self, gpu: &Gpu) -> Result<(), Error> {
        let Timed { dispatches, begin } = std::mem::take(&mut *self.timed());
        let stamps = self.stamps.as_ref().filter(|_| !dispatches.is_empty());
        let stamps = stamps.map(|stamps| (stamps, stamps.read_back(gpu, dispatches.len())));
        let end =
            if self.is_paced() { done(gpu).await? } else { gpu.wait().map(|()| Instant::now())? };
        let times = match stamps {
            Some((stamps, readback)) => stamps.times(&readback.bytes(gpu)?),
            None => self.shares(&dispatches, begin.map_or(Duration::ZERO, |begin| end - begin)),
        };
        for ((kernel, invocations), time) in dispatches.into_iter().zip(times) {
            self.profile.iter().for_each(|profile| profile.add(kernel, time));
            if let Some(mut pace) = self.pace().filter(|_| invocations > 0) {
                pace.learn(kernel, invocations, time.as_secs_f64());
            }
        }
        Ok(())
    }

    /// The time of a slice shared out to its dispatches, as far as it is known what they take.
    fn shares(&self, dispatches: &[(&'static str, u32)], whole: Duration) -> Vec<Duration> {
        let Some(pace) = self.pace() else { return Vec::new() };
        let expected = |&(kernel, invocations): &_| pace.expected(kernel, invocations);
        let sum: f64 = dispatches.iter().map(expected).sum();
        dispatches.iter().map(|dispatch| whole.mul_f64(expected(dispatch) / sum)).collect()
    }

    /// Reads several ranges (buffer, offset, bytes), one after the other, in one go. All are multiples of 4.
    ///
    /// # Errors
    /// As [`Uniforms::settle`].
    pub(crate) async fn read(
        &self,
        gpu: &Gpu,
        parts: &[(&wgpu::Buffer, u64, u64)],
    ) -> Result<Vec<u8>, Error> {
        if parts.iter().all(|part| part.2 == 0) {
            return Ok(Vec::new());
        }
        let encoder = gpu.device.create_command_encoder(&Default::default());
        let readback = Readback::submit(gpu, encoder, parts);
        self.settle(gpu).await?;
        readback.bytes(gpu)
    }

    fn pace(&self) -> Option<MutexGuard<'_, Pace>> {
        Some(lock(self.pace.as_ref()?))
    }

    fn timed(&self) -> MutexGuard<'_, Timed> {
        lock(&self.timed)
    }
}

/// Nothing is left half done by a panic.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Suspends the run until the device has done what was submitted so far, at least once, and says when that was seen.
async fn done(gpu: &Gpu) -> Result<Instant, Error> {
    let end = Arc::new(OnceLock::new());
    let note = Arc::clone(&end);
    gpu.queue.on_submitted_work_done(move || {
        // It is called once.
        let _ = note.set(Instant::now());
    });
    let mut looks = 0;
    std::future::poll_fn(|_| {
        looks += 1;
        if looks == 1 {
            return Poll::Pending;
        }
        match (gpu.poll(wgpu::PollType::Poll), end.get()) {
            (Err(error), _) => Poll::Ready(Err(error)),
            (Ok(()), Some(end)) => Poll::Ready(Ok(*end)),
            (Ok(()), None) => Poll::Pending,
        }
    })
    .await
}
