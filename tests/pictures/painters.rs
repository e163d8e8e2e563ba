//! Both ways to a picture, and the device that the tests share.

use crate::scenes::Scene;
use std::sync::{Mutex, MutexGuard, OnceLock};
use surfine::{Gpu, choose_adapter};
use surfine_render::{Error, Picture, Renderer, cpu};

/// Who draws.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Painter {
    Cpu,
    Gpu,
}

impl Painter {
    pub(crate) const BOTH: [Self; 2] = [Self::Cpu, Self::Gpu];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }

    pub(crate) fn try_draw(self, scene: &Scene) -> Result<Picture, Error> {
        let Scene { splats, camera, style, size } = scene;
        match self {
            Self::Cpu => cpu::draw(splats, camera, style, *size),
            Self::Gpu => {
                let renderer = &device().renderer;
                renderer.draw(&renderer.upload(splats)?, camera, style, *size)
            }
        }
    }

    #[track_caller]
    pub(crate) fn draw(self, scene: &Scene) -> Picture {
        let picture = self.try_draw(scene).unwrap_or_else(|e| panic!("{}: {e}", self.name()));
        assert_eq!(picture.size, scene.size);
        assert_eq!(picture.pixels.len(), (scene.size.width * scene.size.height) as usize);
        picture
    }
}

/// The device with its compiled passes.
pub(crate) struct Device {
    pub gpu: Gpu,
    pub renderer: Renderer,
}

/// The shared device. Tests take turns on it: software drivers use all cores anyway.
pub(crate) fn device() -> MutexGuard<'static, Device> {
    static DEVICE: OnceLock<Mutex<Device>> = OnceLock::new();
    let open = || {
        let gpu = choose_adapter(None)
            .and_then(|adapter| Gpu::open(&adapter))
            .unwrap_or_else(|e| panic!("pictures need a GPU adapter: {e}"));
        println!("{}", gpu.name);
        let renderer = Renderer::new(&gpu).unwrap_or_else(|e| panic!("{e}"));
        Mutex::new(Device { gpu, renderer })
    };
    // A test that failed with the device in hand has left it usable.
    DEVICE.get_or_init(open).lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}
