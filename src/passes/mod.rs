//! Stale products become textures, and textures a picture. One file a pass, in the order in which they run.

pub(crate) mod appearance;
pub(crate) mod body;
pub(crate) mod classification;
pub mod classify;
pub mod combine;
pub mod dimmed_gbuffer;
pub mod eye_light;
pub mod gbuffer;
pub mod light_budget;
pub mod light_cells;
pub mod light_gbuffer;
pub mod light_network;
pub mod light_volume;
pub mod lighting;
pub mod medium;
mod mipmaps;
pub mod preclassify;
pub mod preintegrate;
pub(crate) mod products;
pub mod raycast;
pub mod scattered_light;
pub mod scattered_radiosity;
pub mod scattering_gbuffer;
pub mod shared_light;
pub mod summed_light;
pub mod surface;
pub mod surface_points;
pub mod tonemap;
pub mod upload;
pub mod volume_shadow;
pub(crate) mod voxels;

use crate::{Stage, gpu::Gpu};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;

/// The passes that compute the light which leaves translucent meshes.
pub(crate) struct ScatteringPlugin;

impl Plugin for ScatteringPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<gbuffer::Gbuffer>()
            .init_resource::<light_gbuffer::LightViewVersion>()
            .init_resource::<light_gbuffer::LightTexels>()
            .init_resource::<scattering_gbuffer::TexelChooser>()
            .init_resource::<scattered_radiosity::Scatterer>()
            .init_resource::<scattered_radiosity::Refinement>()
            .init_resource::<combine::Combiner>();
        let there_is_a_gpu = resource_exists::<Gpu>;
        app.init_resource::<light_volume::LightSweeper>()
            .init_resource::<dimmed_gbuffer::Dimmer>()
            .init_resource::<light_cells::CellAverager>()
            .init_resource::<light_network::NetworkMaker>()
            .init_resource::<scattered_light::Scatterer>()
            .init_resource::<summed_light::Adder>()
            .init_resource::<light_budget::LightBudget>()
            .init_resource::<light_budget::KeptLights>()
            .init_resource::<shared_light::Sharer>()
            .init_resource::<eye_light::EyeSweeper>()
            .init_resource::<volume_shadow::VolumeShadowVersion>();
        app.add_systems(
            Update,
            (
                (
                    volume_shadow::run,
                    light_budget::share_out,
                    light_volume::run,
                    light_cells::run,
                    light_network::run,
                    (scattered_light::run, shared_light::run).chain(),
                    summed_light::run,
                    eye_light::run,
                )
                    .chain()
                    .in_set(Stage::LightVolume),
                (body::measure, body::forget, surface_points::refine, light_gbuffer::run)
                    .chain()
                    .in_set(Stage::LightGbuffer),
                (scattering_gbuffer::spawn_cameras, scattering_gbuffer::run)
                    .chain()
                    .in_set(Stage::ScatteringGbuffer),
                scattered_radiosity::run.in_set(Stage::ScatteredRadiosity),
                combine::run.in_set(Stage::Combine),
            )
                .run_if(there_is_a_gpu),
        );
    }
}
