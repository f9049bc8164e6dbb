//! Stale products become textures, and textures a picture. One file a pass, in the order in which they run.

pub mod classify;
pub mod raycast;
pub mod surface;
pub mod tonemap;
pub mod upload;
