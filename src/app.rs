//! How the framework is put together: stages, and the plugins of the framework itself.

use crate::{components, failure, loading, passes, report::Report, scene, view};
use bevy_app::{App, First, Last, Plugin, PluginGroup, PluginGroupBuilder, Update};
use bevy_ecs::prelude::*;

/// The stages of an update, in order. Systems of plugins join one with `.in_set(Stage::Animate)`.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stage {
    /// Animations write [`Motion`](crate::components::Motion) from [`SceneTime`].
    Animate,
    /// Transform and motion become [`Placement`](crate::components::Placement).
    Place,
    /// Files that components name are read.
    Load,
    /// What was read goes to the GPU, and is let go of on the processor.
    Upload,
    /// Transfer functions become lookup tables, and bricks are found empty or not.
    Classify,
    /// The camera and the lights of the frame.
    View,
    /// How much of each light arrives inside the volumes that scatter.
    LightVolume,
    /// What each light reaches of the meshes that scatter.
    LightGbuffer,
    /// What their scattering cameras see of them, where maps are asked for.
    ScatteringGbuffer,
    /// The light that leaves those meshes, point by point.
    ScatteredRadiosity,
    /// The same of all lights together.
    Combine,
    /// Meshes.
    Surface,
    /// Volumes.
    RayCast,
    /// What a screen shows.
    Tonemap,
}

impl Stage {
    const ALL: [Self; 14] = [
        Self::Animate,
        Self::Place,
        Self::Load,
        Self::Upload,
        Self::Classify,
        Self::View,
        Self::LightVolume,
        Self::LightGbuffer,
        Self::ScatteringGbuffer,
        Self::ScatteredRadiosity,
        Self::Combine,
        Self::Surface,
        Self::RayCast,
        Self::Tonemap,
    ];
}

/// The time that animations follow.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct SceneTime {
    /// Seconds since the start of the animation.
    pub seconds: f64,
}

/// Everything that the framework consists of. What is drawn with needs a [`Gpu`](crate::gpu::Gpu) resource besides; without one, scenes
/// are read and checked but not drawn.
pub struct TyndallPlugins;

impl PluginGroup for TyndallPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(ScenePlugin)
            .add(loading::LoadingPlugin)
            .add(view::ViewPlugin)
            .add(passes::ScatteringPlugin)
            .add(passes::surface::SurfacePlugin)
            .add(passes::raycast::RayCastPlugin)
            .add(passes::tonemap::TonemapPlugin)
    }
}

/// The components of scenes, the order of the stages, and where entities are.
struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        for pair in Stage::ALL.windows(2) {
            app.configure_sets(Update, pair[0].before(pair[1]));
        }
        components::register(app);
        app.init_resource::<components::SceneSettings>()
            .init_resource::<scene::Problems>()
            .init_resource::<scene::SceneEntities>()
            .init_resource::<SceneTime>()
            .init_resource::<Report>()
            .init_resource::<failure::Failure>()
            .add_systems(
                First,
                (failure::retry, |mut problems: ResMut<scene::Problems>| problems.forget_update()),
            )
            .add_systems(Last, failure::mark)
            .add_systems(Last, scene::watch_assets.run_if(resource_exists::<scene::AssetWatch>))
            .add_systems(Update, (components::place, components::aim).in_set(Stage::Place));
    }
}
