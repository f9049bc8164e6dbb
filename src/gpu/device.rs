use super::GpuError;
use super::live::ShaderChanges;
use bevy_ecs::prelude::Resource;
use std::sync::Arc;

/// The adapter, its device and what it can do. Clones share the device.
#[derive(Resource, Clone, Debug)]
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
        let adapter = adapter(&Self::instance(None), None).await?;
        Self::from_adapter(&adapter, options).await
    }

    /// The same among the adapters that can show something on a surface of `instance`.
    pub async fn for_surface(
        instance: &wgpu::Instance,
        surface: &wgpu::Surface<'_>,
        options: &GpuOptions,
    ) -> Result<(Self, wgpu::Adapter), GpuError> {
        let adapter = adapter(instance, Some(surface)).await?;
        Ok((Self::from_adapter(&adapter, options).await?, adapter))
    }

    /// What adapters are found through; for surfaces with the display that they are on.
    pub fn instance(display: Option<Box<dyn wgpu::wgt::WgpuHasDisplayHandle>>) -> wgpu::Instance {
        let mut descriptor = match display {
            Some(display) => wgpu::InstanceDescriptor::new_with_display_handle(display),
            None => wgpu::InstanceDescriptor::new_without_display_handle(),
        };
        descriptor.backends = wgpu::Backends::PRIMARY;
        if !cfg!(debug_assertions) {
            descriptor.flags = wgpu::InstanceFlags::empty();
        }
        wgpu::Instance::new(descriptor.with_env())
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

/// The adapter that the environment asks for, or the best one.
async fn adapter(
    instance: &wgpu::Instance,
    compatible_surface: Option<&wgpu::Surface<'_>>,
) -> Result<wgpu::Adapter, GpuError> {
    if let Ok(adapter) = wgpu::util::initialize_adapter_from_env(instance, compatible_surface).await {
        return Ok(adapter);
    }
    let request = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        compatible_surface,
        ..Default::default()
    };
    instance.request_adapter(&request).await.map_err(|error| GpuError::NoAdapter(error.to_string()))
}
