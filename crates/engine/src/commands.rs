//! Recording of dispatches.

use crate::buffers::Buffer;
use crate::kernel::{Kernel, WORKGROUP_SIZE};
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
        Self { step, dispatches: create("surfine dispatches", CAPACITY * STRIDE) }
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
    /// Uniforms of the dispatches recorded so far.
    recorded: Vec<u8>,
}

impl<'a> Commands<'a> {
    /// Starts recording.
    pub fn new(gpu: &'a Gpu, uniforms: &'a Uniforms) -> Self {
        let encoder = gpu.device.create_command_encoder(&Default::default());
        Self { gpu, uniforms, encoder, recorded: Vec::new() }
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
        if self.recorded.len() as u64 == CAPACITY * STRIDE {
            self.flush();
        }
        let offset = self.recorded.len() as u32;
        self.recorded.extend_from_slice(bytemuck::bytes_of(&words));
        self.recorded.resize(offset as usize + STRIDE as usize, 0);
        let groups = invocations.div_ceil(WORKGROUP_SIZE);
        let row = groups.min(self.gpu.device.limits().max_compute_workgroups_per_dimension);
        let mut pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(bound.kernel.name()),
            timestamp_writes: None,
        });
        pass.set_pipeline(bound.kernel.pipeline());
        pass.set_bind_group(0, &bound.group, &[offset]);
        pass.dispatch_workgroups(row, groups.div_ceil(row), 1);
    }

    /// Records [`Commands::dispatch`] of a kernel that runs once with these buffers.
    pub fn run(&mut self, kernel: &Kernel, buffers: &[&Buffer], words: [u32; 4], invocations: u32) {
        let bound = self.bind(kernel, buffers);
        self.dispatch(&bound, words, invocations);
    }

    /// Records the zeroing of the first `words` words of a buffer.
    pub fn clear(&mut self, buffer: &Buffer, words: u64) {
        self.encoder.clear_buffer(buffer.raw(), 0, Some(4 * words));
    }

    /// Submits what was recorded, without waiting.
    pub fn flush(&mut self) {
        // Written before the submission runs and after the last one: the queue keeps the order.
        self.gpu.queue.write_buffer(&self.uniforms.dispatches, 0, &self.recorded);
        self.recorded.clear();
        let fresh = self.gpu.device.create_command_encoder(&Default::default());
        let full = std::mem::replace(&mut self.encoder, fresh);
        self.gpu.queue.submit([full.finish()]);
    }

    /// Submits what was recorded and waits for it.
    ///
    /// # Errors
    /// The device was lost or took too long.
    pub fn finish(mut self) -> Result<(), Error> {
        self.flush();
        self.gpu.wait()
    }
}
