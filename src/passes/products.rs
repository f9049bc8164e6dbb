//! What passes keep on the GPU, to be forgotten when it is made anew: by a shader that changed, or on another device.

use super::combine::{Combiner, Radiosity};
use super::dimmed_gbuffer::Dimmer;
use super::eye_light::{EyeLight, EyeSweeper};
use super::gbuffer::Gbuffer;
use super::light_cells::{CellAverager, LightCells};
use super::light_gbuffer::LightViews;
use super::light_network::{LightNetwork, NetworkMaker};
use super::light_volume::{LightSweeper, LightVolumes};
use super::preclassify::{ClassifiedVoxels, Preclassifier};
use super::preintegrate::PreintegratedPairs;
use super::raycast::RayCaster;
use super::scattered_light::{self, ScatteredLight};
use super::scattered_radiosity::{self, ScatteredRadiosity};
use super::scattering_gbuffer::{CameraMaps, TexelChooser};
use super::shared_light::{SharedLight, Sharer};
use super::summed_light::{Adder, SummedLight};
use super::surface::Surface;
use super::surface_points::SurfacePoints;
use super::tonemap::Tonemap;
use super::upload::{MeshBuffers, VolumeTexture};
use super::volume_shadow::VolumeShadows;
use crate::gpu::PassTimer;
use crate::loading::read_again;
use bevy_ecs::prelude::*;
use std::collections::BTreeSet;

/// Forgets what these shaders made. The passes then find it missing, and those after them find theirs stale. What is drawn
/// anew in each frame is not here.
pub(crate) fn forget(world: &mut World, shaders: &BTreeSet<String>) {
    made_by::<ClassifiedVoxels>(world, shaders, &["preclassify"]);
    made_by::<LightVolumes>(world, shaders, &["light_volume"]);
    made_by::<VolumeShadows>(world, shaders, &["gbuffer"]);
    made_by::<LightCells>(world, shaders, &["light_cells"]);
    made_by::<LightNetwork>(world, shaders, &["light_network", "light_escape"]);
    made_by::<ScatteredLight>(world, shaders, &["scattered_light", "diffusion"]);
    made_by::<SharedLight>(world, shaders, &["shared_light", "light_volume", "scattered_light"]);
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
    if own.iter().any(|shader| shaders.contains(*shader)) {
        remove_all::<Product>(world);
    }
}

/// Forgets all that is on a device which is gone, and has what was let go of on the processor read again.
pub(crate) fn forget_device(world: &mut World) {
    remove_all::<(MeshBuffers, VolumeTexture, ClassifiedVoxels, PreintegratedPairs)>(world);
    remove_all::<(LightVolumes, VolumeShadows, LightCells, LightNetwork, ScatteredLight)>(world);
    remove_all::<(SharedLight, SummedLight, EyeLight)>(world);
    remove_all::<(LightViews, SurfacePoints, CameraMaps, ScatteredRadiosity, Radiosity)>(world);
    world.remove_resource::<PassTimer>();
    reset::<Preclassifier>(world);
    reset::<LightSweeper>(world);
    reset::<CellAverager>(world);
    reset::<NetworkMaker>(world);
    reset::<scattered_light::Scatterer>(world);
    reset::<Sharer>(world);
    reset::<Adder>(world);
    reset::<EyeSweeper>(world);
    reset::<Gbuffer>(world);
    reset::<Dimmer>(world);
    reset::<TexelChooser>(world);
    reset::<scattered_radiosity::Scatterer>(world);
    reset::<Combiner>(world);
    reset::<Surface>(world);
    reset::<RayCaster>(world);
    reset::<Tonemap>(world);
    read_again(world);
}

fn remove_all<Products: Bundle>(world: &mut World) {
    let all: Vec<Entity> = world.query::<Entity>().iter(world).collect();
    for entity in all {
        world.entity_mut(entity).remove::<Products>();
    }
}

fn reset<Kept: Resource + Default>(world: &mut World) {
    if world.contains_resource::<Kept>() {
        world.insert_resource(Kept::default());
    }
}
