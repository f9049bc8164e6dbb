//! Where the columns of a light volume stand.
//!
//! Slices cut the volume across the axis that the light follows most closely, counted in cells: slice 0 is the face at which light
//! enters. Columns follow the light itself. A column passes from slice to slice by at most one cell across, so what it carries is never
//! interpolated on the way: the edge of a shadow is as sharp behind a hundred slices as behind one. Each slice holds just the columns that
//! cross it, and [`MARGIN`] more; which column a texel belongs to follows by counting modulo the width, and the sampler repeats.

use crate::mirrors::mirror;
use glam::{DAffine3, DMat3, DMat4, DVec2, DVec3, Mat4, UVec3, Vec3};

/// Columns beside those that cross a slice: three on one side and four on the other can take part in interpolation.
const MARGIN: u32 = 7;

/// The columns of a volume in one light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sweep {
    /// Cells along each axis of the volume.
    cells: UVec3,
    /// The axis across which slices lie.
    axis: usize,
    /// Cells that the light travels along each axis of the volume from slice to slice; along `axis` plus or minus 1.
    travel: DVec3,
}

impl Sweep {
    /// Columns along a direction of travel, given in the texture's space (0 to 1 along each axis).
    pub fn new(cells: UVec3, direction: DVec3) -> Self {
        let in_cells = direction * cells.as_dvec3();
        let axis = in_cells.abs().max_position();
        Self { cells, axis, travel: in_cells / in_cells.abs()[axis] }
    }

    /// The axes across: the first and second of the texture that holds the columns; its third is the sweep's axis.
    fn across(&self) -> [usize; 2] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3]
    }

    /// Texels: columns across, and slices.
    pub fn size(&self) -> UVec3 {
        let [b, c] = self.across();
        UVec3::new(self.cells[b] + MARGIN, self.cells[c] + MARGIN, self.cells[self.axis] + 1)
    }

    /// How far light travels from slice to slice, in the texture's space.
    pub fn step(&self) -> DVec3 {
        self.travel / self.cells.as_dvec3()
    }

    /// Cells that a column moves across from slice to slice.
    fn slope(&self) -> DVec2 {
        let [b, c] = self.across();
        DVec2::new(self.travel[b], self.travel[c])
    }

    /// Takes (across, across, slice), in cells from the corner of the volume, to the texture of the volume.
    fn texture_from_cells(&self) -> DAffine3 {
        let [b, c] = self.across();
        let forwards = self.travel[self.axis] > 0.0;
        let mut columns = [DVec3::ZERO; 3];
        columns[0][b] = 1.0 / f64::from(self.cells[b]);
        columns[1][c] = 1.0 / f64::from(self.cells[c]);
        let sign = if forwards { 1.0 } else { -1.0 };
        columns[2][self.axis] = sign / f64::from(self.cells[self.axis]);
        let origin = if forwards { DVec3::ZERO } else { DVec3::AXES[self.axis] };
        DAffine3::from_mat3_translation(DMat3::from_cols(columns[0], columns[1], columns[2]), origin)
    }

    /// Takes the texture of the volume to the texture of the columns; its first two coordinates count modulo 1.
    fn texel_from_texture(&self) -> DAffine3 {
        let slope = self.slope();
        let columns_from_cells =
            DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(-slope.x, -slope.y, 1.0)));
        let texel_from_columns =
            DAffine3::from_scale(self.size().as_dvec3().recip()) * DAffine3::from_translation(DVec3::Z * 0.5);
        texel_from_columns * columns_from_cells * self.texture_from_cells().inverse()
    }

    /// The way back towards the light inside the volume, in slices, is the least of place * scale + offset over the axes.
    fn reach(&self) -> (DVec3, DVec3) {
        let slices = self.cells.as_dvec3() / self.travel.abs().max(DVec3::splat(1e-12));
        let forwards = self.travel.cmpge(DVec3::ZERO);
        (DVec3::select(forwards, slices, -slices), DVec3::select(forwards, DVec3::ZERO, slices))
    }

    /// What a shader needs to look the columns up, where slices are so many scene units apart along the light.
    pub fn lookup(&self, slice: f64) -> SweepUniform {
        let (scale, offset) = self.reach();
        SweepUniform {
            texel_from_texture: DMat4::from(self.texel_from_texture()).as_mat4(),
            reach_scale: scale.as_vec3(),
            reach_offset: offset.as_vec3(),
            size: self.size().as_vec3(),
            step: self.step().as_vec3(),
            slice: slice as f32,
        }
    }

    /// What the kernel needs to know of where columns are.
    pub fn columns(&self) -> ColumnsUniform {
        let [b, c] = self.across();
        ColumnsUniform {
            texture_from_cells: DMat4::from(self.texture_from_cells()).as_mat4(),
            slope: self.slope().as_vec2(),
            cells: glam::UVec2::new(self.cells[b], self.cells[c]).as_vec2(),
            size: self.size(),
        }
    }
}

mirror! {
    /// Mirror of `Sweep` in `shaders/shared/sweep.wgsl`.
    "raycast":
    pub(crate) struct SweepUniform as "Sweep" {
        texel_from_texture: Mat4,
        reach_scale: Vec3,
        reach_offset: Vec3,
        size: Vec3,
        step: Vec3,
        slice: f32,
    }
}

mirror! {
    /// Mirror of `Columns` in `shaders/light_volume.wgsl`.
    "light_volume":
    pub(crate) struct ColumnsUniform as "Columns" {
        texture_from_cells: Mat4,
        slope: glam::Vec2,
        cells: glam::Vec2,
        size: UVec3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_one_texel_in_every_slice_that_it_crosses() {
        for direction in
            [DVec3::new(0.3, -0.2, 0.9), DVec3::new(-1.0, 0.7, 0.69), DVec3::new(0.1, 1.0, -0.99)]
        {
            let sweep = Sweep::new(UVec3::new(20, 30, 12), direction.normalize());
            let start = DVec3::new(0.4, 0.6, 0.55);
            let texel = |slices: f64| {
                let at = sweep.texel_from_texture().transform_point3(start + sweep.step() * slices);
                (at * sweep.size().as_dvec3()).truncate()
            };
            assert!(texel(3.0).distance(texel(-2.0)) < 1e-9);
        }
    }

    #[test]
    fn the_way_back_ends_where_the_light_enters() {
        let sweep = Sweep::new(UVec3::new(20, 30, 12), DVec3::new(-0.5, 0.3, 0.8).normalize());
        let (scale, offset) = sweep.reach();
        for place in [DVec3::new(0.2, 0.9, 0.5), DVec3::new(0.99, 0.1, 0.9), DVec3::new(0.5, 0.01, 0.3)] {
            let slices = (place * scale + offset).min_element();
            let entry = place - sweep.step() * slices;
            let beyond = entry.max(DVec3::ONE - entry).max_element() - 1.0;
            assert!(beyond.abs() < 1e-9, "{entry}");
        }
    }

    #[test]
    fn columns_move_by_no_more_than_a_cell() {
        let sweep = Sweep::new(UVec3::new(2, 300, 12), DVec3::new(-0.5, 0.3, 0.8).normalize());
        assert!(sweep.slope().abs().max_element() <= 1.0);
        assert_eq!(sweep.axis, 1);
    }
}
