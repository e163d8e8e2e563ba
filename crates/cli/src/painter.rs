//! Who draws pictures.

use crate::args::BackendChoice;
use crate::watch::Watch;
use crate::{Failure, backend};
use surfine::{Gpu, choose_adapter};
use surfine_render::{Camera, DeviceSplats, Picture, Renderer, Size, Splats, Style, cpu};

/// Who draws.
pub(crate) enum Painter {
    Gpu(Box<Renderer>, String),
    Cpu,
}

/// Points where the painter wants them.
pub(crate) enum Ready<'a> {
    Device(DeviceSplats),
    Host(&'a Splats),
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
        let open = |adapter| {
            let gpu = Gpu::open(&adapter)?;
            Ok(Self::Gpu(Box::new(Renderer::new(&gpu)?), gpu.name))
        };
        match wanted {
            BackendChoice::Cpu => Ok(Self::Cpu),
            BackendChoice::Gpu => open(choose_adapter(adapter)?),
            BackendChoice::Auto => match choose_adapter(None) {
                Ok(adapter) if backend::is_preferred(&adapter) => {
                    open(adapter).or_else(|Failure(reason)| {
                        watch.warn(&format!("drawing on the CPU: the GPU failed: {reason}"));
                        Ok(Self::Cpu)
                    })
                }
                _ => Ok(Self::Cpu),
            },
        }
    }

    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Gpu(_, name) => name,
            Self::Cpu => "the CPU",
        }
    }

    pub(crate) fn upload<'a>(&self, splats: &'a Splats) -> Result<Ready<'a>, Failure> {
        Ok(match self {
            Self::Gpu(renderer, _) => Ready::Device(renderer.upload(splats)?),
            Self::Cpu => Ready::Host(splats),
        })
    }

    pub(crate) fn draw(
        &self,
        splats: &Ready<'_>,
        camera: &Camera,
        style: &Style,
        size: Size,
    ) -> Result<Picture, Failure> {
        Ok(match (self, splats) {
            (Self::Gpu(renderer, _), Ready::Device(splats)) => {
                renderer.draw(splats, camera, style, size)?
            }
            (_, Ready::Host(splats)) => cpu::draw(splats, camera, style, size)?,
            (Self::Cpu, Ready::Device(_)) => unreachable!("the CPU uploads nothing"),
        })
    }
}
