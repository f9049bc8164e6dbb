//! Where the samples of a file lie in space, and how they are turned so that x, y and z run along the scene's axes.
//!
//! A file that says how its axes lie in a patient is turned so that +x points right, +y anterior and +z superior, whichever
//! way its format counts; any other so that its axes run along its own world's +x, +y and +z. Only whole axes are exchanged
//! and reversed: no sample is interpolated. What is left of a rotation is in the volume's [`Frame`].

use std::path::Path;

use glam::{DVec3, Vec3};

use super::{
    LayoutError, SourceError,
    stored::{Scaling, Stored},
    volume::{Frame, MAX_VOLUME_BYTES, Samples, Space, VolumeData, check_spacing, checked_bytes},
};

/// Directions whose volume, at unit length, is less than this span no space.
const FLAT: f64 = 1e-3;

/// The size of a volume and the direction and length of its voxels, checked.
#[derive(Debug, Clone)]
pub(super) struct Grid {
    /// Voxels along the axes of the file, the fastest first.
    pub size: [u32; 3],
    /// From one voxel to the next along each, in mm, in the world of the file.
    axes: [DVec3; 3],
    /// Whether that world is right, anterior, superior.
    anatomical: bool,
    /// The centre of the first voxel of the file, mm, and what that means; where the file says so.
    place: Option<(DVec3, Space)>,
    /// From one voxel to the next along the third axis, where that leans over against how it is drawn.
    leaning: Option<DVec3>,
}

impl Grid {
    /// A grid of samples of `bytes` bytes; missing axes get one voxel of 1 mm.
    ///
    /// # Errors
    ///
    /// If no volume can have this size, or the directions are not finite, vanish or lie in a plane.
    pub fn new(
        path: &Path,
        size: &[u64],
        axes: &[DVec3],
        anatomical: bool,
        bytes: u64,
    ) -> Result<Self, SourceError> {
        let layout = |problem| SourceError::Layout { path: path.to_owned(), problem };
        let side = |axis: usize| u32::try_from(size.get(axis).copied().unwrap_or(1)).unwrap_or(u32::MAX);
        let size = [side(0), side(1), side(2)];
        if size.contains(&u32::MAX) {
            return Err(layout(LayoutError::TooLarge {
                size,
                bytes_per_voxel: bytes,
                limit: MAX_VOLUME_BYTES,
            }));
        }
        let given = |axis: usize| axes.get(axis).map_or(1.0, |axis| axis.length());
        let spacing = DVec3::new(given(0), given(1), given(2)).as_vec3();
        check_spacing(spacing).map_err(layout)?;
        checked_bytes(size, bytes).map_err(layout)?;
        let grid = Self { size, axes: completed(axes), anatomical, place: None, leaning: None };
        let [x, y, z] = grid.axes.map(DVec3::normalize);
        let spanned = x.cross(y).dot(z).abs();
        if spanned.is_nan() || spanned <= FLAT {
            return Err(SourceError::Field {
                path: path.to_owned(),
                field: "directions of the axes".to_owned(),
                problem: format!("{x}, {y} and {z} lie in a plane; correct the header"),
            });
        }
        Ok(grid)
    }

    /// The same with the centre of the first voxel of the file at `origin`, mm. Without this call the file does not say where it lies.
    ///
    /// # Errors
    ///
    /// If the origin is not finite.
    pub fn at(self, path: &Path, origin: DVec3, space: Space) -> Result<Self, SourceError> {
        if origin.is_finite() {
            return Ok(Self { place: Some((origin, space)), ..self });
        }
        Err(SourceError::Field {
            path: path.to_owned(),
            field: "origin".to_owned(),
            problem: format!("{origin} is not finite; correct the header"),
        })
    }

    /// The same with layers that are stacked at a slant: upright where they are drawn by themselves, but `step` apart, mm, in
    /// the world of the file.
    pub fn leaning(self, step: DVec3) -> Self {
        Self { leaning: Some(step), ..self }
    }

    /// How many samples there are.
    pub fn samples(&self) -> u64 {
        self.size.iter().map(|&side| u64::from(side)).product()
    }

    /// `64 x 64 x 64 voxels of 2 bytes`, for errors.
    pub fn what(&self, bytes: u64) -> String {
        let [x, y, z] = self.size;
        format!("{x} x {y} x {z} voxels of {bytes} byte{}", if bytes == 1 { "" } else { "s" })
    }

    /// The volume of these samples, turned.
    pub fn volume(
        &self,
        path: &Path,
        stored: Stored,
        scaling: &Scaling,
        mut notes: Vec<String>,
    ) -> Result<VolumeData, SourceError> {
        let samples = stored.into_samples(path, scaling, &mut notes)?;
        self.volume_of(path, samples, notes)
    }

    /// The volume of samples of a type that is drawn, turned.
    pub fn volume_of(
        &self,
        path: &Path,
        samples: Samples,
        mut notes: Vec<String>,
    ) -> Result<VolumeData, SourceError> {
        let turn = Turn::nearest(self.axes);
        let samples = if turn.is_none() { samples } else { turn.samples(path, &samples, self.size)? };
        notes.extend(self.notes(&turn));
        let lengths = self.axes.map(DVec3::length);
        let size = turn.from.map(|axis| self.size[axis]);
        let spacing = Vec3::from(turn.from.map(|axis| lengths[axis] as f32));
        let layout = |problem: LayoutError| SourceError::Layout { path: path.to_owned(), problem };
        let mut volume = VolumeData::new(size, spacing, samples).map_err(layout)?;
        let (origin, space) = self.place.unwrap_or((DVec3::ZERO, Space::Unknown));
        volume.frame = self.frame(&turn, origin, space);
        volume.notes = notes;
        Ok(volume)
    }

    /// Where the turned volume lies.
    fn frame(&self, turn: &Turn, origin: DVec3, space: Space) -> Frame {
        let mut frame = Frame { origin, directions: [DVec3::ZERO; 3], space };
        for (world, &axis) in turn.from.iter().enumerate() {
            let step = self.leaning.filter(|_| axis == 2).unwrap_or(self.axes[axis]);
            let along = step / self.axes[axis].length();
            frame.directions[world] = if turn.reversed[world] { -along } else { along };
            if turn.reversed[world] {
                frame.origin += step * f64::from(self.size[axis] - 1);
            }
        }
        frame
    }

    fn notes(&self, turn: &Turn) -> Vec<String> {
        const ANATOMY: [[&str; 2]; 3] =
            [["right", "left"], ["anterior", "posterior"], ["superior", "inferior"]];
        const WORLD: [[&str; 2]; 3] = [["+x", "-x"], ["+y", "-y"], ["+z", "-z"]];
        let names = if self.anatomical { ANATOMY } else { WORLD };
        let mut notes = Vec::new();
        if !turn.is_none() {
            // Which way each axis of the file points.
            let mut points = [""; 3];
            for (world, &axis) in turn.from.iter().enumerate() {
                points[axis] = names[world][usize::from(turn.reversed[world])];
            }
            let [[x, _], [y, _], [z, _]] = names;
            notes.push(format!(
                "its axes point {}; they are turned so that x points {x}, y {y} and z {z}",
                points.join(", ")
            ));
        }
        notes
    }
}

/// Three axes of which the first ones are given.
fn completed(given: &[DVec3]) -> [DVec3; 3] {
    let pointing_up = |axis: DVec3| {
        let longest = axis.abs().max_position();
        if axis[longest] < 0.0 { -axis } else { axis }
    };
    let x = given.first().copied().unwrap_or(DVec3::X);
    let across = [DVec3::Y, DVec3::Z, DVec3::X][x.abs().max_position()];
    let y =
        given.get(1).copied().unwrap_or_else(|| pointing_up(across.reject_from(x).normalize_or(DVec3::Y)));
    let z = given.get(2).copied().unwrap_or_else(|| pointing_up(x.cross(y).normalize_or(DVec3::Z)));
    [x, y, z]
}

/// Axes exchanged and reversed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Turn {
    /// The axis of the file that becomes x, y and z.
    from: [usize; 3],
    /// Whether it is reversed on the way.
    reversed: [bool; 3],
}

impl Turn {
    /// The turn after which the axes are nearest to the world's.
    fn nearest(axes: [DVec3; 3]) -> Self {
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let units = axes.map(DVec3::normalize);
        let along = |from: &[usize; 3]| (0..3).map(|world| units[from[world]][world].abs()).sum::<f64>();
        // The first of equals: an axis halfway between two stays where it is.
        let from = ORDERS
            .into_iter()
            .fold(ORDERS[0], |best, order| if along(&order) > along(&best) + 1e-9 { order } else { best });
        Self { from, reversed: [0, 1, 2].map(|world| units[from[world]][world] < 0.0) }
    }

    fn is_none(&self) -> bool {
        self.from == [0, 1, 2] && self.reversed == [false; 3]
    }

    fn samples(&self, path: &Path, samples: &Samples, size: [u32; 3]) -> Result<Samples, SourceError> {
        Ok(match samples {
            Samples::U8(samples) => Samples::U8(self.turned(path, samples, size)?),
            Samples::I8(samples) => Samples::I8(self.turned(path, samples, size)?),
            Samples::U16(samples) => Samples::U16(self.turned(path, samples, size)?),
            Samples::I16(samples) => Samples::I16(self.turned(path, samples, size)?),
            Samples::F32(samples) => Samples::F32(self.turned(path, samples, size)?),
            Samples::Rgba8(samples) => Samples::Rgba8(self.turned(path, samples, size)?),
        })
    }

    fn turned<T: Copy>(&self, path: &Path, samples: &[T], size: [u32; 3]) -> Result<Vec<T>, SourceError> {
        let sides = size.map(|side| side as usize);
        let strides = [1, sides[0], sides[0] * sides[1]];
        let mut turned = Vec::new();
        turned.try_reserve_exact(samples.len()).map_err(|_| SourceError::OutOfMemory {
            path: path.to_owned(),
            bytes: size_of_val(samples) as u64,
        })?;
        let steps = |world: usize| {
            let (side, stride) = (sides[self.from[world]], strides[self.from[world]]);
            let reversed = self.reversed[world];
            (0..side).map(move |step| stride * if reversed { side - 1 - step } else { step })
        };
        for z in steps(2) {
            for y in steps(1) {
                turned.extend(steps(0).map(|x| samples[x + y + z]));
            }
        }
        Ok(turned)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn turned(axes: [DVec3; 3], anatomical: bool) -> VolumeData {
        let path = Path::new("a");
        let grid = Grid::new(path, &[2, 3, 4], &axes, anatomical, 1).unwrap();
        grid.volume(path, Stored::U8((0..24).collect()), &Scaling::NONE, Vec::new()).unwrap()
    }

    #[test]
    fn axes_are_exchanged_and_reversed_without_touching_a_sample() {
        let same = turned([DVec3::X * 2.0, DVec3::Y, DVec3::Z * 3.0], false);
        assert_eq!((same.size, same.spacing, same.notes.len()), ([2, 3, 4], Vec3::new(2.0, 1.0, 3.0), 0));
        let left = turned([DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z], true);
        assert_eq!(left.sample([0, 0, 0]), Some(5.0));
        assert_eq!(
            left.notes,
            [
                "its axes point left, posterior, superior; they are turned so that x points right, y anterior and z superior"
            ]
        );
        // The file's axes are z, -x and y.
        let turned = turned([DVec3::Z * 2.0, DVec3::NEG_X * 3.0, DVec3::Y * 4.0], false);
        assert_eq!((turned.size, turned.spacing), ([3, 4, 2], Vec3::new(3.0, 4.0, 2.0)));
        // Voxel (x, y, z) of the world is (z, 2 - x, y) of the file.
        assert_eq!(turned.sample([0, 3, 1]), Some(f32::from(1_u8 + 2 * 2 + 6 * 3)));
        assert!(turned.notes[0].starts_with("its axes point +z, -x, +y;"), "{:?}", turned.notes);
    }

    #[test]
    fn voxels_stay_where_the_file_has_them() {
        let path = Path::new("a");
        let axes = [DVec3::Z * 2.0, DVec3::new(-3.0, 0.3, 0.0), DVec3::new(0.4, 4.0, 0.0)];
        let grid = Grid::new(path, &[2, 3, 4], &axes, true, 1).unwrap();
        let grid = grid.at(path, DVec3::new(5.0, 6.0, 7.0), Space::Patient).unwrap();
        let volume = grid.volume(path, Stored::U8((0..24).collect()), &Scaling::NONE, Vec::new()).unwrap();
        let spacing = volume.spacing.as_dvec3();
        let [x, y, z] = volume.frame.directions;
        for file in [[0, 0, 0], [1, 2, 0], [1, 0, 3], [0, 1, 2]] {
            let in_file = DVec3::new(5.0, 6.0, 7.0)
                + (0..3).map(|axis| axes[axis] * f64::from(file[axis])).sum::<DVec3>();
            // Voxel (x, y, z) of the volume is (z, 2 - x, y) of the file.
            let kept = [2 - file[1], file[2], file[0]];
            let value = file[0] + 2 * file[1] + 6 * file[2];
            assert_eq!(volume.sample(kept), Some(value as f32));
            let placed = volume.frame.origin
                + x * spacing.x * f64::from(kept[0])
                + y * spacing.y * f64::from(kept[1])
                + z * spacing.z * f64::from(kept[2]);
            assert!(placed.distance(in_file) < 1e-5, "{placed} for {in_file}");
        }
        assert!(Grid::new(path, &[1], &[], false, 1).unwrap().at(path, DVec3::NAN, Space::World).is_err());
    }

    #[test]
    fn a_rotation_is_told_and_impossible_axes_are_refused() {
        let tilted = turned([DVec3::new(0.8, 0.6, 0.0), DVec3::new(-0.6, 0.8, 0.0), DVec3::Z], false);
        assert!((tilted.frame.degrees_off() - 36.87).abs() < 0.01, "{:?}", tilted.frame);
        let refused = |axes: [DVec3; 3]| {
            Grid::new(Path::new("a"), &[2, 2, 2], &axes, false, 1).unwrap_err().to_string()
        };
        assert!(refused([DVec3::X, DVec3::X, DVec3::Z]).contains("lie in a plane"));
        assert!(refused([DVec3::ZERO, DVec3::X, DVec3::Z]).contains("spacing 0"));
        assert!(refused([DVec3::NAN, DVec3::X, DVec3::Z]).contains("spacing NaN"));
        let absurd = Grid::new(Path::new("a"), &[u64::MAX; 3], &[], false, 1).unwrap_err().to_string();
        assert!(absurd.contains("limit"), "{absurd}");
    }
}
