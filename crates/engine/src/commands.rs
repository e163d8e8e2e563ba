//! Recording of dispatches.

use crate::buffers::Buffer;
use crate::kernel::{Kernel, WORKGROUP_SIZE};
use crate::profile::Profile;
use crate::records::Params;
use crate::{Error, Gpu};

/// Distance between the uniforms of two dispatches: the largest alignment that adapters ask for.
const STRIDE: u64 = 256;
/// Dispatches of one submission.
const CAPACITY: u64 = 512;

/// The two uniforms of every kernel: that of the step, and one for each dispatch of a submission.
#[derive(Debug)]
pub struct Uniforms {
    step: wgpu::Buffer,
    dispatches: wgpu::Buffer,
    /// The times of the kernels, if they are wanted.
    pub(crate) profile: Option<Profile>,
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
        let step = create("surfine params", size_of::<Params>() as u64);
        let dispatches = create("surfine dispatches", CAPACITY * STRIDE);
        Self { step, dispatches, profile: None }
    }

    /// Begins to take the times of kernels, or ends it.
    ///
    /// # Errors
    /// The device has no timestamps.
    pub(crate) fn set_profiling(&mut self, gpu: &Gpu, on: bool) -> Result<(), Error> {
        self.profile = if on { Some(Profile::new(gpu, CAPACITY as u32)?) } else { None };
        Ok(())
    }

    /// Sets the parameters of the following submissions.
    pub fn set(&self, gpu: &Gpu, params: &Params) {
        gpu.queue.write_buffer(&self.step, 0, bytemuck::bytes_of(params));
    }
}

/// A kernel with its buffers.
#[derive(Debug)]
pub struct Bound<'a> {
    kernel: &'a Kernel,
    group: wgpu::BindGroup,
}

/// Dispatches that are submitted together.
#[derive(Debug)]
pub struct Commands<'a> {
    gpu: &'a Gpu,
    uniforms: &'a Uniforms,
    encoder: wgpu::CommandEncoder,
    /// Uniforms of the dispatches recorded so far, and their kernels.
    recorded: Vec<u8>,
    kernels: Vec<&'static str>,
    /// What went wrong in earlier submissions.
    failure: Option<Error>,
}

impl<'a> Commands<'a> {
    /// Starts recording.
    pub fn new(gpu: &'a Gpu, uniforms: &'a Uniforms) -> Self {
        let encoder = gpu.device.create_command_encoder(&Default::default());
        Self { gpu, uniforms, encoder, recorded: Vec::new(), kernels: Vec::new(), failure: None }
    }

    /// Binds storage buffers to a kernel, in the order of its bindings from 2 on.
    pub fn bind<'k>(&self, kernel: &'k Kernel, buffers: &[&Buffer]) -> Bound<'k> {
        let uniform = wgpu::BufferBinding {
            buffer: &self.uniforms.dispatches,
            offset: 0,
            size: std::num::NonZeroU64::new(16),
        };
        let mut resources =
            vec![self.uniforms.step.as_entire_binding(), wgpu::BindingResource::Buffer(uniform)];
        resources.extend(buffers.iter().map(|b| b.raw().as_entire_binding()));
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let group = self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(kernel.name()),
            layout: kernel.layout(),
            entries: &entries,
        });
        Bound { kernel, group }
    }

    /// Records one dispatch of at least `invocations` invocations; `words` is the kernel's `dispatch` uniform.
    pub fn dispatch(&mut self, bound: &Bound<'_>, words: [u32; 4], invocations: u32) {
        if invocations == 0 {
            return;
        }
        let groups = invocations.div_ceil(WORKGROUP_SIZE);
        let row = groups.min(self.gpu.device.limits().max_compute_workgroups_per_dimension);
        self.record(bound, words, |pass| pass.dispatch_workgroups(row, groups.div_ceil(row), 1));
    }

    /// Records a dispatch of as many workgroups as the first three words of a buffer say when it runs.
    pub fn dispatch_indirect(&mut self, bound: &Bound<'_>, words: [u32; 4], groups: &Buffer) {
        self.record(bound, words, |pass| pass.dispatch_workgroups_indirect(groups.raw(), 0));
    }

    fn record(
        &mut self,
        bound: &Bound<'_>,
        words: [u32; 4],
        dispatch: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        if self.recorded.len() as u64 == CAPACITY * STRIDE {
            self.failure = self.flush().err().or(self.failure.take());
        }
        let offset = self.recorded.len() as u32;
        self.recorded.extend_from_slice(bytemuck::bytes_of(&words));
        self.recorded.resize(offset as usize + STRIDE as usize, 0);
        let mut pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(bound.kernel.name()),
            timestamp_writes: self
                .uniforms
                .profile
                .as_ref()
                .map(|profile| profile.writes(self.kernels.len() as u32)),
        });
        pass.set_pipeline(bound.kernel.pipeline());
        pass.set_bind_group(0, &bound.group, &[offset]);
        dispatch(&mut pass);
        drop(pass);
        self.kernels.push(bound.kernel.name());
    }

    /// Records [`Commands::dispatch`] of a kernel that runs once with these buffers.
    pub fn run(&mut self, kernel: &Kernel, buffers: &[&Buffer], words: [u32; 4], invocations: u32) {
        let bound = self.bind(kernel, buffers);
        self.dispatch(&bound, words, invocations);
    }

    /// Records the zeroing of the first `words` words of a buffer.
    pub fn clear(&mut self, buffer: &Buffer, words: u64) {
        self.clear_range(buffer, 0, words);
    }

    /// Records the zeroing of `words` words from the word `first` on.
    pub fn clear_range(&mut self, buffer: &Buffer, first: u64, words: u64) {
        self.encoder.clear_buffer(buffer.raw(), 4 * first, Some(4 * words));
    }

    /// Submits what was recorded, without waiting unless kernels are timed.
    fn flush(&mut self) -> Result<(), Error> {
        // Written before the submission runs and after the last one: the queue keeps the order.
        self.gpu.queue.write_buffer(&self.uniforms.dispatches, 0, &self.recorded);
        self.recorded.clear();
        let fresh = self.gpu.device.create_command_encoder(&Default::default());
        let mut full = std::mem::replace(&mut self.encoder, fresh);
        let kernels = std::mem::take(&mut self.kernels);
        let profile = self.uniforms.profile.as_ref().filter(|_| !kernels.is_empty());
        if let Some(profile) = profile {
            profile.resolve(&mut full, kernels.len() as u32);
        }
        self.gpu.queue.submit([full.finish()]);
        profile.map_or(Ok(()), |profile| profile.collect(self.gpu, &kernels))
    }

    /// Submits what was recorded and waits for it.
    ///
    /// # Errors
    /// The device was lost or took too long.
    pub fn finish(mut self) -> Result<(), Error> {
        self.flush()?;
        self.failure.map_or_else(|| self.gpu.wait(), Err)
    }
}
