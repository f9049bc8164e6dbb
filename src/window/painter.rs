//! Panels and picture, put on a texture.

use crate::gpu::Gpu;
use egui::{FullOutput, TextureId};
use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

/// Paints what a [`Session`](super::Session) laid out, on the device that drew its picture.
pub struct Painter {
    renderer: Renderer,
    /// What stands for the picture in the panels.
    picture: TextureId,
    /// The texture that it is now.
    shown: Option<wgpu::Texture>,
}

impl Painter {
    /// A painter for textures of this format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        // Dithering is for smooth gradients, of which panels have none, and costs adapters that are programs a fifth of the painting.
        let options = RendererOptions { dithering: false, ..RendererOptions::default() };
        let mut renderer = Renderer::new(&gpu.device, format, options);
        // Until there is a picture.
        let black = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("no picture"),
            size: Default::default(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = black.create_view(&Default::default());
        let picture = renderer.register_native_texture(&gpu.device, &view, wgpu::FilterMode::Linear);
        Self { renderer, picture, shown: None }
    }

    /// What stands for the picture in the panels.
    pub fn picture(&self) -> TextureId {
        self.picture
    }

    /// Paints the panels, with `picture` in their middle, over all of `target`, `size` pixels across and down.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        context: &egui::Context,
        output: &mut FullOutput,
        picture: Option<&wgpu::Texture>,
        (target, size): (&wgpu::TextureView, [u32; 2]),
    ) {
        self.show(gpu, picture);
        let shapes = std::mem::take(&mut output.shapes);
        let jobs = context.tessellate(shapes, output.pixels_per_point);
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point: output.pixels_per_point };
        self.take_textures(gpu, output);
        let label = Some("window");
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        let uploads = self.renderer.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &jobs, &screen);
        let load = wgpu::LoadOp::Clear(wgpu::Color::BLACK);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label,
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), &jobs, &screen);
        gpu.queue.submit(uploads.into_iter().chain([encoder.finish()]));
        for texture in output.textures_delta.free.drain() {
            self.renderer.free_texture(&texture);
        }
    }

    /// Takes over what a frame that is not painted brings for later ones.
    pub fn skip(&mut self, gpu: &Gpu, output: &mut FullOutput) {
        self.take_textures(gpu, output);
        for texture in output.textures_delta.free.drain() {
            self.renderer.free_texture(&texture);
        }
    }

    fn take_textures(&mut self, gpu: &Gpu, output: &mut FullOutput) {
        for (texture, deltas) in output.textures_delta.set.drain() {
            for delta in deltas {
                self.renderer.update_texture(&gpu.device, &gpu.queue, texture, &delta);
            }
        }
    }

    fn show(&mut self, gpu: &Gpu, picture: Option<&wgpu::Texture>) {
        let Some(texture) = picture.filter(|texture| self.shown.as_ref() != Some(texture)) else { return };
        let view = texture.create_view(&Default::default());
        let filter = wgpu::FilterMode::Linear;
        self.renderer.update_egui_texture_from_wgpu_texture(&gpu.device, &view, filter, self.picture);
        self.shown = Some(texture.clone());
    }
}
