use super::{
    AlsoCalled, AssetPath, Auto, Leading, Placement, Range, RayCast, Required, TransferFunction, Transform,
    Unit, VolumeLighting,
};
use bevy_ecs::prelude::*;
use bevy_reflect::{Reflect, std_traits::ReflectDefault};
use glam::{UVec3, Vec3};

pub use crate::sources::{Endian, SampleFormat};

/// A scalar field on a regular grid, centred on the entity's origin.
///
/// | variant | what it reads |
/// |---|---|
/// | `File(path)` | a file that says itself what it holds: NRRD, NIfTI, MetaImage, DICOM (one file, a folder with series, also in folders within it, or a DICOMDIR), images of VTK (`.vti`, or legacy `.vtk` also of other grids that are even), TIFF stacks, NumPy arrays (`.npy`), a folder of numbered pictures (TIFF, PNG, JPEG) |
/// | `Raw(…)` | bare samples, described by its fields |
///
/// Which format a `File` is, its content says. Its spacing is in mm. Where it says how it lies in a patient, as NIfTI and DICOM do,
/// +x is right, +y anterior and +z superior; other files keep their own axes: pages of TIFF and pictures of a folder lie along +z, their rows along +y; the last
/// three axes of a NumPy array are z, y and x. Axes are only exchanged and reversed, never resampled,
/// and a note tells of it, as of whatever else is not drawn as it is written. 8- and 16-bit integers and 32-bit floats keep their type;
/// wider or scaled integers become the first of `U8`, `I8`, `U16`, `I16` that holds every value exactly, or else `F32`; scaled and
/// 64-bit floats become `F32`.
///
/// | field of `File` | type | unit | range | default |
/// |---|---|---|---|---|
/// | `path` | file or folder; alone it needs no name | – | – | – |
/// | `place` | `Centred` on the entity's origin, or `Patient`: where the file says, so that a mask lies on its scan | – | – | `Centred` |
/// | `index` | entry along a fourth axis, such as a time point, or one of several arrays of VTK | – | below their number | 0 |
/// | `component` | `Auto` (all of a colour, else the first), or one of the numbers that each sample consists of | – | below their number | `Auto` |
/// | `series` | of a DICOM folder: `SeriesInstanceUID`, number or description | – | – | the largest |
/// | `interpolation` | `Auto`, `Linear` or `Nearest` | – | – | `Auto`: `Nearest` for label maps |
///
/// | field of `Raw` | type | unit | range | default |
/// |---|---|---|---|---|
/// | `path` | file; a name that ends in `.gz` is unpacked | – | – | – |
/// | `size` | voxels along x, y, z; x varies fastest in the file | voxels | at least 1 | – |
/// | `format` | `U8`, `I8`, `U16`, `I16`, `F32` or `Rgba8` | – | – | `U8` |
/// | `endian` | `Little` or `Big` | – | – | `Little` |
/// | `spacing` | distance of voxel centres | mm | above 0 | (1, 1, 1) |
/// | `skip_bytes` | length of a header in front of the samples | bytes | – | 0 |
/// | `interpolation` | as above | – | – | `Auto` |
///
/// Samples of `Rgba8` are colours: red, green, blue and opacity, the first three encoded as in sRGB, in which they are interpolated, too. They are
/// drawn in their own colour, which is their albedo in light; [`TransferFunction`] says how opacity follows from luminance.
///
/// A voxel is a cell around its sample, so the volume is `size * spacing` millimetres long. Between samples the field is trilinear;
/// in the half voxel at the border it is constant. Samples that are not finite are counted, reported and missing: what lies between samples is the
/// mean of those that there are, by their weights, and the medium ends where half of the weights are missing, within half a voxel. That end is
/// shaded as a surface.
///
/// ```ron
/// Volume: File("head.nii.gz")
/// Volume: File(path: "mask.nii.gz", place: Patient, interpolation: Nearest)
/// Volume: Raw(path: "../assets/bonsai.raw", size: (256, 256, 256),
///     format: U8, spacing: (0.08, 0.08, 0.08))
/// ```
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
#[reflect(@AlsoCalled(&["Voxels", "Scan", "Image", "Grid", "Density", "Raw", "Nifti", "Nrrd", "Dicom"]))]
#[require(Transform, Placement, TransferFunction, VolumeLighting, RayCast)]
pub enum Volume {
    /// Read from a file, or a folder of slices, that says itself what it holds.
    #[reflect(@AlsoCalled(&["Nifti", "Nii", "Nrrd", "Nhdr", "Dicom", "Dcm", "MetaImage", "Mha", "Mhd", "Vtk", "Vti", "Npy", "Numpy", "Tiff", "Tif", "Image", "Load", "Path", "Import"]))]
    File {
        /// The file or folder.
        #[reflect(@Leading, @Required)]
        path: AssetPath,
        /// Where it lies.
        #[reflect(default)]
        place: Place,
        /// The entry along a fourth axis, such as a time point, or one of several arrays of VTK, counted from 0.
        #[reflect(default)]
        index: u32,
        /// The component of samples that consist of several numbers, counted from 0.
        #[reflect(default)]
        component: Auto<u32>,
        /// The series of a DICOM folder.
        #[reflect(default)]
        series: Option<String>,
        /// What lies between samples.
        #[reflect(default)]
        interpolation: Interpolation,
    },
    /// Bare samples, as they stand in memory.
    #[reflect(@AlsoCalled(&["Binary", "Bytes", "Data", "Bin"]))]
    Raw {
        /// The file.
        #[reflect(@Required)]
        path: AssetPath,
        /// Voxels along x, y and z.
        #[reflect(@Required, @Range::new(1.0, u32::MAX as f64), @Unit("voxels"))]
        size: UVec3,
        /// Type of a sample.
        #[reflect(default)]
        format: SampleFormat,
        /// Byte order of a sample.
        #[reflect(default)]
        endian: Endian,
        /// Distance of voxel centres.
        #[reflect(default = "one_millimetre", @Range::positive(), @Unit("mm"))]
        spacing: Vec3,
        /// Length of the header.
        #[reflect(default, @Unit("bytes"))]
        skip_bytes: u64,
        /// What lies between samples.
        #[reflect(default)]
        interpolation: Interpolation,
    },
}

/// Where a volume that a file describes lies.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, PartialEq)]
pub enum Place {
    /// Upright, the middle of its box on the entity's origin.
    #[default]
    Centred,
    /// Where the file says that it lies, in the patient or another world that files share: origin and directions hold, oblique ones
    /// exactly, in millimetres from the entity's origin.
    Patient,
}

/// What lies between the samples of a volume.
#[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Default, PartialEq)]
pub enum Interpolation {
    /// `Nearest` for label maps, else `Linear`.
    #[default]
    Auto,
    /// A mix of the eight samples around, by distance.
    Linear,
    /// The value of the nearest sample: for values that name something and cannot be mixed.
    Nearest,
}

impl Volume {
    /// A file that says itself what it holds, with everything else left to it.
    pub fn file(path: impl Into<std::path::PathBuf>) -> Self {
        Self::File {
            path: AssetPath::new(path),
            place: Place::default(),
            index: 0,
            component: Auto::Auto,
            series: None,
            interpolation: Interpolation::default(),
        }
    }

    /// What lies between the samples, as written.
    pub fn interpolation(&self) -> Interpolation {
        match self {
            Self::File { interpolation, .. } | Self::Raw { interpolation, .. } => *interpolation,
        }
    }
}

impl Default for Volume {
    fn default() -> Self {
        Self::Raw {
            path: AssetPath::default(),
            size: UVec3::ONE,
            format: SampleFormat::default(),
            endian: Endian::default(),
            spacing: one_millimetre(),
            skip_bytes: 0,
            interpolation: Interpolation::default(),
        }
    }
}

fn one_millimetre() -> Vec3 {
    Vec3::ONE
}
