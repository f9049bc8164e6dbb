//! The surface of a window: what is painted on it is shown.

use super::{Painter, WindowError};
use crate::gpu::{Gpu, GpuError, GpuOptions};
use std::sync::Arc;
use wgpu::CurrentSurfaceTexture as Current;
use winit::window::Window;

/// A window's surface, and how it is configured.
pub(super) struct WindowSurface {
    instance: wgpu::Instance,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    window: Arc<Window>,
}

/// What came of asking for a texture to paint on.
pub(super) enum Next {
    /// Paint on this.
    Texture(wgpu::SurfaceTexture),
    /// Nothing can be shown now; when that changes, the window is told.
    Hidden,
    /// Ask once more.
    Again,
}

impl WindowSurface {
    /// The surface of a window, and the best device that can show something on it.
    pub fn new(
        window: Arc<Window>,
        display: winit::event_loop::OwnedDisplayHandle,
        options: &GpuOptions,
    ) -> Result<(Self, Gpu), WindowError> {
        let instance = Gpu::instance(Some(Box::new(display)));
        let surface = surface_of(&instance, &window)?;
        let (gpu, adapter) = pollster::block_on(Gpu::for_surface(&instance, &surface, options))?;
        let capabilities = surface.get_capabilities(&adapter);
        let size = window.inner_size();
        let limit = gpu.device.limits().max_texture_dimension_2d;
        let (width, height) = (size.width.clamp(1, limit), size.height.clamp(1, limit));
        let config = surface.get_default_config(&adapter, width, height);
        let mut config = config.ok_or_else(|| {
            WindowError::NoWindow(format!("the adapter `{}` cannot show anything on it", gpu.info.name))
        })?;
        // Panels and pictures are encoded already.
        let encoded = [wgpu::TextureFormat::Bgra8Unorm, wgpu::TextureFormat::Rgba8Unorm];
        if let Some(format) = encoded.into_iter().find(|format| capabilities.formats.contains(format)) {
            config.format = format;
        }
        if gpu.is_software() {
            // Frames are late anyway; waiting for the screen's next one would make them later.
            config.present_mode = wgpu::PresentMode::AutoNoVsync;
        }
        surface.configure(&gpu.device, &config);
        Ok((Self { instance, surface, config, window }, gpu))
    }

    /// Another device for the same window.
    pub fn reopen(&mut self, options: &GpuOptions) -> Result<Gpu, WindowError> {
        let (gpu, _) = pollster::block_on(Gpu::for_surface(&self.instance, &self.surface, options))?;
        self.surface.configure(&gpu.device, &self.config);
        Ok(gpu)
    }

    /// A painter for it.
    pub fn painter(&self, gpu: &Gpu) -> Painter {
        Painter::new(gpu, self.config.format)
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// Follows the window, which is nothing at all while it is minimised.
    pub fn resize(&mut self, gpu: &Gpu, width: u32, height: u32) {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if width > 0 && height > 0 {
            (self.config.width, self.config.height) = (width.min(limit), height.min(limit));
            self.surface.configure(&gpu.device, &self.config);
        }
    }

    /// The texture that will be shown next.
    pub fn next(&mut self, gpu: &Gpu) -> Result<Next, WindowError> {
        match self.surface.get_current_texture() {
            Current::Success(texture) => return Ok(Next::Texture(texture)),
            // The window is another size than the surface, and will say so; until then this is as good as it gets.
            Current::Suboptimal(texture) => return Ok(Next::Texture(texture)),
            Current::Occluded => return Ok(Next::Hidden),
            Current::Timeout => {}
            Current::Outdated | Current::Validation => self.surface.configure(&gpu.device, &self.config),
            Current::Lost => {
                self.surface = surface_of(&self.instance, &self.window)?;
                self.surface.configure(&gpu.device, &self.config);
            }
        }
        Ok(Next::Again)
    }
}

fn surface_of(
    instance: &wgpu::Instance,
    window: &Arc<Window>,
) -> Result<wgpu::Surface<'static>, WindowError> {
    let made = instance.create_surface(window.clone());
    made.map_err(|error| GpuError::NoAdapter(format!("no surface on this window: {error}")).into())
}
