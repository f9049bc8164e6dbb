//! How light is swept through the cells of a volume, slice by slice along one of its axes: see `shaders/shared/cells.wgsl`.

use crate::components::{Auto, VolumeLighting};
use crate::mirrors::mirror;
use encase::ShaderSize;
use glam::{DAffine3, DVec3, UVec3, Vec2, Vec3};

/// Mean cosine with the axis of the light that goes on.
const MEAN_COSINE: f64 = 0.45;

/// One axis of the sweeps towards the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisSweep {
    cells: UVec3,
    axis: usize,
    forwards: bool,
    /// Lengths of a cell, scene units.
    lengths: DVec3,
    mu0: f64,
    g: f32,
    /// How much light leans to each axis.
    shares: DVec3,
    /// The width of the cone, as a multiple of what light does.
    width: f64,
}

mirror! {
    /// Mirror of `ScatterSweep` in `shaders/shared/cells.wgsl`.
    "eye_light":
    pub(crate) struct ScatterSweepUniform as "ScatterSweep" {
        cells: UVec3,
        axis: u32,
        shares: Vec3,
        along: f32,
        across: Vec2,
        mu0: f32,
        g: f32,
        forwards: u32,
        spread: f32,
    }
}

mirror! {
    /// Mirror of `Slice` in `shaders/shared/cells.wgsl`.
    "eye_light":
    pub(crate) struct SliceUniform as "Slice" {
        index: u32,
    }
}

/// An axis that would count for less is not swept, and all others count for less by as much, so that it sets in from nothing.
const LEAST_WEIGHT: f64 = 0.002;

impl AxisSweep {
    /// The sweeps for light that travels in a direction, given in the texture's space.
    pub fn all(
        lighting: &VolumeLighting,
        cells: UVec3,
        direction: DVec3,
        scene_from_texture: DAffine3,
    ) -> Vec<Self> {
        let VolumeLighting::LightVolume { cone_angle, blend, g, .. } = *lighting else { return Vec::new() };
        let in_cells = direction * cells.as_dvec3();
        let nearest = in_cells.abs().max_position();
        let shares = match blend {
            true => (in_cells * in_cells / in_cells.length_squared() - LEAST_WEIGHT).max(DVec3::ZERO),
            false => DVec3::AXES[nearest],
        };
        let shares = shares / shares.element_sum();
        let axes = scene_from_texture.matrix3;
        let axes = [axes.x_axis, axes.y_axis, axes.z_axis];
        let light = scene_from_texture.transform_vector3(direction).normalize();
        let width = match cone_angle {
            Auto::Auto => 1.0,
            Auto::Value(angle) => f64::from(angle).to_radians().tan() / MEAN_COSINE.acos().tan(),
        };
        let sweep = |axis: usize| Self {
            cells,
            axis,
            forwards: direction[axis] >= 0.0,
            lengths: DVec3::from_array([0, 1, 2].map(|axis| axes[axis].length() / f64::from(cells[axis]))),
            mu0: light.dot(axes[axis].normalize()).abs(),
            g,
            shares,
            width,
        };
        (0..3).filter(|axis| shares[*axis] > 0.0).map(sweep).collect()
    }

    /// Cells across and along.
    fn extent(&self) -> UVec3 {
        let [b, c] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        UVec3::new(self.cells[b], self.cells[c], self.cells[self.axis])
    }

    /// Columns of cells along the axis.
    pub fn columns(&self) -> u32 {
        let extent = self.extent();
        extent.x * extent.y
    }

    /// Slices across it.
    pub fn slices(&self) -> u32 {
        self.extent().z
    }

    /// Cells across that a direction, given in the texture's space, moves from slice to slice.
    pub fn slope(&self, direction: DVec3) -> glam::DVec2 {
        let in_cells = direction * self.cells.as_dvec3();
        let [b, c] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        glam::DVec2::new(in_cells[b], in_cells[c]) / in_cells[self.axis].abs()
    }

    pub fn uniform(&self) -> ScatterSweepUniform {
        let [b, c] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        ScatterSweepUniform {
            cells: self.cells,
            axis: self.axis as u32,
            shares: self.shares.as_vec3(),
            across: glam::DVec2::new(self.lengths[b], self.lengths[c]).as_vec2(),
            along: self.lengths[self.axis] as f32,
            mu0: self.mu0 as f32,
            g: self.g,
            forwards: u32::from(self.forwards),
            spread: (2.0 / (3.0 * MEAN_COSINE) * self.width * self.width) as f32,
        }
    }
}

/// One of the structs of a buffer of slices.
pub(crate) fn slice_binding(slices: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    let size = std::num::NonZeroU64::new(SliceUniform::SHADER_SIZE.get());
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: slices, offset: 0, size })
}
