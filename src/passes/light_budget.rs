//! How many lights have products of their own.

use super::classify::Classified;
use super::light_volume::cells::Cells;
use super::light_volume::{bytes_of, lighting_in_force, scene_from_texture};
use super::raycast::textures_for_volumes;
use super::volume_shadow::VolumeShadows;
use crate::components::{
    Classification, DirectionalLight, Motion, Placement, SceneSettings, Shading, VolumeLighting,
};
use crate::gpu::Gpu;
use crate::loading::LoadedVolume;
use crate::report::Report;
use crate::view::lights_in_order;
use bevy_ecs::prelude::*;

/// The memory that products which are kept for each light may take. As far as it goes, the colour of a light changes none of them.
///
/// Beyond it lights share one, which is their sum: a change of any of them makes it anew. For meshes the sum is exact. For volumes as many
/// lights as there is room for, the first by their entities, stay as they are. The others shed their light into the cells of [`VolumeLighting::LightVolume`], where
/// it is scattered evenly, casts shadows as coarse as they are, and does not go on to meshes behind the volume. The
/// [`Report`] says how many share.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub struct LightBudget {
    /// Bytes of the light that leaves one mesh; 64 MiB by default.
    pub mesh: u64,
    /// Bytes of the light volumes of all volumes together; 512 MiB by default. One light is kept in any case.
    pub volumes: u64,
}

impl Default for LightBudget {
    fn default() -> Self {
        Self { mesh: 64 << 20, volumes: 512 << 20 }
    }
}

/// How many lights, from the first on, have light volumes of their own.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct KeptLights(pub usize);

type Volumes<'w, 's> = Query<
    'w,
    's,
    (
        &'static LoadedVolume,
        &'static Classified,
        &'static Placement,
        &'static VolumeLighting,
        Option<&'static Shading>,
        Option<&'static VolumeShadows>,
    ),
>;

/// Counts the lights whose light volumes there is room for: memory, and textures that the ray caster can bind.
pub(crate) fn share_out(
    (gpu, budget, settings): (Res<Gpu>, Res<LightBudget>, Res<SceneSettings>),
    volumes: Volumes,
    lights: Query<(Entity, &DirectionalLight, Option<&Motion>)>,
    mut kept: ResMut<KeptLights>,
    mut report: ResMut<Report>,
) {
    let lights = lights_in_order(&lights);
    let mut bytes_left = budget.volumes;
    let mut textures_left = textures_for_volumes(&gpu);
    let mut scattering = Vec::new();
    for (loaded, classified, placement, lighting, shading, shadows) in &volumes {
        let is_twice = classified.classification != Classification::Post;
        textures_left = textures_left.saturating_sub(1 + usize::from(is_twice));
        let Some(resolution) = lighting_in_force(lighting, shading, &settings).light_resolution() else {
            continue;
        };
        // Of light that was scattered before, and of light towards the eye.
        textures_left = textures_left.saturating_sub(2);
        let scene_from_texture = scene_from_texture(loaded, placement, &settings);
        let cells = Cells::of(&gpu, (loaded, classified), resolution, scene_from_texture);
        scattering.push((cells, scene_from_texture.inverse(), shadows));
    }
    let mut count = 0;
    for (light, to_light) in &lights {
        let of_volume = |(cells, texture_from_scene, shadows): &(Cells, glam::DAffine3, _)| {
            let has_shadow = Option::<&VolumeShadows>::is_some_and(*shadows, |all| all.of(*light).is_some());
            let direction = texture_from_scene.transform_vector3(-*to_light);
            (bytes_of(*cells, direction), 1 + usize::from(has_shadow))
        };
        let (bytes, textures) = scattering.iter().map(of_volume).fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        if count > 0 && (bytes > bytes_left || textures > textures_left) {
            break;
        }
        bytes_left = bytes_left.saturating_sub(bytes);
        textures_left = textures_left.saturating_sub(textures);
        count += 1;
    }
    kept.set_if_neq(KeptLights(count));
    report.share("light_volume", lights.len() - count);
}
