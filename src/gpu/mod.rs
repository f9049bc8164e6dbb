//! The GPU, without a term of the scene: device, shaders, pipelines, buffers, read-back, timing.

mod buffer;
mod device;
mod draw;
mod error;
mod formats;
mod readback;
pub mod shader;
mod target;
mod timer;

pub use buffer::{storage_buffer, uniform_buffer};
pub use device::{Gpu, GpuOptions};
pub use draw::{Draw, DrawDescriptor, binding};
pub use error::GpuError;
pub use formats::{Filtering, VolumeFormat};
pub use readback::read_texture;
pub use target::Target;
pub use timer::PassTimer;
