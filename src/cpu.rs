//! CPU twins of the passes that compute: slow, obvious and in 64 bits, to measure the GPU's by.

mod scattered_radiosity;

pub use scattered_radiosity::{ScatteredPoint, brute_force, scattered_points};
