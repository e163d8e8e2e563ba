//! Adapters and devices.

use crate::Error;
use crate::windows::RECORDS;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// How long the host waits for the device before it gives up: a hang must not be for ever.
const TIMEOUT: Duration = Duration::from_secs(600);

/// How the text of wgpu's panics begins where the device was lost.
pub const LOST: &str = "Error in Device::poll";

/// The most storage buffers that a kernel has.
const KERNEL_BUFFERS: u32 = 10;
/// All buffers of a kernel together are no longer than so many times the largest of them, on even clouds: 2.5 times by
/// default, 3.1 times by the paper's loop.
const BUFFERS_AT_ONCE: u64 = 4;

/// How kernels were compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// SPIR-V in which no operation may be contracted or reassociated: the bytes of the CPU reference on every driver
    /// that rounds division and square root correctly, as software drivers do. Vulkan does not ask it of hardware.
    Exact,
    /// Plain WGSL: the driver may reassociate, so results can differ from the reference in rounding.
    Plain,
}

impl Mode {
    /// Lower-case name, for messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Plain => "plain",
        }
    }
}

/// A device with what the kernels need to know of it.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// How kernels are compiled for it.
    pub mode: Mode,
    /// Name of the adapter.
    pub name: String,
}

/// The adapters of this machine, hardware first.
pub fn adapters() -> Vec<wgpu::Adapter> {
    let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    let instance = wgpu::Instance::new(descriptor);
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
    adapters.sort_by_key(|a| rank(a.get_info().device_type));
    adapters
}

fn rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// The adapter whose name or driver holds `wanted`, in any case; without a wish that of `WGPU_ADAPTER_NAME`, else the
/// first of [`adapters`].
///
/// # Errors
/// There is none, or none of that name.
pub fn choose_adapter(wanted: Option<&str>) -> Result<wgpu::Adapter, Error> {
    let from_env = std::env::var("WGPU_ADAPTER_NAME").ok().filter(|name| !name.is_empty());
    let wanted = wanted.map(str::to_owned).or(from_env);
    let mut adapters = adapters();
    if adapters.is_empty() {
        return Err(Error::NoAdapter);
    }
    let Some(wanted) = wanted else { return Ok(adapters.remove(0)) };
    let matches = |a: &wgpu::Adapter| {
        let info = a.get_info();
        let text = format!("{} {} {}", info.name, info.driver, info.driver_info).to_lowercase();
        text.contains(&wanted.to_lowercase())
    };
    match adapters.iter().position(matches) {
        Some(i) => Ok(adapters.remove(i)),
        None => {
            let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
            Err(Error::NoSuchAdapter { wanted, present: names.join(", ") })
        }
    }
}

impl Gpu {
    /// Opens an adapter with the features and limits that the kernels can use.
    ///
    /// # Errors
    /// The driver refuses.
    pub fn open(adapter: &wgpu::Adapter) -> Result<Self, Error> {
        let wanted = wgpu::Features::PASSTHROUGH_SHADERS | wgpu::Features::TIMESTAMP_QUERY;
        let features = adapter.features() & wanted;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("surfine"),
            required_features: features,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let name = adapter.get_info().name;
        let opened = pollster::block_on(adapter.request_device(&descriptor));
        let (device, queue) =
            opened.map_err(|e| Error::Device { adapter: name, message: e.to_string() })?;
        Ok(Self::from_device(device, queue))
    }

    /// Takes the caller's device. Kernels are exact if it was opened with `Features::PASSTHROUGH_SHADERS` on Vulkan.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let info = device.adapter_info();
        let exact = info.backend == wgpu::Backend::Vulkan
            && device.features().contains(wgpu::Features::PASSTHROUGH_SHADERS);
        let mode = if exact { Mode::Exact } else { Mode::Plain };
        Self { device, queue, mode, name: info.name }
    }

    /// The largest buffer that a kernel can use through one binding, bytes.
    pub fn largest_binding(&self) -> u64 {
        let limits = self.device.limits();
        // wgpu itself allows no more on Vulkan and Direct3D. On Metal it does, but its checks of indices count bytes in
        // 32 bits.
        let most = limits.max_storage_buffer_binding_size.min(i32::MAX as u64);
        // Buffers are rounded up to 16 bytes, and drivers' limits need not be multiples of that.
        most.min(limits.max_buffer_size) & !15
    }

    /// The largest buffer of a refinement, bytes: longer ones than a binding have several, as far as a stage may have
    /// so many.
    pub fn largest_buffer(&self) -> u64 {
        let limits = self.device.limits();
        let spare = limits.max_storage_buffers_per_shader_stage.saturating_sub(KERNEL_BUFFERS);
        let most = limits.max_buffer_size / RECORDS * RECORDS;
        let binding = self.largest_binding();
        let further = (binding / BUFFERS_AT_ONCE).saturating_mul(spare.into());
        most.min(binding.saturating_add(further))
    }

    /// Runs `work` and returns the device's own complaint, if there was one, rather than what followed from it.
    ///
    /// # Errors
    /// What the device or `work` complains of.
    pub fn guarded<T>(&self, work: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let result = work();
        let mut complaint = None;
        for scope in [internal, validation, memory] {
            complaint = pollster::block_on(scope.pop()).or(complaint);
        }
        match complaint {
            Some(e) => Err(self.error(&e)),
            None => result,
        }
    }

    /// Waits for what was submitted and gives the host a view of a buffer of usage `MAP_READ`.
    ///
    /// # Errors
    /// The device was lost or took too long.
    pub fn map(&self, buffer: &wgpu::Buffer) -> Result<wgpu::BufferView, Error> {
        let mapped = Mapped::ask(buffer);
        self.wait()?;
        mapped.view(self, buffer)
    }

    /// Waits for everything that was submitted.
    ///
    /// # Errors
    /// The device was lost or took too long.
    pub fn wait(&self) -> Result<(), Error> {
        self.poll(wgpu::PollType::Wait { submission_index: None, timeout: Some(TIMEOUT) })
    }

    /// Lets the device's callbacks run.
    pub(crate) fn poll(&self, how: wgpu::PollType) -> Result<(), Error> {
        // wgpu panics where the device was lost. Callbacks of the application run here too: their panics are its own.
        match catch_unwind(AssertUnwindSafe(|| self.device.poll(how))) {
            Ok(polled) => polled.map(|_| ()).map_err(|e| self.error(&e)),
            Err(panic) => match panic.downcast_ref::<String>() {
                Some(text) if text.starts_with(LOST) => Err(self.error(text)),
                _ => resume_unwind(panic),
            },
        }
    }

    pub(crate) fn error(&self, message: &impl ToString) -> Error {
        // Drivers write long texts: keep to one line.
        let message = message.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        Error::Device { adapter: self.name.clone(), message }
    }
}

/// The device's word that the host may see a buffer.
#[derive(Debug)]
pub(crate) struct Mapped(Receiver<Result<(), wgpu::BufferAsyncError>>);

impl Mapped {
    /// Asks for a view of a buffer of usage `MAP_READ`.
    pub(crate) fn ask(buffer: &wgpu::Buffer) -> Self {
        let (sender, receiver) = channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver is gone only if nobody wants the view any more.
            let _ = sender.send(result);
        });
        Self(receiver)
    }

    /// The view, once the device has done what was submitted before the question.
    pub(crate) fn view(self, gpu: &Gpu, buffer: &wgpu::Buffer) -> Result<wgpu::BufferView, Error> {
        self.0.recv().map_err(|e| gpu.error(&e))?.map_err(|e| gpu.error(&e))?;
        buffer.get_mapped_range(..).map_err(|e| gpu.error(&e))
    }
}
