//! Where the voxels of a volume lie in the world of the file that they come from.

use glam::{DAffine3, DMat3, DVec3, Vec3};

/// What the coordinates of a file mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Space {
    /// The file does not say where it lies.
    #[default]
    Unknown,
    /// A world of the file's own, in mm.
    World,
    /// A patient, in mm: +x is right, +y anterior, +z superior.
    Patient,
}

/// Place and direction of a volume's voxels in the world of its file, in mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The centre of voxel (0, 0, 0), mm.
    pub origin: DVec3,
    /// The directions of the volume's x, y and z, of unit length. Where layers are stacked at a slant, as under a tilted gantry,
    /// the one across them is not at right angles to the others, and longer: by it a voxel is as far as its spacing says.
    pub directions: [DVec3; 3],
    /// What the coordinates mean.
    pub space: Space,
}

impl Frame {
    /// Of a file that does not say where it lies: upright, and centred on the origin.
    pub fn centred(size: [u32; 3], spacing: Vec3) -> Self {
        let last = DVec3::from(size.map(|voxels| f64::from(voxels.saturating_sub(1))));
        let directions = [DVec3::X, DVec3::Y, DVec3::Z];
        Self { origin: last * spacing.as_dvec3() * -0.5, directions, space: Space::Unknown }
    }

    /// The greatest angle between an axis of the volume and the same axis of the world, in degrees.
    pub fn degrees_off(&self) -> f64 {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let angle = |(axis, direction): (DVec3, DVec3)| {
            axis.cross(direction).length().atan2(axis.dot(direction)).to_degrees()
        };
        axes.into_iter().zip(self.directions).map(angle).fold(0.0, f64::max)
    }

    /// The place in the world of the file, mm, of a place measured in mm along the volume's axes from the middle of its box.
    pub fn world_from_box(&self, size: [u32; 3], spacing: Vec3) -> DAffine3 {
        let last = DVec3::from(size.map(|voxels| f64::from(voxels.saturating_sub(1))));
        let [x, y, z] = self.directions;
        let axes = DMat3::from_cols(x, y, z);
        DAffine3 { matrix3: axes, translation: self.origin + axes * (last * spacing.as_dvec3() * 0.5) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_voxel_lies_at_the_origin() {
        let (size, spacing) = ([3, 5, 1], Vec3::new(2.0, 1.0, 7.0));
        let first = DVec3::new(-2.0, -2.0, 0.0);
        let centred = Frame::centred(size, spacing);
        assert_eq!(centred.world_from_box(size, spacing), DAffine3::IDENTITY);
        let turned = Frame {
            origin: DVec3::new(10.0, 20.0, 30.0),
            directions: [DVec3::Y, DVec3::NEG_X, DVec3::Z],
            space: Space::Patient,
        };
        let world = turned.world_from_box(size, spacing);
        assert_eq!(world.transform_point3(first), turned.origin);
        assert_eq!(world.transform_point3(first + DVec3::X * 2.0), turned.origin + DVec3::Y * 2.0);
    }
}
