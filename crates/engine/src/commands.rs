//! Recording of dispatches.
//!
//! The functions that may submit are `async`, but nothing is suspended unless the run goes in slices (see `slices.rs`):
//! then a dispatch that does not fit in the slice is cut, and what is left of it waits for the next one. Parts of a
//! dispatch follow each other as dispatches do, so results are the same however they are cut.

use crate::buffers::Buffer;
use crate::kernel::{Kernel, WORKGROUP_SIZE};
use crate::records::Dispatch;
use crate::uniforms::{CAPACITY, STRIDE, Uniforms};
use crate::{Error, Gpu};

/// A kernel with its buffers.
#[derive(Debug)]
pub struct Bound {
    name: &'static str,
    /// None after a failure.
    ready: Option<(wgpu::ComputePipeline, wgpu::BindGroup)>,
}

/// Dispatches that are submitted together.
#[derive(Debug)]
pub struct Commands<'a> {
    gpu: &'a Gpu,
    uniforms: &'a Uniforms,
    encoder: wgpu::CommandEncoder,
    /// Uniforms of the dispatches recorded so far.
    recorded: Vec<u8>,
    /// What went wrong in earlier submissions.
    failure: Option<Error>,
}

impl<'a> Commands<'a> {
    /// Starts recording.
    pub fn new(gpu: &'a Gpu, uniforms: &'a Uniforms) -> Self {
        let encoder = gpu.device.create_command_encoder(&Default::default());
        Self { gpu, uniforms, encoder, recorded: Vec::new(), failure: None }
    }

    /// Binds storage buffers to a kernel, in the order of its bindings from 2 on.
    pub fn bind(&mut self, kernel: &Kernel, buffers: &[&Buffer]) -> Bound {
        let windows: Vec<_> = buffers.iter().map(|b| b.windows(self.gpu)).collect();
        let counts: Vec<_> = windows.iter().map(|w| w.len() as u32).collect();
        let ready = kernel.with_windows(self.gpu, &counts).map(|compiled| {
            // The windows after the first follow the other bindings.
            let further = windows.iter().flat_map(|w| &w[1..]);
            let resources = windows.iter().map(|w| &w[0]).chain(further).cloned();
            let entries: Vec<_> = (0..)
                .zip(self.uniforms.resources().into_iter().chain(resources))
                .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
                .collect();
            let group = self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(kernel.name()),
                layout: &compiled.layout,
                entries: &entries,
            });
            (compiled.pipeline, group)
        });
        match ready {
            Ok(ready) => Bound { name: kernel.name(), ready: Some(ready) },
            Err(error) => {
                self.failure.get_or_insert(error);
                Bound { name: kernel.name(), ready: None }
            }
        }
    }

    /// Records one dispatch of at least `invocations` invocations; `words` is what the kernel says of its `dispatch`
    /// uniform.
    pub async fn dispatch(&mut self, bound: &Bound, words: [u32; 4], invocations: u32) {
        let mut first = 0;
        while first < invocations && self.failure.is_none() {
            let count = self.fitting(bound, invocations - first).await;
            let groups = count.div_ceil(WORKGROUP_SIZE);
            let row = groups.min(self.gpu.device.limits().max_compute_workgroups_per_dimension);
            self.record(bound, (words, first), count, |pass| {
                pass.dispatch_workgroups(row, groups.div_ceil(row), 1);
            });
            first += count;
        }
    }

    /// Records a dispatch of as many workgroups as the first three words of a buffer say when it runs, for about so
    /// many invocations, or few if none are said. It is not cut, but waits for the next slice if these don't fit.
    pub async fn dispatch_indirect(
        &mut self,
        bound: &Bound,
        words: [u32; 4],
        groups: &Buffer,
        about: u32,
    ) {
        self.make_room().await;
        if self.uniforms.take(self.gpu, bound.name, about) < about {
            self.flush();
            self.settle().await;
            self.uniforms.take(self.gpu, bound.name, about);
        }
        self.record(bound, (words, 0), about, |pass| {
            pass.dispatch_workgroups_indirect(groups.raw(), 0);
        });
    }

    /// How many of so many invocations the slice has room for; it is ended if there is none.
    async fn fitting(&mut self, bound: &Bound, invocations: u32) -> u32 {
        loop {
            self.make_room().await;
            let count = self.uniforms.take(self.gpu, bound.name, invocations);
            // Where nothing can run any more, nothing fits.
            if count > 0 || self.failure.is_some() {
                return count;
            }
            self.flush();
            self.settle().await;
        }
    }

    /// Submits what was recorded if there is no room for a further dispatch.
    async fn make_room(&mut self) {
        if self.recorded.len() as u64 == CAPACITY * STRIDE {
            self.flush();
        }
        if self.uniforms.timed_dispatches() as u64 == CAPACITY {
            self.flush();
            self.settle().await;
        }
    }

    fn record(
        &mut self,
        bound: &Bound,
        ([x, y, z, w], first): ([u32; 4], u32),
        invocations: u32,
        dispatch: impl FnOnce(&mut wgpu::ComputePass<'_>),
    ) {
        // What follows a failure would read what was not written.
        if self.failure.is_some() {
            return;
        }
        let Some((pipeline, group)) = &bound.ready else { return };
        let offset = self.recorded.len() as u32;
        self.recorded.extend_from_slice(bytemuck::bytes_of(&Dispatch { x, y, z, w, first }));
        self.recorded.resize(offset as usize + STRIDE as usize, 0);
        let mut pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(bound.name),
            timestamp_writes: self.uniforms.time(bound.name, invocations),
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[offset]);
        dispatch(&mut pass);
    }

    /// Records [`Commands::dispatch`] of a kernel that runs once with these buffers.
    pub async fn run(
        &mut self,
        kernel: &Kernel,
        buffers: &[&Buffer],
        words: [u32; 4],
        invocations: u32,
    ) {
        let bound = self.bind(kernel, buffers);
        self.dispatch(&bound, words, invocations).await;
    }

    /// Records the zeroing of the first `words` words of a buffer.
    pub fn clear(&mut self, buffer: &Buffer, words: u64) {
        self.clear_range(buffer, 0, words);
    }

    /// Records the zeroing of `words` words from the word `first` on.
    pub fn clear_range(&mut self, buffer: &Buffer, first: u64, words: u64) {
        self.encoder.clear_buffer(buffer.raw(), 4 * first, Some(4 * words));
        self.uniforms.note_clear(words);
    }

    /// Submits what was recorded, without waiting.
    fn flush(&mut self) {
        // Written before the submission runs and after the last one: the queue keeps the order.
        self.uniforms.set_dispatches(self.gpu, &self.recorded);
        self.recorded.clear();
        let fresh = self.gpu.device.create_command_encoder(&Default::default());
        let full = std::mem::replace(&mut self.encoder, fresh);
        self.gpu.queue.submit([full.finish()]);
    }

    async fn settle(&mut self) {
        let settled = self.uniforms.settle(self.gpu).await;
        self.failure = self.failure.take().or(settled.err());
    }

    /// Submits what was recorded and waits for it; in slices it is left to run.
    ///
    /// # Errors
    /// The device was lost or took too long.
    pub async fn finish(mut self) -> Result<(), Error> {
        self.flush();
        if !self.uniforms.is_paced() {
            self.settle().await;
        }
        self.failure.map_or(Ok(()), Err)
    }
}
