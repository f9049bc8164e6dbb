use super::GpuError;
use super::live::ShaderChanges;
use bevy_ecs::prelude::Resource;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The adapter, its device and what it can do. Clones share the device.
#[derive(Resource, Clone, Debug)]
pub struct Gpu {
    /// Makes resources.
    pub device: wgpu::Device,
    /// Takes work.
    pub queue: wgpu::Queue,
    /// Who the adapter is.
    pub info: wgpu::AdapterInfo,
    /// How the device was chosen.
    pub options: GpuOptions,
    pub(super) shader_changes: Arc<ShaderChanges>,
    faults: Arc<Faults>,
}

/// What the driver says without having been asked.
#[derive(Debug, Default)]
struct Faults {
    /// Why the device is gone.
    lost: OnceLock<String>,
    /// The first error that no [`Gpu::attempt`] was there for.
    unexpected: Mutex<Option<String>>,
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
        let faults = Arc::<Faults>::default();
        let lost = faults.clone();
        // Only the first reason is one.
        device.set_device_lost_callback(move |_, reason| _ = lost.lost.set(reason));
        let unexpected = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            log::error!("{error}");
            let mut kept = unexpected.unexpected.lock().unwrap_or_else(PoisonError::into_inner);
            kept.get_or_insert_with(|| error.to_string());
        }));
        Ok(Self { device, queue, info, options: options.clone(), shader_changes: Arc::default(), faults })
    }

    /// Why the device is gone, if it is. Nothing can be done with it then but to open another: see
    /// [`recover`](crate::render::recover).
    pub fn lost(&self) -> Option<&str> {
        self.faults.lost.get().map(String::as_str)
    }

    /// Does something, and takes what the driver has against it, running out of memory above all, for its error.
    ///
    /// # Errors
    ///
    /// That of the work itself, else what the driver says.
    pub fn attempt<T>(&self, doing: &str, work: impl FnOnce() -> Result<T, GpuError>) -> Result<T, GpuError> {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        let scopes = [Internal, Validation, OutOfMemory].map(|filter| self.device.push_error_scope(filter));
        let done = work();
        // The last scope opened is the first to close. Running out of memory makes what follows invalid, so it comes first.
        let errors: Vec<_> =
            scopes.into_iter().rev().filter_map(|scope| pollster::block_on(scope.pop())).collect();
        let done = done?;
        match errors.first() {
            Some(error) => Err(GpuError::Driver { doing: doing.into(), reason: error.to_string() }),
            None => Ok(done),
        }
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
    ///
    /// # Errors
    ///
    /// If the driver fails, or has said since the last time that something did.
    pub fn wait(&self, doing: &str) -> Result<(), GpuError> {
        self.wait_for(None, doing)
    }

    /// Waits until what was handed in with this index is done, or everything so far.
    ///
    /// # Errors
    ///
    /// As [`wait`](Self::wait).
    pub fn wait_for(&self, submission: Option<wgpu::SubmissionIndex>, doing: &str) -> Result<(), GpuError> {
        let failed = |reason| GpuError::Driver { doing: doing.into(), reason };
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index: submission, timeout: None });
        waited.map_err(|error| failed(error.to_string()))?;
        let mut unexpected = self.faults.unexpected.lock().unwrap_or_else(PoisonError::into_inner);
        unexpected.take().map_or(Ok(()), |reason| Err(failed(reason)))
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
