//! The directions that stand for all in what escapes from a volume.

use crate::mirrors::mirror;
use glam::{DVec2, DVec3, UVec3, Vec2, Vec3};

/// Cosines of each direction with the axes, in every order and with every sign: 24 directions of one weight, none of which lies in the plane
/// of a face. As in level-symmetric quadrature (Carlson and Lathrop 1965) the mean of their squares is 1/3; and that of their amounts is 1/2, so
/// that as much light leaves through a face as should.
const COSINES: [f64; 2] = [0.295_875_854_768_068, 0.908_248_290_463_863];

/// All of them.
const COUNT: f32 = 24.0;

/// By how much more is taken to escape than they say: what they may be off by, so that nothing returns more than it receives.
const SAFETY: f32 = 1.015;

/// Four directions that differ in the signs of what they have across an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fan {
    /// The axis that they follow most closely, counted in cells.
    pub axis: usize,
    /// Whether they go up it.
    upwards: bool,
    /// Amounts across the axis, its next two in turn, and along it.
    cosines: DVec3,
    /// Cells across from slice to slice.
    slope: DVec2,
    /// Way through a slice.
    way: f64,
}

impl Fan {
    /// All of them, for cells with these edges.
    pub fn all(edges: DVec3) -> [Self; 6] {
        let [small, large] = COSINES;
        std::array::from_fn(|index| {
            let mut amounts = DVec3::splat(small);
            amounts[index / 2] = large;
            let in_cells = amounts / edges;
            let axis = in_cells.max_position();
            let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
            Self {
                axis,
                upwards: index % 2 == 1,
                cosines: DVec3::new(amounts[b], amounts[c], amounts[axis]),
                slope: DVec2::new(in_cells[b], in_cells[c]) / in_cells[axis],
                way: edges[axis] / amounts[axis],
            }
        })
    }

    /// What the shader knows of it on its way through a slice.
    pub fn uniform(&self, slice: u32, aside: f32) -> FanUniform {
        FanUniform {
            cosines: self.cosines.as_vec3(),
            axis: self.axis as u32,
            upwards: u32::from(self.upwards),
            slice,
            slope: self.slope.as_vec2(),
            way: self.way as f32,
            share: SAFETY / COUNT,
            aside,
        }
    }

    /// Cells of a slice.
    pub fn columns(&self, cells: UVec3) -> u32 {
        cells[(self.axis + 1) % 3] * cells[(self.axis + 2) % 3]
    }
}

mirror! {
    /// Mirror of `Fan` in `shaders/light_escape.wgsl`.
    "light_escape":
    pub(crate) struct FanUniform as "Fan" {
        cosines: Vec3,
        axis: u32,
        upwards: u32,
        slice: u32,
        slope: Vec2,
        way: f32,
        share: f32,
        aside: f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_stand_for_all() {
        for edges in [DVec3::ONE, DVec3::new(1.0, 2.0, 0.5), DVec3::new(1.0, 1e3, 1.0)] {
            let all = Fan::all(edges);
            let mut first = DVec3::ZERO;
            let mut second = DVec3::ZERO;
            for fan in all {
                let mut amounts = DVec3::ZERO;
                for (index, axis) in
                    [(fan.axis + 1) % 3, (fan.axis + 2) % 3, fan.axis].into_iter().enumerate()
                {
                    amounts[axis] = fan.cosines[index];
                }
                assert!((amounts.length() - 1.0).abs() < 1e-12);
                assert!(fan.slope.max_element() <= 1.0 && fan.slope.min_element() > 0.0);
                first += amounts / 6.0;
                second += amounts * amounts / 6.0;
            }
            assert!((second - 1.0 / 3.0).abs().max_element() < 1e-12, "{second}");
            // Half of it is the flux through a face.
            assert!((first - 0.5).abs().max_element() < 1e-12, "{first}");
        }
    }
}
