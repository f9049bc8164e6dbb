//! One file becomes a world.
//!
//! ```text
//! text --ron--> parts with places --type registry--> SceneDocument --reconcile--> entities
//! ```
//!
//! The reader knows no component type: whatever is registered for reflection can be written. It reports every problem of a scene
//! at once ([`Problem`]), each with its place in the text.

mod advice;
mod component_file;
mod document;
mod edit;
mod names;
mod parts;
mod problem;
mod reader;
mod reconcile;
mod references;
mod tokens;
mod wanted;

pub use component_file::read_component;
pub use document::{Override, SceneComponent, SceneDocument, SceneEntity};
pub use names::nearest;
pub use problem::{Place, Problem, Problems, Severity, SourceFile};
pub use reconcile::{SceneEntities, reconcile};
