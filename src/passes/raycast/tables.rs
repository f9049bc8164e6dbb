//! What the ray caster looks up of transfer functions and of empty space.

use super::{FORMAT, VolumeData};
use crate::gpu::{Gpu, texture_of};
use glam::{UVec2, Vec4};

/// The lookup tables and brick distances of all volumes.
#[derive(Debug)]
pub struct Tables {
    /// One row a volume; more for those with more entries than [`TABLE_ROW`].
    pub entries: wgpu::Texture,
    /// One behind the other, in rows of [`BRICK_ROW`].
    pub distances: wgpu::Texture,
    /// First brick and first row of each volume.
    pub starts: Vec<[u32; 2]>,
    pub bytes: (u64, u64),
}

/// Bricks in a row of their texture.
pub(crate) const BRICK_ROW: u32 = 2048;

/// Entries in a row of a table.
pub(crate) const TABLE_ROW: u32 = 8192;

/// Those of all volumes.
pub fn tables(gpu: &Gpu, volumes: &[VolumeData]) -> Tables {
    let longest = volumes.iter().map(|volume| volume.classified.table.entries.len()).max().unwrap_or(1);
    let width = longest.min(TABLE_ROW as usize);
    let (mut entries, mut distances, mut starts) = (Vec::new(), Vec::new(), Vec::new());
    for VolumeData { classified, .. } in volumes {
        starts.push([distances.len(), entries.len() / width].map(|start| start as u32));
        entries.extend_from_slice(&classified.table.entries);
        entries.resize(entries.len().next_multiple_of(width), Vec4::ZERO);
        distances.extend_from_slice(&classified.distances);
    }
    distances.resize(distances.len().next_multiple_of(BRICK_ROW as usize), 0);
    let entries_size = UVec2::new(width as u32, (entries.len() / width) as u32);
    let distances_size = UVec2::new(BRICK_ROW, (distances.len() / BRICK_ROW as usize) as u32);
    let texels: &[u8] = bytemuck::cast_slice(&entries);
    Tables {
        entries: texture_of(gpu, "lookup tables", entries_size, FORMAT, texels),
        distances: texture_of(
            gpu,
            "brick distances",
            distances_size,
            wgpu::TextureFormat::R8Uint,
            &distances,
        ),
        starts,
        bytes: (texels.len() as u64, distances.len() as u64),
    }
}

/// One table alone, in rows of [`TABLE_ROW`].
pub(crate) fn table_texture(gpu: &Gpu, entries: &[Vec4]) -> wgpu::Texture {
    let width = entries.len().min(TABLE_ROW as usize);
    let mut rows = entries.to_vec();
    rows.resize(entries.len().next_multiple_of(width), Vec4::ZERO);
    let size = UVec2::new(width as u32, (rows.len() / width) as u32);
    texture_of(gpu, "lookup table", size, FORMAT, bytemuck::cast_slice(&rows))
}

pub fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}
