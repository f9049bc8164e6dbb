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
mod edits;
mod excerpt;
mod frame;
mod layout;
mod loader;
mod names;
mod numbers;
mod of_files;
mod parts;
mod patch;
mod path;
mod problem;
mod reader;
mod reconcile;
mod references;
mod reload;
mod text;
mod tokens;
mod wanted;
mod watch;
mod write;

pub use component_file::read_component;
pub use document::{Override, SceneComponent, SceneDocument, SceneEntity};
pub use edits::{Conflict, EditError, Edits, SaveError, Side, Version};
pub use names::nearest;
pub(crate) use names::{Known, meant};
pub use of_files::{OfFilesError, Orientation, is_data, scene_of_files, untitled_for};
pub use problem::{EntityProblems, Place, Problem, Problems, Severity, SourceFile};
pub(crate) use problem::{MOST_TOLD, grouped, more};
pub use reconcile::{Changes, SceneEntities, reconcile, reconcile_after};
pub(crate) use references::Entities;
pub(crate) use reload::{AssetWatch, watch_assets};
pub use reload::{LiveScene, Reload};
pub(crate) use wanted::wanted_in_short;
pub use watch::Wake;
pub(crate) use write::in_full;
pub use write::{WriteError, to_ron};
