//! One compute kernel: from WGSL to a pipeline, with its layout read from the text.

use crate::shaders::Shader;
use crate::uniforms::lock;
use crate::windows::{split, window_bytes};
use crate::{Error, Gpu, Mode};
use std::borrow::Cow;
use std::sync::Mutex;

/// Invocations of a workgroup; `linear_index` in the shaders counts on it.
pub const WORKGROUP_SIZE: u32 = 64;

/// A kernel that is ready to run.
#[derive(Debug)]
pub struct Kernel {
    shader: Shader,
    constants: Vec<(&'static str, f64)>,
    /// For buffers that one binding each holds.
    whole: Compiled,
    /// For longer buffers, by the number of windows of each binding from 2 on; compiled when they are met.
    windowed: Mutex<Vec<(Vec<u32>, Compiled)>>,
}

/// A pipeline with the layout of its bindings.
#[derive(Clone, Debug)]
pub(crate) struct Compiled {
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layout: wgpu::BindGroupLayout,
}

impl Kernel {
    /// Compiles a kernel for a device, in the device's mode. `constants` are values of its `override`s; those that it
    /// does not declare are left out.
    ///
    /// # Errors
    /// The text is no valid WGSL, or the driver refuses it.
    pub fn new(
        gpu: &Gpu,
        shader: &Shader,
        constants: &[(&'static str, f64)],
    ) -> Result<Self, Error> {
        let whole = compile(gpu, shader, constants, &[])?;
        let (constants, windowed) = (constants.to_vec(), Mutex::default());
        Ok(Self { shader: *shader, constants, whole, windowed })
    }

    /// Name of the kernel.
    pub fn name(&self) -> &'static str {
        self.shader.name
    }

    /// The kernel for buffers with so many windows.
    ///
    /// # Errors
    /// As [`Kernel::new`], or a stage may not have so many storage buffers.
    pub(crate) fn with_windows(&self, gpu: &Gpu, windows: &[u32]) -> Result<Compiled, Error> {
        if windows.iter().all(|count| *count == 1) {
            return Ok(self.whole.clone());
        }
        let mut compiled = lock(&self.windowed);
        if let Some((_, found)) = compiled.iter().find(|(counts, _)| counts == windows) {
            return Ok(found.clone());
        }
        let (need, have) =
            (windows.iter().sum(), gpu.device.limits().max_storage_buffers_per_shader_stage);
        if need > have {
            let (kernel, adapter) = (self.name(), gpu.name.clone());
            return Err(Error::Bindings { kernel, need, have, adapter });
        }
        let new = compile(gpu, &self.shader, &self.constants, windows)?;
        compiled.push((windows.to_vec(), new.clone()));
        Ok(new)
    }
}

fn compile(
    gpu: &Gpu,
    shader: &Shader,
    constants: &[(&str, f64)],
    windows: &[u32],
) -> Result<Compiled, Error> {
    let failed = |message: String| Error::Kernel { name: shader.name, message };
    let source = shader.source();
    let mut module = naga::front::wgsl::parse_str(&source)
        .map_err(|e| failed(e.emit_to_string_with_path(&source, shader.name)))?;
    if !windows.is_empty() {
        split(&mut module, windows, window_bytes(gpu.largest_binding())).map_err(failed)?;
    }
    let constants = declared(&module, constants);
    gpu.guarded(|| {
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(shader.name),
            entries: &layout_entries(&module),
        });
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(shader.name),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let compiled = match gpu.mode {
            Mode::Exact => exact_module(gpu, shader, &module, &constants).map_err(failed)?,
            Mode::Plain => gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
            }),
        };
        let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(shader.name),
            layout: Some(&pipeline_layout),
            module: &compiled,
            entry_point: Some(shader.entry),
            compilation_options: wgpu::PipelineCompilationOptions {
                // The exact text has them built in.
                constants: if gpu.mode == Mode::Exact { &[] } else { &constants },
                ..Default::default()
            },
            cache: None,
        });
        Ok(Compiled { pipeline, layout })
    })
}

/// The constants that the module declares as `override`s.
fn declared<'a>(module: &naga::Module, constants: &[(&'a str, f64)]) -> Vec<(&'a str, f64)> {
    let names: Vec<_> = module.overrides.iter().filter_map(|(_, o)| o.name.as_deref()).collect();
    constants.iter().filter(|(name, _)| names.contains(name)).copied().collect()
}

/// The bindings of group 0 as the text declares them. Binding 1 is the uniform that changes from dispatch to dispatch.
fn layout_entries(module: &naga::Module) -> Vec<wgpu::BindGroupLayoutEntry> {
    let bound =
        module.global_variables.iter().filter_map(|(_, v)| Some((v.binding?.binding, v.space)));
    let mut entries: Vec<_> = bound
        .map(|(binding, space)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer {
                ty: match space {
                    naga::AddressSpace::Storage { access } => wgpu::BufferBindingType::Storage {
                        read_only: !access.contains(naga::StorageAccess::STORE),
                    },
                    _ => wgpu::BufferBindingType::Uniform,
                },
                has_dynamic_offset: binding == 1,
                min_binding_size: None,
            },
            count: None,
        })
        .collect();
    entries.sort_by_key(|e| e.binding);
    entries
}

/// SPIR-V in which every float operation is marked `NoContraction`: without the mark drivers reassociate.
fn exact_module(
    gpu: &Gpu,
    shader: &Shader,
    module: &naga::Module,
    constants: &[(&str, f64)],
) -> Result<wgpu::ShaderModule, String> {
    let words = exact_spirv(shader.entry, module, constants)?;
    let entry_point = wgpu::PassthroughShaderEntryPoint {
        name: shader.entry.into(),
        workgroup_size: (WORKGROUP_SIZE, 1, 1),
    };
    // SAFETY: the words come from naga's writer, of a module that its validator accepted, with bounds checks on;
    // decorations change rounding only.
    Ok(unsafe {
        gpu.device.create_shader_module_passthrough(wgpu::ShaderModuleDescriptorPassthrough {
            label: Some(shader.name),
            spirv: Some(words.into()),
            entry_points: vec![entry_point].into(),
            ..Default::default()
        })
    })
}

/// Translates a module, with the values of its `override`s built in, and decorates its float operations.
///
/// # Errors
/// The module is not valid.
pub fn exact_spirv(
    name: &str,
    module: &naga::Module,
    constants: &[(&str, f64)],
) -> Result<Vec<u32>, String> {
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .map_err(|e| e.into_inner().to_string())?;
    let values = constants.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
    let entry = (naga::ShaderStage::Compute, name);
    let (module, info) =
        naga::back::pipeline_constants::process_overrides(module, &info, Some(entry), &values)
            .map_err(|e| e.to_string())?;
    let checked = naga::proc::BoundsCheckPolicy::Restrict;
    let options = naga::back::spv::Options {
        lang_version: (1, 3),
        bounds_check_policies: naga::proc::BoundsCheckPolicies {
            index: checked,
            buffer: checked,
            ..Default::default()
        },
        force_loop_bounding: false,
        ..Default::default()
    };
    let pipeline = naga::back::spv::PipelineOptions {
        shader_stage: naga::ShaderStage::Compute,
        entry_point: name.into(),
    };
    let words = naga::back::spv::write_vec(&module, &info, &options, Some(&pipeline));
    Ok(forbid_contraction(&words.map_err(|e| e.to_string())?))
}

/// Words of the SPIR-V header.
const HEADER: usize = 5;

/// Puts `OpDecorate id NoContraction` for every float operation before the first type, and leaves private variables
/// without their zeros: kernels write before they read, and software drivers take seconds to compile the zeros of a
/// row.
fn forbid_contraction(words: &[u32]) -> Vec<u32> {
    const OP_DECORATE: u32 = 71;
    const NO_CONTRACTION: u32 = 42;
    const OP_VARIABLE: u32 = 59;
    const PRIVATE: u32 = 6;
    let (mut head, mut decorations, mut body) = (words[..HEADER].to_vec(), Vec::new(), Vec::new());
    let mut at = HEADER;
    while at < words.len() {
        let (opcode, length) = (words[at] & 0xffff, (words[at] >> 16) as usize);
        let instruction = &words[at..at + length.max(1)];
        // OpExtInst, OpFNegate, OpFAdd, OpFSub, OpFMul, OpFDiv, OpFRem, OpFMod to OpDot.
        if matches!(opcode, 12 | 127 | 129 | 131 | 133 | 136 | 140..=148) {
            decorations.extend([3 << 16 | OP_DECORATE, instruction[2], NO_CONTRACTION]);
        }
        // OpTypeVoid (19) to OpTypeForwardPointer (39).
        if body.is_empty() && !(19..=39).contains(&opcode) {
            head.extend(instruction);
        } else if opcode == OP_VARIABLE && instruction[3] == PRIVATE {
            body.push(4 << 16 | OP_VARIABLE);
            body.extend(&instruction[1..4]);
        } else {
            body.extend(instruction);
        }
        at += instruction.len();
    }
    [head, decorations, body].concat()
}
