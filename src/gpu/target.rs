use super::{Gpu, GpuError};
use glam::UVec2;

/// A 2D texture that passes write and read.
#[derive(Debug)]
pub struct Target {
    /// The texture.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
}

impl Target {
    /// A target of `size` pixels.
    pub fn new(gpu: &Gpu, label: &str, size: UVec2, format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_2d;
        if size.max_element() > limit {
            return Err(GpuError::PictureTooLarge { width: size.x, height: size.y, limit });
        }
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self { view: texture.create_view(&Default::default()), texture })
    }

    /// The same target to draw into again if it fits, or another. What was in it is gone.
    ///
    /// # Errors
    ///
    /// As [`Self::new`].
    pub fn again(
        former: Option<Self>,
        gpu: &Gpu,
        label: &str,
        size: UVec2,
        format: wgpu::TextureFormat,
    ) -> Result<Self, GpuError> {
        let fits = |target: &Self| {
            let texture = &target.texture;
            (texture.width(), texture.height(), texture.format()) == (size.x, size.y, format)
        };
        former.filter(fits).map_or_else(|| Self::new(gpu, label, size, format), Ok)
    }

    /// Bytes that the texels take.
    pub fn bytes(&self) -> u64 {
        let texel = u64::from(self.texture.format().block_copy_size(None).unwrap_or(4));
        u64::from(self.texture.width()) * u64::from(self.texture.height()) * texel
    }
}

/// 2D textures of one size, one above the other, that draws or kernels write and kernels read.
#[derive(Debug)]
pub struct Layers {
    /// All of them.
    pub texture: wgpu::Texture,
    /// All of them.
    pub view: wgpu::TextureView,
}

impl Layers {
    /// So many layers of `size` texels, rgba32float.
    pub fn new(gpu: &Gpu, label: &str, size: UVec2, layers: u32) -> Self {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        Self { texture, view }
    }

    /// One layer, to draw on.
    pub fn layer(&self, layer: u32) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    }

    /// Bytes that the texels take.
    pub fn bytes(&self) -> u64 {
        let size = self.texture.size();
        16 * u64::from(size.width) * u64::from(size.height) * u64::from(size.depth_or_array_layers)
    }
}

/// Begins a pass that clears `colour` and draws what is nearest, with reversed depth.
pub fn begin<'encoder>(
    encoder: &'encoder mut wgpu::CommandEncoder,
    label: &str,
    clear: wgpu::Color,
    colour: &wgpu::TextureView,
    depth: &wgpu::TextureView,
    timing: Option<wgpu::RenderPassTimestampWrites>,
) -> wgpu::RenderPass<'encoder> {
    begin_part(encoder, label, (Some(clear), true), (colour, depth), timing)
}

/// Begins one of several passes that draw the same: the first one clears, the others go on with what there is, and the last one needs no depths
/// afterwards.
pub fn begin_part<'encoder>(
    encoder: &'encoder mut wgpu::CommandEncoder,
    label: &str,
    (clear, is_last): (Option<wgpu::Color>, bool),
    (colour, depth): (&wgpu::TextureView, &wgpu::TextureView),
    timing: Option<wgpu::RenderPassTimestampWrites>,
) -> wgpu::RenderPass<'encoder> {
    let colour_load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
    let depth_load = clear.map_or(wgpu::LoadOp::Load, |_| wgpu::LoadOp::Clear(0.0));
    let depth_store = if is_last { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: colour,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: colour_load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: depth_load, store: depth_store }),
            stencil_ops: None,
        }),
        timestamp_writes: timing,
        ..Default::default()
    })
}

/// A 2D texture of these texels, row by row.
pub fn texture_of(
    gpu: &Gpu,
    label: &str,
    size: UVec2,
    format: wgpu::TextureFormat,
    texels: &[u8],
) -> wgpu::Texture {
    let texel = format.block_copy_size(None).unwrap_or(4);
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(size.x * texel), rows_per_image: None };
    gpu.queue.write_texture(texture.as_image_copy(), texels, layout, texture.size());
    texture
}
