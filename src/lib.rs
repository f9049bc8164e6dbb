//! Light scattering in meshes and volumes, as data.
mod app;
pub mod cli;
pub mod components;
pub mod gpu;
pub mod loading;
pub mod mirrors;
pub mod optics;
mod passes;
pub mod prelude;
pub mod render;
pub mod report;
pub mod scene;
pub mod sources;
mod view;
pub use app::{SceneTime, Stage, TyndallPlugins};
pub use view::Picture;
