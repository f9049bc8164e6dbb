//! Files, and a few shapes made on the spot, as mesh and volume data.
//!
//! Nothing here knows a scene, an entity or a GPU: a path goes in, plain vectors or a [`SourceError`] come out. Whatever the
//! file holds, a reader neither panics nor allocates more than a bounded multiple of the file's length.

pub mod error;
mod file;
pub mod mesh;
pub mod obj;
pub mod procedural;
pub mod raw;
pub mod volume;

pub use error::{LayoutError, SourceError};
pub use mesh::{MeshData, MeshStatistics};
pub use obj::read_obj;
pub use raw::{RawLayout, read_raw};
pub use volume::{BrickRanges, Endian, Histogram, SampleFormat, Samples, VolumeData};

#[cfg(test)]
mod tests;
