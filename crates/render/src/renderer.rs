//! Pictures on the GPU.

use crate::cpu::PUSH;
use crate::splats::Extra;
use crate::style::{SOFT, SOLID, packed_ramp};
use crate::view::Uniform;
use crate::{Camera, Error, Picture, Size, Splats, Style};
use glam::Vec3;
use std::num::NonZeroU64;
use surfine::{Gpu, GpuRefined, Point, wgpu};

/// The texts of the shaders by name: the passes over discs, and the pass over pixels.
pub const SHADERS: [(&str, &str); 2] = [
    (
        "splat",
        concat!(
            include_str!("../../../shaders/render/splat.wgsl"),
            "\n",
            include_str!("../../../shaders/render/view.wgsl")
        ),
    ),
    (
        "resolve",
        concat!(
            include_str!("../../../shaders/render/resolve.wgsl"),
            "\n",
            include_str!("../../../shaders/render/view.wgsl")
        ),
    ),
];

/// Half floats: sums of more than some hundred discs lose digits.
const SUMS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Compiled passes; keep it and draw many pictures.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    fronts: wgpu::RenderPipeline,
    backs: wgpu::RenderPipeline,
    attributes: wgpu::RenderPipeline,
    resolve: wgpu::RenderPipeline,
    ramp: wgpu::Buffer,
    /// For points without extras.
    no_extras: wgpu::Buffer,
}

/// What the passes of a picture draw into.
struct Targets {
    /// Depth of the discs that show their fronts.
    fronts: wgpu::Texture,
    /// Depth of all discs.
    nearest: wgpu::Texture,
    /// Sums of the attribute pass.
    colors: wgpu::Texture,
    normals: wgpu::Texture,
    picture: wgpu::Texture,
}

/// Bytes of a point.
const POINT: u64 = size_of::<Point>() as u64;
/// Bindings begin at multiples of so many bytes, whatever the driver.
const BINDING_STEP: u64 = 256;

/// Points in device memory, ready to be drawn.
#[derive(Clone, Debug, Default)]
pub struct DeviceSplats {
    parts: Vec<Part>,
    /// Corners of a box around them, if it is known.
    bounds: Option<[Vec3; 2]>,
}

/// As many points as one buffer holds.
#[derive(Clone, Debug)]
struct Part {
    points: wgpu::Buffer,
    extras: Option<wgpu::Buffer>,
    count: u32,
}

impl From<&GpuRefined> for DeviceSplats {
    /// The engine's own buffer: nothing is copied. The camera and the radii of a style have the coordinates of these
    /// points. What is nearer to the eye than 1e-5 of the distance to the camera's target is not seen.
    fn from(refined: &GpuRefined) -> Self {
        let count = refined.len() as u32;
        let part = Part { points: refined.points.clone(), extras: None, count };
        Self { parts: if count > 0 { vec![part] } else { Vec::new() }, bounds: None }
    }
}

impl Renderer {
    /// Compiles the passes for a device.
    ///
    /// # Errors
    /// The driver refuses them.
    pub fn new(gpu: &Gpu) -> Result<Self, Error> {
        let made = gpu.guarded(|| {
            let [splat, resolve] = SHADERS.map(|(name, text)| {
                gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(name),
                    source: wgpu::ShaderSource::Wgsl(text.into()),
                })
            });
            let storage = wgpu::BufferUsages::STORAGE;
            Ok(Self {
                fronts: splat_pipeline(gpu, &splat, ["front", "visibility"], &[]),
                backs: splat_pipeline(gpu, &splat, ["back", "visibility"], &[]),
                attributes: splat_pipeline(gpu, &splat, ["either", "attributes"], &sums_targets()),
                resolve: resolve_pipeline(gpu, &resolve),
                ramp: buffer(gpu, "ramp", &packed_ramp(), storage),
                no_extras: buffer(gpu, "no extras", &[Extra::default()], storage),
                gpu: gpu.clone(),
            })
        });
        Ok(made?)
    }

    /// Checks that a picture has pixels, and not more than the device allows.
    ///
    /// # Errors
    /// It has none, or too many.
    pub fn check(&self, size: Size, supersampling: u32) -> Result<(), Error> {
        size.check(supersampling, self.gpu.device.limits().max_texture_dimension_2d)
    }

    /// Copies points to the device.
    ///
    /// # Errors
    /// The device has no room for them.
    pub fn upload(&self, splats: &Splats) -> Result<DeviceSplats, Error> {
        let widest = if splats.extras.is_empty() { size_of::<Point>() } else { size_of::<Extra>() };
        let most = self.gpu.largest_binding() as usize / widest;
        let usage = wgpu::BufferUsages::STORAGE;
        let parts = self.gpu.guarded(|| {
            let chunks = splats.points.chunks(most).enumerate();
            Ok(chunks
                .map(|(i, points)| {
                    let extras = splats.extras.chunks(most).nth(i);
                    Part {
                        points: buffer(&self.gpu, "points", points, usage),
                        extras: extras.map(|extras| buffer(&self.gpu, "extras", extras, usage)),
                        count: points.len() as u32,
                    }
                })
                .collect())
        });
        Ok(DeviceSplats { parts: parts?, bounds: splats.bounds })
    }

    /// Draws points and reads the picture back.
    ///
    /// # Errors
    /// The picture has no pixels or more than the device allows, or the device fails.
    pub fn draw(
        &self,
        splats: &DeviceSplats,
        camera: &Camera,
        style: &Style,
        size: Size,
    ) -> Result<Picture, Error> {
        let texture = self.draw_on_device(splats, camera, style, size)?;
        Ok(self.gpu.guarded(|| self.read_back(&texture, size))?)
    }

    /// Draws points and leaves the picture on the device: a texture of format `Rgba8Unorm` that holds sRGB-encoded
    /// colours, usable as copy source and as texture binding.
    ///
    /// # Errors
    /// As [`Renderer::draw`].
    pub fn draw_on_device(
        &self,
        splats: &DeviceSplats,
        camera: &Camera,
        style: &Style,
        size: Size,
    ) -> Result<wgpu::Texture, Error> {
        self.check(size, style.supersampling)?;
        let view = Uniform::new(camera, style, size, splats.bounds);
        let submitted = self.gpu.guarded(|| {
            let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
            let picture = self.record(&mut encoder, splats, &view, size);
            self.gpu.queue.submit([encoder.finish()]);
            Ok(picture)
        });
        Ok(submitted?)
    }

    fn record(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        splats: &DeviceSplats,
        view: &Uniform,
        size: Size,
    ) -> wgpu::Texture {
        let targets = Targets::new(&self.gpu, size, view.supersampling);
        let uniform = buffer(&self.gpu, "view", &[*view], wgpu::BufferUsages::UNIFORM);
        let fronts = view_of(&targets.fronts);
        let shared = [
            uniform.as_entire_binding(),
            self.ramp.as_entire_binding(),
            wgpu::BindingResource::TextureView(&fronts),
        ];
        self.record_visibility(encoder, splats, &targets, &shared);
        self.record_attributes(encoder, splats, &targets, &shared);
        self.record_resolve(encoder, &targets, &shared[..1]);
        targets.picture
    }

    /// Depth of the fronts, then that of the backs beside it.
    fn record_visibility(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        splats: &DeviceSplats,
        targets: &Targets,
        shared: &[wgpu::BindingResource<'_>; 3],
    ) {
        let (fronts, nearest) = (view_of(&targets.fronts), view_of(&targets.nearest));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("visibility of fronts"),
            depth_stencil_attachment: Some(depth_attachment(&fronts, wgpu::LoadOp::Clear(0.0))),
            ..Default::default()
        });
        self.draw_discs(&mut pass, &self.fronts, splats, &shared[..2]);
        drop(pass);
        encoder.copy_texture_to_texture(
            targets.fronts.as_image_copy(),
            targets.nearest.as_image_copy(),
            targets.nearest.size(),
        );
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("visibility of backs"),
            depth_stencil_attachment: Some(depth_attachment(&nearest, wgpu::LoadOp::Load)),
            ..Default::default()
        });
        self.draw_discs(&mut pass, &self.backs, splats, shared);
    }

    /// Sums of what is not behind that depth.
    fn record_attributes(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        splats: &DeviceSplats,
        targets: &Targets,
        shared: &[wgpu::BindingResource<'_>; 3],
    ) {
        let [colors, normals, nearest] =
            [&targets.colors, &targets.normals, &targets.nearest].map(view_of);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("attributes"),
            color_attachments: &[color_attachment(&colors), color_attachment(&normals)],
            depth_stencil_attachment: Some(depth_attachment(&nearest, wgpu::LoadOp::Load)),
            ..Default::default()
        });
        self.draw_discs(&mut pass, &self.attributes, splats, shared);
    }

    /// The picture of the sums.
    fn record_resolve(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        shared: &[wgpu::BindingResource<'_>],
    ) {
        let picture = view_of(&targets.picture);
        let textures = [&targets.colors, &targets.normals, &targets.nearest].map(view_of);
        let textures = textures.each_ref().map(wgpu::BindingResource::TextureView);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("resolve"),
            color_attachments: &[color_attachment(&picture)],
            ..Default::default()
        });
        pass.set_pipeline(&self.resolve);
        pass.set_bind_group(0, &self.bind(&self.resolve, 0, shared), &[]);
        pass.set_bind_group(1, &self.bind(&self.resolve, 1, &textures), &[]);
        pass.draw(0..3, 0..1);
    }

    fn draw_discs(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: &wgpu::RenderPipeline,
        splats: &DeviceSplats,
        shared: &[wgpu::BindingResource<'_>],
    ) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.bind(pipeline, 0, shared), &[]);
        // The engine's buffers can be longer than a binding. Those with extras are not.
        let most = (self.gpu.largest_binding() / BINDING_STEP * BINDING_STEP / POINT) as u32;
        for part in &splats.parts {
            let extras = part.extras.as_ref().unwrap_or(&self.no_extras).as_entire_binding();
            for first in (0..part.count).step_by(most as usize) {
                let count = most.min(part.count - first);
                let points = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &part.points,
                    offset: POINT * u64::from(first),
                    size: NonZeroU64::new(POINT * u64::from(count)),
                });
                let group = self.bind(pipeline, 1, &[points, extras.clone()]);
                pass.set_bind_group(1, &group, &[]);
                pass.draw(0..4, 0..count);
            }
        }
    }

    /// Binds resources to the bindings of a group, from 0 on.
    fn bind(
        &self,
        pipeline: &wgpu::RenderPipeline,
        group: u32,
        resources: &[wgpu::BindingResource<'_>],
    ) -> wgpu::BindGroup {
        let numbered = (0..).zip(resources.iter().cloned());
        let entries =
            numbered.map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource });
        self.gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(group),
            entries: &entries.collect::<Vec<_>>(),
        })
    }

    fn read_back(&self, texture: &wgpu::Texture, size: Size) -> Result<Picture, surfine::Error> {
        let row = 4 * size.width;
        let stride = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let staging = self.gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("pixels"),
            size: u64::from(stride) * u64::from(size.height),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(stride),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &staging, layout },
            texture.size(),
        );
        self.gpu.queue.submit([encoder.finish()]);
        let bytes = self.gpu.map(&staging)?;
        let rows = bytes.chunks_exact(stride as usize);
        let pixels = rows.flat_map(|bytes| bytes[..row as usize].as_chunks().0).copied().collect();
        Ok(Picture { size, pixels })
    }
}

impl Targets {
    fn new(gpu: &Gpu, size: Size, side: u32) -> Self {
        let subpixels = Size { width: size.width * side, height: size.height * side };
        let target = |label, format, size| texture(gpu, label, format, size);
        Self {
            fronts: target("fronts", DEPTH, subpixels),
            nearest: target("nearest", DEPTH, subpixels),
            colors: target("colors", SUMS, subpixels),
            normals: target("normals", SUMS, subpixels),
            picture: target("picture", PICTURE, size),
        }
    }
}

fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn buffer<T: bytemuck::NoUninit>(
    gpu: &Gpu,
    label: &str,
    data: &[T],
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size_of_val(data) as u64,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    gpu.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(data));
    buffer
}

fn texture(gpu: &Gpu, label: &str, format: wgpu::TextureFormat, size: Size) -> wgpu::Texture {
    let mut usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    if format != SUMS {
        usage |= wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST;
    }
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.width, height: size.height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

fn depth_attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<f32>,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}

fn color_attachment(view: &wgpu::TextureView) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let ops = wgpu::Operations {
        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
        store: wgpu::StoreOp::Store,
    };
    Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
}

/// Both sums add up.
fn sums_targets() -> [Option<wgpu::ColorTargetState>; 2] {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    let target = wgpu::ColorTargetState {
        format: SUMS,
        blend: Some(wgpu::BlendState { color: add, alpha: add }),
        write_mask: wgpu::ColorWrites::ALL,
    };
    [Some(target.clone()), Some(target)]
}

/// The pass over discs with that vertex and that fragment shader: without targets it writes depth, with targets it tests against it.
fn splat_pipeline(
    gpu: &Gpu,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    targets: &[Option<wgpu::ColorTargetState>],
) -> wgpu::RenderPipeline {
    let first = targets.is_empty();
    let (push, disc) = if first { (PUSH, SOLID) } else { (0.0, SOFT) };
    let constants = [("push", push.into()), ("disc", disc.into())];
    let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(fragment),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(first),
            // Depth is near / distance: the larger is the nearer.
            depth_compare: Some(wgpu::CompareFunction::GreaterEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: options,
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn resolve_pipeline(gpu: &Gpu, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("resolve"),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some("everywhere"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some("resolve"),
            compilation_options: Default::default(),
            targets: &[Some(PICTURE.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
