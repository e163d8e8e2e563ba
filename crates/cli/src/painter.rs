//! Who draws pictures.

use crate::adapters::{is_named, is_preferred};
use crate::args::BackendChoice;
use crate::need::bytes;
use crate::summary::counted;
use crate::watch::Watch;
use crate::{Failure, memory};
use surfine::{Gpu, choose_adapter};
use surfine_render::{Camera, DeviceSplats, Error, Picture, Renderer, Size, Splats, Style, cpu};

/// Who draws.
pub(crate) enum Painter {
    Gpu {
        renderer: Box<Renderer>,
        name: String,
        /// The user has left the choice: the CPU draws if this one fails.
        may_fail: bool,
    },
    Cpu,
}

/// Points where the painter wants them.
pub(crate) struct Ready<'a> {
    host: &'a Splats,
    device: Option<DeviceSplats>,
}

impl Painter {
    /// The GPU where the user asks for one or a hardware one is there, else the CPU.
    pub(crate) fn new(
        wanted: BackendChoice,
        adapter: Option<&str>,
        watch: &Watch,
    ) -> Result<Self, Failure> {
        watch.step("preparing".into());
        let wanted = if adapter.is_some() { BackendChoice::Gpu } else { wanted };
        let open = |adapter, may_fail| {
            let gpu = Gpu::open(&adapter)?;
            Ok(Self::Gpu { renderer: Box::new(Renderer::new(&gpu)?), name: gpu.name, may_fail })
        };
        match wanted {
            BackendChoice::Cpu => Ok(Self::Cpu),
            BackendChoice::Gpu => open(choose_adapter(adapter)?, false),
            BackendChoice::Auto => match choose_adapter(None) {
                Ok(adapter) if is_preferred(&adapter.get_info()) => {
                    open(adapter, true).or_else(|Failure(reason)| {
                        warn(watch, &reason);
                        Ok(Self::Cpu)
                    })
                }
                // One that the environment names must be there; what it refuses to draw the CPU draws.
                Err(error) if is_named() => Err(error.into()),
                _ => Ok(Self::Cpu),
            },
        }
    }

    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Gpu { name, .. } => name,
            Self::Cpu => "the CPU",
        }
    }

    /// Refuses so many pictures side by side if they are without pixels, or have too many.
    pub(crate) fn check(
        &mut self,
        count: usize,
        size: Size,
        supersampling: u32,
        watch: &Watch,
    ) -> Result<(), Failure> {
        let checked = self.on_gpu(watch, |renderer| renderer.check(size, supersampling))?;
        checked.map_or_else(|| cpu::check(size, supersampling), Ok)?;
        let need = least_bytes(count, size, supersampling, matches!(self, Self::Cpu));
        match memory::available() {
            Some(available) if need > available => {
                let (pictures, Size { width, height }) =
                    (counted(count, "picture", "pictures"), size);
                let [need, have] = [need, available].map(bytes);
                Err(Failure(format!(
                    "{pictures} of {width} x {height} pixels need {need} of memory at least, {have} are available: \
                     take fewer or smaller ones"
                )))
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn upload<'a>(
        &mut self,
        splats: &'a Splats,
        watch: &Watch,
    ) -> Result<Ready<'a>, Failure> {
        let device = self.on_gpu(watch, |renderer| renderer.upload(splats))?;
        Ok(Ready { host: splats, device })
    }

    pub(crate) fn draw(
        &mut self,
        splats: &Ready<'_>,
        camera: &Camera,
        style: &Style,
        size: Size,
        watch: &Watch,
    ) -> Result<Picture, Failure> {
        let picture = match &splats.device {
            Some(device) => self.on_gpu(watch, |r| r.draw(device, camera, style, size))?,
            None => None,
        };
        Ok(picture.map_or_else(|| cpu::draw(splats.host, camera, style, size), Ok)?)
    }

    /// What the GPU makes; nothing if the CPU is to do it.
    fn on_gpu<T>(
        &mut self,
        watch: &Watch,
        work: impl FnOnce(&Renderer) -> Result<T, Error>,
    ) -> Result<Option<T>, Failure> {
        let Self::Gpu { renderer, may_fail, .. } = self else { return Ok(None) };
        match work(renderer) {
            Ok(made) => Ok(Some(made)),
            Err(error) if *may_fail => {
                warn(watch, &error.to_string());
                *self = Self::Cpu;
                Ok(None)
            }
            Err(error) => Err(error.into()),
        }
    }
}

/// Memory that so many pictures side by side surely take.
fn least_bytes(count: usize, size: Size, supersampling: u32, on_cpu: bool) -> u64 {
    let pixels = 4 * u64::from(size.width) * u64::from(size.height);
    let all = pixels * count as u64;
    // The CPU has a depth for each subpixel of the picture that it draws.
    let depths = if on_cpu { pixels * u64::from(supersampling.pow(2)) } else { 0 };
    // At the end all are copied into one.
    (all + depths).max(2 * all)
}

fn warn(watch: &Watch, reason: &str) {
    watch.warn(&format!("drawing on the CPU: the GPU failed: {reason}"));
}
