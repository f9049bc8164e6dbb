//! The levels of a network of cells: each has fewer cells than the one before, down to a single one.

use crate::mirrors::mirror;
use glam::{DVec3, UVec3, Vec3};

/// One level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LevelShape {
    /// Cells along each axis.
    pub cells: UVec3,
    /// How many along each axis make one of the coarser level: 1 or 2.
    pub factor: UVec3,
    /// Edges of a cell, in the unit of the network.
    pub edges: DVec3,
    /// The unit of the network, scene units.
    pub unit: f64,
}

impl LevelShape {
    /// All levels of a grid of cells, the finest first. `edges` are those of a cell, in scene units; the unit is the shortest.
    ///
    /// Only axes along which cells are about as short as along any are coarsened: where cells are ten times as long one way as the
    /// other, light passes a hundred times as well the other way, and the cells that exchange most are to become one.
    pub fn all(cells: UVec3, edges: DVec3) -> Vec<Self> {
        let unit = edges.min_element();
        let mut shape = Self { cells, factor: UVec3::ONE, edges: edges / unit, unit };
        let mut levels = Vec::new();
        loop {
            shape.factor = shape.next_factor();
            levels.push(shape);
            if shape.cells == UVec3::ONE {
                return levels;
            }
            let edges = shape.edges * shape.factor.as_dvec3();
            shape = Self { cells: shape.coarser(), edges, ..shape };
        }
    }

    fn next_factor(&self) -> UVec3 {
        let shortest = (0..3).filter(|axis| self.cells[*axis] > 1).map(|axis| self.edges[axis]);
        let shortest = shortest.fold(f64::INFINITY, f64::min);
        let of = |axis: usize| 1 + u32::from(self.cells[axis] > 1 && self.edges[axis] < 1.5 * shortest);
        UVec3::new(of(0), of(1), of(2))
    }

    /// Cells of the coarser level.
    pub fn coarser(&self) -> UVec3 {
        UVec3::new(
            self.cells.x.div_ceil(self.factor.x),
            self.cells.y.div_ceil(self.factor.y),
            self.cells.z.div_ceil(self.factor.z),
        )
    }

    /// Number of cells.
    pub fn count(&self) -> u32 {
        self.cells.element_product()
    }

    /// What shaders know of it.
    pub fn uniform(&self) -> LevelUniform {
        LevelUniform {
            cells: self.cells,
            coarser: self.coarser(),
            factor: self.factor,
            edges: self.edges.as_vec3(),
            unit: self.unit as f32,
            is_top: u32::from(self.cells == UVec3::ONE),
        }
    }
}

mirror! {
    /// Mirror of `Level` in `shaders/shared/level.wgsl`.
    "diffusion":
    pub(crate) struct LevelUniform as "Level" {
        cells: UVec3,
        coarser: UVec3,
        factor: UVec3,
        edges: Vec3,
        unit: f32,
        is_top: u32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_end_in_one_cell_and_keep_the_extent() {
        for (cells, edges) in [
            (UVec3::new(64, 64, 64), DVec3::ONE),
            (UVec3::new(17, 1, 128), DVec3::new(0.1, 3.0, 0.1)),
            (UVec3::new(16, 16, 16), DVec3::new(1.0, 1.0, 1000.0)),
            (UVec3::ONE, DVec3::ONE),
        ] {
            let levels = LevelShape::all(cells, edges);
            assert_eq!(levels[0].cells, cells);
            assert_eq!(levels[levels.len() - 1].cells, UVec3::ONE);
            assert!(levels.len() <= 25, "{} levels", levels.len());
            for pair in levels.windows(2) {
                assert!(pair[1].count() < pair[0].count());
                assert_eq!(pair[0].coarser(), pair[1].cells);
                let extent = |level: &LevelShape| level.edges * level.cells.as_dvec3();
                assert!(extent(&pair[1]).cmpge(extent(&pair[0]) - 1e-9).all());
            }
        }
    }

    #[test]
    fn long_cells_are_halved_across_first() {
        let levels = LevelShape::all(UVec3::splat(16), DVec3::new(1.0, 1.0, 8.0));
        assert_eq!(levels[0].factor, UVec3::new(2, 2, 1));
        assert_eq!(levels[3].factor, UVec3::splat(2));
    }
}
