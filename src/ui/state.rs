//! What panels show and keep.

use super::{Log, SceneProblems, Sections};
use bevy_ecs::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::time::Duration;

/// The panels that are open.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct OpenPanels {
    /// Entities and their errors.
    pub entities: bool,
    /// What concerns the selected entity.
    pub inspector: bool,
    /// Passes, times and memory.
    pub report: bool,
    /// What was told.
    pub log: bool,
    /// The axes of the scene, in a corner of the picture.
    pub axes: bool,
}

impl Default for OpenPanels {
    fn default() -> Self {
        Self { entities: true, inspector: true, report: false, log: false, axes: true }
    }
}

/// The entity that is looked at.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Selection(pub Option<Entity>);

/// How often each pass has run since the window opened; [`Report`](crate::report::Report) tells of the last picture.
#[derive(Resource, Clone, Debug, Default)]
pub struct Totals(pub BTreeMap<&'static str, u64>);

/// The parts of the way from files that changed to the picture that shows them first, in milliseconds, as far as any have changed.
#[derive(Resource, Clone, Debug, Default)]
pub struct LastReload(pub Vec<(&'static str, f64)>);

/// What the window has to show.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// The picture.
    pub texture: Option<egui::TextureId>,
    /// Pixels of the picture as it was drawn last.
    pub pixels: [u32; 2],
    /// Pixels of the picture when it is drawn in full: those of the room that it has.
    pub room: [u32; 2],
    /// How long the last picture took.
    pub took: Duration,
    /// Whether it was drawn more coarsely than it will be once everything rests.
    pub is_coarse: bool,
    /// Sets of samples that translucent meshes have, and are to have.
    pub refined: Option<(u32, u32)>,
    /// Why the picture is not that of the scene as it is now.
    pub failure: Option<String>,
    /// Whether rays are parallel.
    pub is_orthographic: bool,
    /// Whether the camera has been moved away from the scene's.
    pub is_free: bool,
    /// Whether the scene is in no file yet.
    pub is_untitled: bool,
    /// Why what was to be opened or written was not, and what to do about it; a line each.
    pub notice: Option<String>,
    /// Who draws.
    pub adapter: String,
}

/// Puts into a world what panels keep in it.
pub fn init(world: &mut World) {
    world.init_resource::<OpenPanels>();
    world.init_resource::<Selection>();
    world.init_resource::<SceneProblems>();
    world.init_resource::<Totals>();
    world.init_resource::<Log>();
    world.init_resource::<super::Recent>();
    world.init_resource::<Sections>();
}
