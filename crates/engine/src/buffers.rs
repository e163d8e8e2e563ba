//! Device memory that grows and is used again.

use crate::gpu::Mapped;
use crate::windows::{RECORDS, window_bytes};
use crate::{Error, Gpu};
use std::num::NonZeroU64;

/// A labelled storage buffer. It grows on demand and never shrinks.
#[derive(Debug)]
pub struct Buffer {
    label: &'static str,
    raw: wgpu::Buffer,
    /// Bytes that kernels see: all, or those of the last need where all take more than one binding.
    seen: u64,
}

const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE
    .union(wgpu::BufferUsages::COPY_SRC)
    .union(wgpu::BufferUsages::COPY_DST)
    .union(wgpu::BufferUsages::VERTEX)
    .union(wgpu::BufferUsages::INDIRECT);

impl Buffer {
    /// A buffer of at least `bytes`, zeroed.
    ///
    /// # Errors
    /// The adapter does not allow that much in one buffer.
    pub fn new(gpu: &Gpu, label: &'static str, bytes: u64) -> Result<Self, Error> {
        let have = gpu.largest_buffer();
        if bytes > have {
            return Err(Error::Limit { what: label, need: bytes, have, adapter: gpu.name.clone() });
        }
        let size = padded(gpu, bytes);
        let raw = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: STORAGE,
            mapped_at_creation: false,
        });
        Ok(Self { label, raw, seen: size })
    }

    /// A buffer that holds `data`.
    ///
    /// # Errors
    /// As [`Buffer::new`].
    pub fn with_data<T: bytemuck::NoUninit>(
        gpu: &Gpu,
        label: &'static str,
        data: &[T],
    ) -> Result<Self, Error> {
        let buffer = Self::new(gpu, label, size_of_val(data) as u64)?;
        gpu.queue.write_buffer(&buffer.raw, 0, bytemuck::cast_slice(data));
        Ok(buffer)
    }

    /// Bytes that it holds.
    pub fn size(&self) -> u64 {
        self.raw.size()
    }

    /// Bytes that kernels see of it.
    pub(crate) fn seen(&self) -> u64 {
        self.seen
    }

    /// The bindings that a kernel sees it through: one if it is no longer than a binding may be.
    pub(crate) fn windows(&self, gpu: &Gpu) -> Vec<wgpu::BindingResource<'_>> {
        let largest_binding = gpu.largest_binding();
        let window = window_bytes(largest_binding);
        let step = if self.seen <= largest_binding { self.seen } else { window };
        let offsets = (0..self.seen).step_by(step as usize);
        let binding = |offset| wgpu::BufferBinding {
            buffer: &self.raw,
            offset,
            size: NonZeroU64::new(step.min(self.seen - offset)),
        };
        offsets.map(|offset| wgpu::BindingResource::Buffer(binding(offset))).collect()
    }

    /// The buffer itself.
    pub fn raw(&self) -> &wgpu::Buffer {
        &self.raw
    }

    /// Makes room for `bytes`; the old content is lost where it grows.
    pub(crate) fn reserve(&mut self, gpu: &Gpu, bytes: u64) -> Result<(), Error> {
        if bytes > self.size() {
            *self = Self::new(gpu, self.label, with_headroom(bytes, gpu.largest_binding()))?;
        }
        self.see(gpu, bytes);
        Ok(())
    }

    /// Makes room for `bytes` and keeps the first `kept` bytes.
    pub(crate) fn grow(&mut self, gpu: &Gpu, bytes: u64, kept: u64) -> Result<(), Error> {
        if bytes > self.size() {
            let grown = Self::new(gpu, self.label, bytes)?;
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&self.raw, 0, &grown.raw, 0, kept.next_multiple_of(4));
            gpu.queue.submit([encoder.finish()]);
            *self = grown;
        }
        self.see(gpu, bytes);
        Ok(())
    }

    /// Shows kernels so many bytes at least. What an earlier, larger run left behind is no reason for a second binding.
    fn see(&mut self, gpu: &Gpu, bytes: u64) {
        let size = self.size();
        self.seen = if size <= gpu.largest_binding() { size } else { padded(gpu, bytes).min(size) };
    }

    /// Hands the buffer out and leaves an empty one.
    pub(crate) fn take(&mut self, gpu: &Gpu) -> Result<wgpu::Buffer, Error> {
        Ok(std::mem::replace(self, Self::new(gpu, self.label, 0)?).raw)
    }
}

/// The bytes of a buffer, or of what kernels see of it, for so many that are needed.
fn padded(gpu: &Gpu, bytes: u64) -> u64 {
    // Each of several windows holds whole records, so that the last one has at least one.
    let unit = if bytes > gpu.largest_binding() { RECORDS } else { 16 };
    bytes.next_multiple_of(unit).max(64)
}

/// A quarter more than asked for, as far as that fits in one binding: needs grow from level to level.
pub(crate) fn with_headroom(bytes: u64, limit: u64) -> u64 {
    bytes.saturating_add(bytes / 4).min(limit).max(bytes)
}

/// Waits for the first values of a buffer and gives a view of them to a function: large ones are not copied once more.
pub(crate) fn read<T: bytemuck::Pod, R>(
    gpu: &Gpu,
    source: &wgpu::Buffer,
    count: usize,
    take: impl FnOnce(&[T]) -> R,
) -> Result<R, Error> {
    if count == 0 {
        return Ok(take(&[]));
    }
    let encoder = gpu.device.create_command_encoder(&Default::default());
    let readback = Readback::submit(gpu, encoder, &[(source, 0, (count * size_of::<T>()) as u64)]);
    gpu.wait()?;
    let view = readback.mapped.view(gpu, &readback.staging)?;
    // Mapped memory is aligned for all values of words.
    Ok(take(bytemuck::cast_slice(&view)))
}

/// Bytes on their way to the host.
#[derive(Debug)]
pub(crate) struct Readback {
    staging: wgpu::Buffer,
    mapped: Mapped,
}

impl Readback {
    /// Submits the commands so far, and the copy of several ranges (buffer, offset, bytes) that are not all empty, one
    /// after the other. All are multiples of 4.
    pub(crate) fn submit(
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
        parts: &[(&wgpu::Buffer, u64, u64)],
    ) -> Self {
        let staging = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("surfine readback"),
            size: parts.iter().map(|p| p.2).sum(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut at = 0;
        for &(source, offset, bytes) in parts {
            encoder.copy_buffer_to_buffer(source, offset, &staging, at, bytes);
            at += bytes;
        }
        gpu.queue.submit([encoder.finish()]);
        let mapped = Mapped::ask(&staging);
        Self { staging, mapped }
    }

    /// The bytes, once the device has done all of that.
    pub(crate) fn bytes(self, gpu: &Gpu) -> Result<Vec<u8>, Error> {
        Ok(self.mapped.view(gpu, &self.staging)?.to_vec())
    }
}
