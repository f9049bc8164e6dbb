//! The GPU, without a term of the scene: device, shaders, pipelines, buffers, read-back, timing.

mod buffer;
mod device;
mod draw;
mod error;
mod formats;
mod grid;
mod kernel;
mod live;
mod readback;
mod recent;
pub mod shader;
mod target;
mod timer;

pub use buffer::{
    buffer_of, storage, storage_array, storage_of, uniform_array, uniform_buffer, uniform_each,
};
pub use device::{Gpu, GpuOptions};
pub use draw::{Draw, DrawDescriptor, binding};
pub use error::GpuError;
pub use formats::{Filtering, Texels, VolumeFormat};
pub use grid::Grid;
pub use kernel::{Invocations, Kernel, KernelDescriptor};
pub use readback::{read_buffer, read_texture};
pub use recent::Recent;
pub use target::{Layers, Target, begin, begin_part, texture_of};
pub use timer::{PassTimer, ends};
