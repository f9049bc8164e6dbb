//! A kernel: one compute shader, one bind group.

use super::live::Live;
use super::{Gpu, GpuError};

/// A compute pipeline and the layout of its bind group 0.
#[derive(Debug)]
pub struct Kernel {
    label: &'static str,
    pipeline: Live<wgpu::ComputePipeline>,
    layout: wgpu::BindGroupLayout,
}

/// What a [`Kernel`] is made of.
pub struct KernelDescriptor<'a> {
    /// Stem of the shader file, and label.
    pub name: &'static str,
    /// Modules of the shader made for this use.
    pub generated: &'a [(&'a str, String)],
    /// The compute entry point.
    pub entry_point: &'a str,
    /// What is bound, in the order of the bindings from 0.
    pub bindings: &'a [wgpu::BindingType],
}

impl Kernel {
    /// Compiles the shader and makes the pipeline.
    pub fn new(gpu: &Gpu, descriptor: &KernelDescriptor) -> Result<Self, GpuError> {
        let visibility = wgpu::ShaderStages::COMPUTE;
        let entry =
            |(index, ty): (usize, &wgpu::BindingType)| super::draw::layout_entry(index, *ty, visibility);
        let entries: Vec<_> = descriptor.bindings.iter().enumerate().map(entry).collect();
        let layout = super::draw::layout(gpu, descriptor.name, &entries)?;
        let (name, entry_point) = (descriptor.name, descriptor.entry_point.to_owned());
        let own_layout = layout.clone();
        let make = move |gpu: &Gpu, module: &wgpu::ShaderModule| {
            let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
            let pipeline_layout = super::draw::pipeline_layout(gpu, name, &own_layout);
            let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(name),
                layout: Some(&pipeline_layout),
                module,
                entry_point: Some(&entry_point),
                compilation_options: Default::default(),
                cache: None,
            });
            match pollster::block_on(scope.pop()) {
                Some(error) => Err(GpuError::Shader(format!("{name}.wgsl"), error.to_string())),
                None => Ok(pipeline),
            }
        };
        let pipeline = Live::new(gpu, name, descriptor.generated, Box::new(make))?;
        Ok(Self { label: name, pipeline, layout })
    }

    /// Invocations of a workgroup, in a row: what every kernel declares.
    pub const WORKGROUP: u32 = 64;

    /// Runs at least `invocations` of the kernel on these resources, bound in order.
    pub fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        resources: &[wgpu::BindingResource],
        invocations: Invocations,
        timing: Option<wgpu::ComputePassTimestampWrites>,
    ) {
        let bind_group = super::draw::bind(gpu, self.label, &self.layout, resources);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(self.label),
            timestamp_writes: timing,
        });
        pass.set_pipeline(&self.pipeline.current(gpu));
        pass.set_bind_group(0, &bind_group, &[]);
        match invocations {
            Invocations::Count(count) => {
                let (across, down) = Self::workgroups(count);
                pass.dispatch_workgroups(across, down, 1);
            }
            Invocations::Planned(buffer, offset) => pass.dispatch_workgroups_indirect(buffer, offset),
        }
    }

    /// Runs at least `invocations` of the kernel again and again, each time with another struct of its
    /// [`binding::UNIFORM_EACH`](super::binding::UNIFORM_EACH), at the given offsets; what one run writes the next one reads.
    pub fn sweep(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        resources: &[wgpu::BindingResource],
        invocations: u32,
        offsets: impl Iterator<Item = u32>,
        timing: Option<wgpu::ComputePassTimestampWrites>,
    ) {
        let bind_group = super::draw::bind(gpu, self.label, &self.layout, resources);
        let descriptor = wgpu::ComputePassDescriptor { label: Some(self.label), timestamp_writes: timing };
        let mut pass = encoder.begin_compute_pass(&descriptor);
        pass.set_pipeline(&self.pipeline.current(gpu));
        let (across, down) = Self::workgroups(invocations);
        for offset in offsets {
            pass.set_bind_group(0, &bind_group, &[offset]);
            pass.dispatch_workgroups(across, down, 1);
        }
    }

    /// Workgroups across and down: no dimension may have more than 65,535.
    fn workgroups(invocations: u32) -> (u32, u32) {
        let groups = invocations.div_ceil(Self::WORKGROUP);
        let across = groups.clamp(1, 32_768);
        (across, groups.div_ceil(across))
    }
}

/// How often a kernel runs.
#[derive(Clone, Copy, Debug)]
pub enum Invocations<'a> {
    /// So often.
    Count(u32),
    /// As an earlier kernel wrote into a buffer, at an offset in bytes: workgroups across, down and deep.
    Planned(&'a wgpu::Buffer, u64),
}
