//! Files, and a few shapes made on the spot, as mesh and volume data.
//!
//! Nothing here knows a scene, an entity or a GPU: a path goes in, plain vectors or a [`SourceError`] come out. Whatever the
//! file holds, a reader neither panics nor allocates more than a bounded multiple of the file's length.

mod beside;
mod colour;
mod dicom;
pub mod error;
mod file;
mod gltf;
mod grid;
pub mod mesh;
pub mod mesh_file;
mod meta_image;
mod nifti;
mod npy;
mod nrrd;
pub mod obj;
mod pick;
mod pieces;
mod ply;
pub mod procedural;
pub mod raw;
pub mod recognise;
pub(crate) mod seems;
pub mod self_describing;
mod shape;
pub(crate) mod slices;
mod statements;
mod stl;
mod stored;
mod stream;
mod text;
mod texture;
mod tiff;
pub mod trail;
pub mod volume;
mod vti;
mod vtk;

pub use error::{LayoutError, Searched, SourceError};
pub use mesh::{
    CREASE_DEGREES, MeshData, MeshMaterial, MeshPart, MeshStatistics, MeshSubsurface, Normals, TextureImage,
};
pub use mesh_file::{MeshFormat, read_mesh};
pub use obj::read_obj;
pub use raw::{RawLayout, read_raw};
pub use recognise::{Kind, recognise};
pub use self_describing::{Selection, read_volume};
pub use volume::{
    BrickRanges, Endian, Frame, Histogram, Label, Labels, SampleFormat, Samples, SliceRanges, Space,
    VolumeData,
};

#[cfg(test)]
mod tests;
