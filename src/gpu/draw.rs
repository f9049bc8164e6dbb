//! A draw: one shader, one bind group, one colour target.

use super::live::Live;
use super::{Gpu, GpuError};
use std::ops::Range;

/// A render pipeline and the layout of its bind group 0.
#[derive(Debug)]
pub struct Draw {
    label: &'static str,
    pipeline: Live<wgpu::RenderPipeline>,
    layout: wgpu::BindGroupLayout,
}

/// What a [`Draw`] is made of.
pub struct DrawDescriptor<'a> {
    /// Stem of the shader file, and label.
    pub name: &'static str,
    /// Modules of the shader made for this use.
    pub generated: &'a [(&'a str, String)],
    /// Vertex and fragment entry points.
    pub entry_points: (&'a str, &'a str),
    /// What is bound, in the order of the bindings from 0.
    pub bindings: &'a [wgpu::BindingType],
    /// Vertex buffers and their attributes, interleaved; none for a full-screen draw.
    pub vertex_buffers: &'a [&'a [wgpu::VertexAttribute]],
    /// Attributes of each instance, interleaved in a buffer behind those of vertices; none where all are drawn once.
    pub instances: &'a [wgpu::VertexAttribute],
    /// Format of the colour target.
    pub format: wgpu::TextureFormat,
    /// Whether the nearest fragment wins, with reversed depth.
    pub depth: bool,
}

impl Draw {
    /// Compiles the shader and makes the pipeline.
    pub fn new(gpu: &Gpu, descriptor: &DrawDescriptor) -> Result<Self, GpuError> {
        let visibility = |ty: &wgpu::BindingType| match ty {
            // What vertices write is not to be had everywhere.
            ty if *ty == binding::STORAGE_OUT => wgpu::ShaderStages::FRAGMENT,
            _ => wgpu::ShaderStages::VERTEX_FRAGMENT,
        };
        let entry = |(index, ty): (usize, &wgpu::BindingType)| layout_entry(index, *ty, visibility(ty));
        let entries: Vec<_> = descriptor.bindings.iter().enumerate().map(entry).collect();
        let layout = layout(gpu, descriptor.name, &entries)?;
        let recipe = Recipe {
            name: descriptor.name,
            layout: layout.clone(),
            entry_points: (descriptor.entry_points.0.to_owned(), descriptor.entry_points.1.to_owned()),
            vertex_buffers: descriptor.vertex_buffers.iter().map(|buffer| buffer.to_vec()).collect(),
            instances: descriptor.instances.to_vec(),
            format: descriptor.format,
            depth: descriptor.depth,
        };
        let make = move |gpu: &Gpu, module: &wgpu::ShaderModule| recipe.make(gpu, module);
        let pipeline = Live::new(gpu, descriptor.name, descriptor.generated, Box::new(make))?;
        Ok(Self { label: descriptor.name, pipeline, layout })
    }

    /// Binds resources in the order of the bindings. What is drawn with them afterwards is drawn by the shader as it is now.
    pub fn bind(&self, gpu: &Gpu, resources: &[wgpu::BindingResource]) -> wgpu::BindGroup {
        self.pipeline.current(gpu);
        bind(gpu, self.label, &self.layout, resources)
    }

    /// Draws over the whole of a target, in a pass of its own, and hands it in.
    pub fn cover(
        &self,
        gpu: &Gpu,
        resources: &[wgpu::BindingResource],
        target: &wgpu::TextureView,
        timing: Option<wgpu::RenderPassTimestampWrites>,
    ) {
        let load = wgpu::LoadOp::Clear(wgpu::Color::BLACK);
        self.cover_with(gpu, &[(self.bind(gpu, resources), None)], load, target, timing);
    }

    /// Draws over rectangles of a target, columns and rows, each with resources of its own, in one pass. What is beside them all is
    /// cleared.
    pub fn cover_parts(
        &self,
        gpu: &Gpu,
        parts: &[([Range<u32>; 2], Vec<wgpu::BindingResource>)],
        beside: wgpu::Color,
        target: &wgpu::TextureView,
        timing: Option<wgpu::RenderPassTimestampWrites>,
    ) {
        let bound = |(rectangle, resources): &([Range<u32>; 2], Vec<wgpu::BindingResource>)| {
            (self.bind(gpu, resources), Some(rectangle.clone()))
        };
        let parts: Vec<_> =
            parts.iter().filter(|(sides, _)| !sides.iter().any(Range::is_empty)).map(bound).collect();
        self.cover_with(gpu, &parts, wgpu::LoadOp::Clear(beside), target, timing);
    }

    /// Draws over a rectangle of a target, in a pass of its own, and hands it in. What is beside it is cleared, or stays.
    pub fn cover_part(
        &self,
        gpu: &Gpu,
        bind_group: &wgpu::BindGroup,
        rectangle: [Range<u32>; 2],
        load: wgpu::LoadOp<wgpu::Color>,
        target: &wgpu::TextureView,
        timing: Option<wgpu::RenderPassTimestampWrites>,
    ) {
        self.cover_with(gpu, &[(bind_group.clone(), Some(rectangle))], load, target, timing);
    }

    fn cover_with(
        &self,
        gpu: &Gpu,
        parts: &[(wgpu::BindGroup, Option<[Range<u32>; 2]>)],
        load: wgpu::LoadOp<wgpu::Color>,
        target: &wgpu::TextureView,
        timing: Option<wgpu::RenderPassTimestampWrites>,
    ) {
        let label = Some(self.label);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label,
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            timestamp_writes: timing,
            ..Default::default()
        });
        for (bind_group, rectangle) in parts {
            self.begin(&mut pass, bind_group, &[]);
            if let Some([columns, rows]) = rectangle {
                pass.set_scissor_rect(columns.start, rows.start, columns.len() as u32, rows.len() as u32);
            }
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }

    /// Makes the pipeline and the bind group current. `offsets` choose the structs of [`binding::UNIFORM_EACH`].
    pub fn begin(&self, pass: &mut wgpu::RenderPass, bind_group: &wgpu::BindGroup, offsets: &[u32]) {
        pass.set_pipeline(&self.pipeline.last());
        pass.set_bind_group(0, bind_group, offsets);
    }
}

/// What a pipeline is made of besides its shader.
struct Recipe {
    name: &'static str,
    layout: wgpu::BindGroupLayout,
    entry_points: (String, String),
    vertex_buffers: Vec<Vec<wgpu::VertexAttribute>>,
    instances: Vec<wgpu::VertexAttribute>,
    format: wgpu::TextureFormat,
    depth: bool,
}

impl Recipe {
    fn make(&self, gpu: &Gpu, module: &wgpu::ShaderModule) -> Result<wgpu::RenderPipeline, GpuError> {
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let of_vertices = self.vertex_buffers.iter().map(|buffer| vertex_buffer(buffer));
        let of_instances = wgpu::VertexBufferLayout {
            step_mode: wgpu::VertexStepMode::Instance,
            ..vertex_buffer(&self.instances)
        };
        let of_instances = (!self.instances.is_empty()).then_some(of_instances);
        let buffers: Vec<_> = of_vertices.chain(of_instances).map(Some).collect();
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.name),
            layout: Some(&pipeline_layout(gpu, self.name, &self.layout)),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(&self.entry_points.0),
                compilation_options: Default::default(),
                buffers: &buffers,
            },
            primitive: Default::default(),
            depth_stencil: self.depth.then(|| wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module,
                entry_point: Some(&self.entry_points.1),
                compilation_options: Default::default(),
                targets: &[Some(self.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        match pollster::block_on(scope.pop()) {
            Some(error) => Err(GpuError::Shader(format!("{}.wgsl", self.name), error.to_string())),
            None => Ok(pipeline),
        }
    }
}

pub(super) fn layout(
    gpu: &Gpu,
    name: &str,
    entries: &[wgpu::BindGroupLayoutEntry],
) -> Result<wgpu::BindGroupLayout, GpuError> {
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(name), entries };
    let layout = gpu.device.create_bind_group_layout(&descriptor);
    match pollster::block_on(scope.pop()) {
        Some(error) => Err(GpuError::Shader(format!("{name}.wgsl"), error.to_string())),
        None => Ok(layout),
    }
}

pub(super) fn pipeline_layout(gpu: &Gpu, name: &str, layout: &wgpu::BindGroupLayout) -> wgpu::PipelineLayout {
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(name),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    })
}

fn vertex_buffer(attributes: &[wgpu::VertexAttribute]) -> wgpu::VertexBufferLayout<'_> {
    wgpu::VertexBufferLayout {
        array_stride: attributes.iter().map(|attribute| attribute.format.size()).sum(),
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes,
    }
}

pub(super) fn layout_entry(
    index: usize,
    ty: wgpu::BindingType,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry { binding: index as u32, visibility, ty, count: None }
}

pub(super) fn bind(
    gpu: &Gpu,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .enumerate()
        .map(|(index, resource)| wgpu::BindGroupEntry { binding: index as u32, resource: resource.clone() })
        .collect();
    let label = Some(label);
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout, entries: &entries })
}

/// The kinds of binding that draws use.
pub mod binding {
    /// A uniform buffer.
    pub const UNIFORM: wgpu::BindingType = buffer(false);
    /// One of several structs in a uniform buffer, chosen by an offset when it is bound.
    pub const UNIFORM_EACH: wgpu::BindingType = buffer(true);
    /// A 2D texture of floats that is read texel by texel.
    pub const TEXTURE: wgpu::BindingType = texture(wgpu::TextureViewDimension::D2, false);
    /// A storage buffer that is only read.
    pub const STORAGE: wgpu::BindingType = storage(true);
    /// A storage buffer that is written.
    pub const STORAGE_OUT: wgpu::BindingType = storage(false);
    /// Layers of 2D textures of floats, read texel by texel.
    pub const LAYERS: wgpu::BindingType = texture(wgpu::TextureViewDimension::D2Array, false);
    /// Layers of 2D textures, rgba32float, that a kernel writes.
    pub const LAYERS_OUT: wgpu::BindingType = wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format: wgpu::TextureFormat::Rgba32Float,
        view_dimension: wgpu::TextureViewDimension::D2Array,
    };
    /// A 3D texture, rgba16float, that a kernel writes.
    pub const VOXELS_OUT: wgpu::BindingType = wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format: wgpu::TextureFormat::Rgba16Float,
        view_dimension: wgpu::TextureViewDimension::D3,
    };
    /// A 2D texture of unsigned integers.
    pub const INTEGERS: wgpu::BindingType = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Uint,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    /// A 3D texture of 32-bit floats that a kernel writes.
    pub const GRID_OUT: wgpu::BindingType = grid_out(wgpu::TextureFormat::R32Float);
    /// A sampler that filters.
    pub const SAMPLER: wgpu::BindingType = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);

    const fn buffer(has_dynamic_offset: bool) -> wgpu::BindingType {
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: None,
        }
    }

    const fn storage(read_only: bool) -> wgpu::BindingType {
        wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        }
    }

    /// A 3D texture that a kernel writes.
    pub const fn grid_out(format: wgpu::TextureFormat) -> wgpu::BindingType {
        let (access, view_dimension) =
            (wgpu::StorageTextureAccess::WriteOnly, wgpu::TextureViewDimension::D3);
        wgpu::BindingType::StorageTexture { access, format, view_dimension }
    }

    /// A texture of floats; `filterable` where a sampler filters it.
    pub const fn texture(view_dimension: wgpu::TextureViewDimension, filterable: bool) -> wgpu::BindingType {
        wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        }
    }
}
