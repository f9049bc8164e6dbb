//! Where the voxels of a NIfTI file lie.

use glam::{DMat3, DQuat, DVec3};

use super::header::Header;
use crate::sources::{
    SourceError,
    grid::Grid,
    shape::{Role, Side},
    volume::Space,
};

/// The square of a quaternion's first number below which it is 0.
const HALF_A_TURN: f64 = 1e-7;

/// From one voxel to the next along each axis, and the centre of the first, mm; right, anterior, superior.
#[derive(Debug, Clone, Copy)]
struct Affine {
    axes: [DVec3; 3],
    origin: DVec3,
}

impl Affine {
    fn is_usable(&self) -> bool {
        self.origin.is_finite() && self.axes.iter().all(|axis| axis.is_finite() && axis.length() > 0.0)
    }
}

impl Header<'_> {
    /// The grid of voxels of `bytes` bytes: by the sform, else the qform, else by the sizes of voxels alone, which do not say where
    /// they lie.
    pub fn grid(&self, sides: &[Side], bytes: u64, notes: &mut Vec<String>) -> Result<Grid, SourceError> {
        let size: Vec<u64> =
            sides.iter().filter(|side| side.role == Role::Space).map(|side| side.samples).collect();
        let written = [self.sform(), self.qform()];
        if let Some(affine) = written.iter().flatten().find(|affine| affine.is_usable()) {
            let millimetres = self.millimetres();
            let axes = affine.axes.map(|axis| axis * millimetres);
            let grid = Grid::new(self.path, &size, &axes, true, bytes)?;
            return grid.at(self.path, affine.origin * millimetres, Space::Patient);
        }
        if written.iter().any(Option::is_some) {
            notes.push("its sform and qform cannot be; only the sizes of its voxels are used".to_owned());
        }
        let units = [DVec3::X, DVec3::Y, DVec3::Z];
        let lengths = self.lengths();
        let axes = [0, 1, 2].map(|axis| units[axis] * lengths[axis] * self.millimetres());
        Grid::new(self.path, &size, &axes, false, bytes)
    }

    fn millimetres(&self) -> f64 {
        match self.field::<1>(if self.is_2 { 500 + self.last_byte() } else { 123 })[0] & 7 {
            1 => 1e3,
            3 => 1e-3,
            _ => 1.0,
        }
    }

    fn pixdim(&self, index: usize) -> f64 {
        self.float(76, 104, index)
    }

    /// Lengths of a voxel in the unit of the file.
    fn lengths(&self) -> [f64; 3] {
        [1, 2, 3].map(|index| match self.pixdim(index).abs() {
            0.0 => 1.0,
            length => length,
        })
    }

    fn sform(&self) -> Option<Affine> {
        let code = if self.is_2 { self.i32(348) } else { self.i16(254) };
        let column = |column: usize| {
            let at = |row: usize| self.float(280, 400, 4 * row + column);
            DVec3::new(at(0), at(1), at(2))
        };
        (code > 0).then(|| Affine { axes: [column(0), column(1), column(2)], origin: column(3) })
    }

    fn qform(&self) -> Option<Affine> {
        let code = if self.is_2 { self.i32(344) } else { self.i16(252) };
        if code <= 0 {
            return None;
        }
        let [b, c, d] = [0, 1, 2].map(|index| self.float(256, 352, index));
        // What is written in 32 bits says no more of half a turn: as the format's own library has it.
        let squared = 1.0 - (b * b + c * c + d * d);
        let a = if squared < HALF_A_TURN { 0.0 } else { squared.sqrt() };
        let turn = DMat3::from_quat(DQuat::from_xyzw(b, c, d, a).normalize());
        let z_sign = if self.pixdim(0) < 0.0 { -1.0 } else { 1.0 };
        let lengths = self.lengths();
        let axes = [turn.x_axis * lengths[0], turn.y_axis * lengths[1], turn.z_axis * lengths[2] * z_sign];
        let origin = [0, 1, 2].map(|index| self.float(268, 376, index));
        Some(Affine { axes, origin: DVec3::from(origin) })
    }
}
