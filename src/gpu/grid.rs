use super::{Gpu, GpuError};
use glam::UVec3;

/// A 3D texture that kernels write, and kernels and draws read.
#[derive(Debug)]
pub struct Grid {
    /// The texture.
    pub texture: wgpu::Texture,
    /// All of it.
    pub view: wgpu::TextureView,
}

impl Grid {
    /// A grid of `size` texels.
    ///
    /// # Errors
    ///
    /// If a side is longer than the adapter allows.
    pub fn new(gpu: &Gpu, label: &str, size: UVec3, format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_3d;
        if size.max_element() > limit {
            return Err(GpuError::GridTooLarge { what: label.into(), size: size.to_array(), limit });
        }
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format,
            usage: wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        Ok(Self { view: texture.create_view(&Default::default()), texture })
    }

    /// Texels along each axis.
    pub fn size(&self) -> UVec3 {
        let size = self.texture.size();
        UVec3::new(size.width, size.height, size.depth_or_array_layers)
    }

    /// Bytes that the texels take.
    pub fn bytes(&self) -> u64 {
        let texel = u64::from(self.texture.format().block_copy_size(None).unwrap_or(4));
        self.size().to_array().into_iter().map(u64::from).product::<u64>() * texel
    }
}
