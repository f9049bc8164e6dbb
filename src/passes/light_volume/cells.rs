//! Into how many cells a volume is cut where the light in it is kept, and how far rays look towards lights for themselves.

use crate::gpu::Gpu;
use crate::loading::LoadedVolume;
use crate::passes::classify::Classified;
use crate::sources::Histogram;
use glam::{DAffine3, DVec3, UVec3};

/// Optical depth of a cell up to which what is interpolated in it is the light there.
const THIN: f64 = 0.5;

/// Optical depth of a cell in which there is anything to speak of.
const NOTICEABLE: f64 = 0.01;

/// The share of what there is in a volume that is dense from which on the volume is: rays that look for light themselves take up to twice as long.
const DENSE_SHARE: f64 = 0.25;

/// Cells that may be made of a volume to have none longer than they are wide: 64 MiB a light.
const MOST_CELLS: f64 = (1 << 24) as f64;

/// How much longer than its voxels are short a cell is made shorter, at most.
const MOST_SHORTER: f64 = 8.0;

/// Slices in front of a place that rays look through for themselves, in a dense medium.
const NEAR: (f64, f64) = (2.0, 4.0);

/// Optical depth of a slice, as dense as it is at a sample, from which on they do so for it; from twice that on altogether.
pub(crate) const LEAST_LOOKED: f64 = 0.1;

/// Samples in each of them.
pub(crate) const NEAR_SAMPLES: u64 = 4;

/// How the light in a volume is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cells {
    /// Cells along each axis.
    pub count: UVec3,
    /// Slices in front of a place in which rays look for themselves how much light comes through; 0 where cells are thin.
    pub near: u32,
    /// Whether cells take much of the light that comes into them.
    pub is_dense: bool,
    /// How many mean free paths the volume is long along each axis, where it is densest.
    pub free_paths: DVec3,
}

impl Cells {
    /// Of a volume at a `resolution` in nodes a voxel.
    ///
    /// In a dense medium light changes within a cell by much more than can be interpolated. Long cells, of thick slices, are cut until they are as short as they
    /// are wide; of light that has yet to come through the cells next to a place, rays find out for themselves. Layers without width are too
    /// thin for samples: volumes that have any keep to what is interpolated.
    pub fn of(
        gpu: &Gpu,
        (loaded, classified): (&LoadedVolume, &Classified),
        resolution: f32,
        scene_from_texture: DAffine3,
    ) -> Self {
        let voxels = DVec3::from(loaded.data.size.map(f64::from));
        let wanted = (voxels * f64::from(resolution)).max(DVec3::ONE);
        let axes = scene_from_texture.matrix3;
        let extent = DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length());
        let edges = extent / wanted;
        let free_paths = extent * classified.greatest_extinction();
        let is_dense = dense_share(&loaded.data.histogram, classified, edges.max_element()) > DENSE_SHARE;
        let wanted = if is_dense { evened_out(wanted, edges) } else { wanted };
        let edges = extent / wanted;
        let near = (edges.max_element() / edges.min_element()).ceil().clamp(NEAR.0, NEAR.1) as u32;
        let has_layers = !classified.table.layers.is_empty();
        // Columns beside the volume and the last slice take part of the texture.
        let limit = f64::from(gpu.device.limits().max_texture_dimension_3d - 8);
        Self {
            // Whatever rounding makes of a rotation.
            count: (wanted - 1e-3).ceil().clamp(DVec3::ONE, DVec3::splat(limit)).as_uvec3(),
            near: if is_dense && !has_layers { near } else { 0 },
            is_dense,
            free_paths,
        }
    }
}

/// Of the voxels in which there is anything, the share of those that take more from light than `THIN` over the edge of a cell.
fn dense_share(histogram: &Histogram, classified: &Classified, edge: f64) -> f64 {
    let (mut all, mut dense) = (0, 0);
    for (bin, &voxels) in histogram.bins.iter().enumerate().filter(|(_, voxels)| **voxels > 0) {
        let depth = edge * classified.extinction_of(histogram.centre(bin));
        all += if depth > NOTICEABLE { voxels } else { 0 };
        dense += if depth > THIN { voxels } else { 0 };
    }
    dense as f64 / all.max(1) as f64
}

/// So many cells with these edges, and more along the axes where they are long.
fn evened_out(cells: DVec3, edges: DVec3) -> DVec3 {
    let of_length = |length: f64| cells * (edges / length).clamp(DVec3::ONE, DVec3::splat(MOST_SHORTER));
    let mut length = edges.min_element();
    while of_length(length).element_product() > MOST_CELLS && length < edges.max_element() {
        length *= 1.1;
    }
    of_length(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_cells_are_cut_as_far_as_there_is_room() {
        let cut = |cells: [f64; 3], edges: [f64; 3]| evened_out(cells.into(), edges.into());
        assert_eq!(cut([60.0, 60.0, 12.0], [1.0, 1.0, 5.0]), DVec3::new(60.0, 60.0, 60.0));
        assert_eq!(cut([30.0; 3], [2.0; 3]), DVec3::splat(30.0));
        assert_eq!(cut([10.0, 10.0, 2.0], [1.0, 2.0, 100.0]), DVec3::new(10.0, 20.0, 16.0));
        // Those of a large volume stay long.
        let large = cut([512.0, 512.0, 60.0], [0.7, 0.7, 5.0]);
        assert!(large.x == 512.0 && large.element_product() <= MOST_CELLS && large.z > 60.0, "{large}");
        assert_eq!(cut([1024.0; 3], [1.0, 1.0, 5.0]), DVec3::splat(1024.0));
    }
}
