//! `surfine adapters`.

use crate::args::AdaptersArgs;
use crate::{Failure, print, print_json};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use surfine::wgpu::{self, AdapterInfo, DeviceType};
use surfine::{Mode, adapters, choose_adapter};

/// What the program says about an adapter.
#[derive(Serialize)]
pub(crate) struct Description {
    name: String,
    /// `hardware` or `software`.
    r#type: &'static str,
    /// What kind of device it is, finer than the type.
    kind: &'static str,
    backend: String,
    driver: String,
    /// `exact` or `plain`.
    mode: &'static str,
}

#[derive(Serialize)]
struct Entry {
    #[serde(flatten)]
    adapter: Description,
    /// Whether `--backend gpu` takes it.
    chosen: bool,
}

#[derive(Serialize)]
struct List {
    adapters: Vec<Entry>,
    /// What `--backend auto` takes: `gpu` or `cpu`.
    auto_backend: &'static str,
}

pub(crate) fn run(args: &AdaptersArgs) -> Result<(), Failure> {
    let chosen = choose_adapter(None)?.get_info();
    let list = List {
        auto_backend: if is_preferred(&chosen) { "gpu" } else { "cpu" },
        adapters: entries(&adapters(), &chosen),
    };
    if args.json {
        return print_json(&list);
    }
    print(&text(&list))
}

pub(crate) fn is_software(info: &AdapterInfo) -> bool {
    info.device_type == DeviceType::Cpu
}

/// Whether an adapter is taken where the user leaves the choice: a hardware one, or one that `WGPU_ADAPTER_NAME` names.
pub(crate) fn is_preferred(info: &AdapterInfo) -> bool {
    is_named() || !is_software(info)
}

/// Whether `WGPU_ADAPTER_NAME` names an adapter.
pub(crate) fn is_named() -> bool {
    std::env::var("WGPU_ADAPTER_NAME").is_ok_and(|name| !name.is_empty())
}

/// Whether a device of that kind has its buffers in the memory of the host.
pub(crate) fn shares_memory(kind: DeviceType) -> bool {
    matches!(kind, DeviceType::Cpu | DeviceType::IntegratedGpu)
}

fn entries(adapters: &[wgpu::Adapter], chosen: &AdapterInfo) -> Vec<Entry> {
    // Equal adapters can't be told apart: the first of them is the chosen one.
    let position = adapters.iter().position(|a| a.get_info() == *chosen);
    let entry =
        |(i, adapter)| Entry { adapter: Description::new(adapter), chosen: Some(i) == position };
    adapters.iter().enumerate().map(entry).collect()
}

impl Description {
    pub(crate) fn new(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self {
            r#type: if is_software(&info) { "software" } else { "hardware" },
            kind: kind(info.device_type),
            mode: mode(adapter, &info).name(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().into(),
            backend: info.backend.to_string(),
            name: info.name,
        }
    }

    /// Whether results must be those of the CPU backend: software drivers round as the kernels ask for.
    pub(crate) fn gives_cpu_bytes(&self) -> bool {
        self.mode == Mode::Exact.name() && self.r#type == "software"
    }
}

impl Display for Description {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { name, r#type, kind, backend, driver, mode } = self;
        write!(f, "{name}: {type} ({kind}), {backend}, {driver}, mode {mode}")
    }
}

fn kind(kind: DeviceType) -> &'static str {
    match kind {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Cpu => "cpu",
        DeviceType::Other => "other",
    }
}

/// The mode that [`surfine::Gpu::open`] will find.
fn mode(adapter: &wgpu::Adapter, info: &AdapterInfo) -> Mode {
    let passthrough = adapter.features().contains(wgpu::Features::PASSTHROUGH_SHADERS);
    if info.backend == wgpu::Backend::Vulkan && passthrough { Mode::Exact } else { Mode::Plain }
}

fn text(list: &List) -> String {
    let mut text = String::new();
    for entry in &list.adapters {
        let mark = if entry.chosen { '*' } else { ' ' };
        text += &format!("{mark} {}\n", entry.adapter);
    }
    text += match list.auto_backend {
        "gpu" => "* is taken by `refine`, unless --backend or --adapter say otherwise\n",
        _ => "* is taken by --backend gpu; without it `refine` takes the CPU, which is faster\n",
    };
    text
}
