//! One file becomes a world.
//!
//! ```text
//! text --ron--> parts with places --type registry--> SceneDocument --reconcile--> entities
//! ```
//!
//! The reader knows no component type: whatever is registered for reflection can be written. It reports every problem of a scene
//! at once ([`Problem`]), each with its place in the text.

mod advice;
mod document;
mod edit;
mod edits;
mod layout;
mod names;
mod parts;
mod patch;
mod path;
mod problem;
mod reader;
mod reconcile;
mod references;
mod tokens;
mod wanted;
mod write;

pub use document::{Override, SceneComponent, SceneDocument, SceneEntity};
pub use edits::{Conflict, EditError, Edits, SaveError, Side, Version};
pub use names::nearest;
pub use problem::{Place, Problem, Problems, Severity, SourceFile};
pub use reconcile::{SceneEntities, reconcile};
pub use write::{WriteError, to_ron};
