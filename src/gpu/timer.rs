use super::readback::read_mapped;
use super::{Gpu, GpuError};
use bevy_ecs::prelude::Resource;

/// Times passes by the GPU's own clock, where it has one.
#[derive(Resource, Debug)]
pub struct PassTimer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
    names: Vec<&'static str>,
}

/// The most passes timed in one frame.
const CAPACITY: u32 = 64;

impl PassTimer {
    /// A timer, if the device has time stamps.
    pub fn new(gpu: &Gpu) -> Option<Self> {
        gpu.has(wgpu::Features::TIMESTAMP_QUERY).then(|| Self {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("pass times"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * CAPACITY,
            }),
            resolved: time_buffer(gpu, wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: time_buffer(gpu, wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
            names: Vec::new(),
        })
    }

    /// The places in which a draw is to leave its beginning and end.
    pub fn time(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (beginning, end) = self.places(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(beginning),
            end_of_pass_write_index: Some(end),
        })
    }

    /// The places in which a kernel is to leave its beginning and end.
    pub fn time_compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (beginning, end) = self.places(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(beginning),
            end_of_pass_write_index: Some(end),
        })
    }

    fn places(&mut self, name: &'static str) -> Option<(u32, u32)> {
        let index = self.names.len() as u32;
        if index == CAPACITY {
            return None;
        }
        self.names.push(name);
        Some((2 * index, 2 * index + 1))
    }

    /// The passes timed since the last call, and their milliseconds. Waits for them.
    pub fn collect(&mut self, gpu: &Gpu) -> Result<Vec<(&'static str, f64)>, GpuError> {
        let names = std::mem::take(&mut self.names);
        if names.is_empty() {
            return Ok(Vec::new());
        }
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.resolve_query_set(&self.queries, 0..2 * names.len() as u32, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.readable, 0, self.readable.size());
        gpu.queue.submit([encoder.finish()]);
        let bytes = read_mapped(gpu, &self.readable)?;
        self.readable.unmap();
        let ticks: Vec<u64> = bytes.chunks_exact(8).map(bytemuck::pod_read_unaligned).collect();
        let milliseconds = |pair: &[u64]| {
            pair[1].saturating_sub(pair[0]) as f64 * f64::from(gpu.queue.get_timestamp_period()) * 1e-6
        };
        Ok(names.into_iter().zip(ticks.chunks_exact(2).map(milliseconds)).collect())
    }
}

fn time_buffer(gpu: &Gpu, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("pass times"),
        size: u64::from(CAPACITY) * 16,
        usage,
        mapped_at_creation: false,
    })
}

/// Of the times of many draws those that the first and the last of them write.
pub fn ends<'a>(
    all: &wgpu::RenderPassTimestampWrites<'a>,
    is_first: bool,
    is_last: bool,
) -> Option<wgpu::RenderPassTimestampWrites<'a>> {
    let beginning_of_pass_write_index = all.beginning_of_pass_write_index.filter(|_| is_first);
    let end_of_pass_write_index = all.end_of_pass_write_index.filter(|_| is_last);
    (is_first || is_last).then_some(wgpu::RenderPassTimestampWrites {
        query_set: all.query_set,
        beginning_of_pass_write_index,
        end_of_pass_write_index,
    })
}
