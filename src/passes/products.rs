//! Which shaders make which products, so that those of a shader that changes are made again. What is drawn anew in each frame is not here.

use super::combine::Radiosity;
use super::eye_light::EyeLight;
use super::light_cells::LightCells;
use super::light_gbuffer::LightViews;
use super::light_volume::LightVolumes;
use super::preclassify::ClassifiedVoxels;
use super::scattered_light::ScatteredLight;
use super::scattered_radiosity::ScatteredRadiosity;
use super::scattering_gbuffer::CameraMaps;
use super::summed_light::SummedLight;
use super::volume_shadow::VolumeShadows;
use bevy_ecs::prelude::*;
use std::collections::BTreeSet;

/// Forgets what these shaders made. The passes then find it missing, and those after them find theirs stale.
pub(crate) fn forget(world: &mut World, shaders: &BTreeSet<String>) {
    made_by::<ClassifiedVoxels>(world, shaders, &["preclassify"]);
    made_by::<LightVolumes>(world, shaders, &["light_volume"]);
    made_by::<VolumeShadows>(world, shaders, &["gbuffer"]);
    made_by::<LightCells>(world, shaders, &["light_cells"]);
    made_by::<ScatteredLight>(world, shaders, &["scattered_light"]);
    made_by::<SummedLight>(world, shaders, &["summed_light"]);
    made_by::<EyeLight>(world, shaders, &["eye_light"]);
    made_by::<LightViews>(world, shaders, &["gbuffer", "dimmed_gbuffer"]);
    made_by::<CameraMaps>(world, shaders, &["gbuffer", "scattering_texels"]);
    // It knows its maps by what they are made from, which is the same again.
    let radiosity = ["scattered_radiosity", "scattered_texels", "gather", "gbuffer", "scattering_texels"];
    made_by::<ScatteredRadiosity>(world, shaders, &radiosity);
    made_by::<Radiosity>(world, shaders, &["combine"]);
}

fn made_by<Product: Component>(world: &mut World, shaders: &BTreeSet<String>, own: &[&str]) {
    if !own.iter().any(|shader| shaders.contains(*shader)) {
        return;
    }
    let holders: Vec<Entity> = world.query_filtered::<Entity, With<Product>>().iter(world).collect();
    for holder in holders {
        world.entity_mut(holder).remove::<Product>();
    }
}
