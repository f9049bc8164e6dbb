use super::GpuError;
use super::live::ShaderChanges;
use bevy_ecs::prelude::Resource;
use std::sync::Arc;

/// The adapter, its device and what it can do.
#[derive(Resource, Debug)]
pub struct Gpu {
    /// Makes resources.
    pub device: wgpu::Device,
    /// Takes work.
    pub queue: wgpu::Queue,
    /// Who the adapter is.
    pub info: wgpu::AdapterInfo,
    pub(super) shader_changes: Arc<ShaderChanges>,
}

/// How to choose the device.
#[derive(Clone, Debug, Default)]
pub struct GpuOptions {
    /// Use only what WebGPU guarantees everywhere, whatever else the adapter has.
    pub portable: bool,
}

/// What is used where it is there. Nothing is required.
const OPTIONAL: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY
    .union(wgpu::Features::FLOAT32_FILTERABLE)
    .union(wgpu::Features::TEXTURE_FORMAT_16BIT_NORM);

impl Gpu {
    /// Takes the best adapter of this machine, or the one that the environment asks for (`WGPU_ADAPTER_NAME`, `WGPU_BACKEND`).
    pub async fn new(options: &GpuOptions) -> Result<Self, GpuError> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::PRIMARY;
        if !cfg!(debug_assertions) {
            descriptor.flags = wgpu::InstanceFlags::empty();
        }
        let instance = wgpu::Instance::new(descriptor.with_env());
        let request = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = match wgpu::util::initialize_adapter_from_env(&instance, None).await {
            Ok(adapter) => adapter,
            Err(_) => instance
                .request_adapter(&request)
                .await
                .map_err(|error| GpuError::NoAdapter(error.to_string()))?,
        };
        Self::from_adapter(&adapter, options).await
    }

    /// Opens a device on a given adapter.
    pub async fn from_adapter(adapter: &wgpu::Adapter, options: &GpuOptions) -> Result<Self, GpuError> {
        let info = adapter.get_info();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("tyndall"),
            required_features: if options.portable {
                wgpu::Features::empty()
            } else {
                adapter.features() & OPTIONAL
            },
            required_limits: if options.portable { wgpu::Limits::default() } else { adapter.limits() },
            ..Default::default()
        };
        let opened = adapter.request_device(&descriptor).await;
        let (device, queue) = opened
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        Ok(Self { device, queue, info, shader_changes: Arc::default() })
    }

    /// Whether the device has a feature.
    pub fn has(&self, feature: wgpu::Features) -> bool {
        self.device.features().contains(feature)
    }

    /// Whether the adapter is a program that runs on the processor.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// Waits until all work handed in so far is done.
    pub fn wait(&self, doing: &str) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        waited
            .map(|_| ())
            .map_err(|error| GpuError::Driver { doing: doing.into(), reason: error.to_string() })
    }
}
