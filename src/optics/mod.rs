//! Formulas, pure: no entity, no GPU.
//!
//! Scattering is in `f64` and in any unit of length, as long as all lengths of a call share it. Directions of light and of the viewer
//! point away from the surface; refracted directions point into the medium; `eta` is the index inside over the index outside.

pub mod calibration;
pub mod diffusion;
pub mod dipole;
pub mod fresnel;
pub mod labels;
pub mod materials;
pub mod medium;
pub mod moments;
pub mod peak;
pub mod phase;
pub mod preintegration;
mod quadrature;
pub mod sampling;
pub mod transfer;
pub mod transport;
