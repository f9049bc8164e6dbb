//! What volumes leave of the light that goes on to meshes.

use super::lookup;
use super::{LightVolume, LightVolumes, scene_from_texture};
use crate::components::{Placement, SceneSettings};
use crate::gpu::{Filtering, Gpu, binding, uniform_array};
use crate::loading::LoadedVolume;
use bevy_ecs::prelude::*;
use glam::{DAffine3, DMat4, Mat4, Vec3};

/// The volumes that light may come through.
pub(crate) type Shading<'w, 's> =
    Query<'w, 's, (Entity, &'static LoadedVolume, &'static Placement, &'static LightVolumes)>;

/// The volumes that stand in the light of meshes, with the light volumes of some lights.
#[derive(Default)]
pub(crate) struct Veils<'a> {
    /// Takes the scene to the texture of each volume.
    texture_from_scene: Vec<DAffine3>,
    /// For each volume one for each light.
    light_volumes: Vec<&'a LightVolume>,
}

/// What shaders are made for: volumes, and lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct VeilCount {
    pub volumes: usize,
    pub lights: usize,
}

impl<'a> Veils<'a> {
    /// All volumes and lights; none if volumes are not to shade meshes.
    pub fn all(shading: &'a Shading, settings: &SceneSettings) -> Self {
        Self::gather(shading, settings, |_| true, |_, _| true)
    }

    /// Those of one light, as far as `is_between` says so of where they are and the box around them.
    pub fn between(
        shading: &'a Shading,
        settings: &SceneSettings,
        light: Entity,
        is_between: impl Fn(&Placement, (Vec3, Vec3)) -> bool,
    ) -> Self {
        Self::gather(shading, settings, |volume| volume.light == light, is_between)
    }

    fn gather(
        shading: &'a Shading,
        settings: &SceneSettings,
        is_wanted: impl Fn(&LightVolume) -> bool,
        is_between: impl Fn(&Placement, (Vec3, Vec3)) -> bool,
    ) -> Self {
        let mut veils = Self::default();
        if !settings.volumes_shade_meshes {
            return veils;
        }
        let is_shading = |loaded: &LoadedVolume, placement, own: &LightVolumes| {
            let half = loaded.half_extent() / settings.millimetres_per_unit;
            !own.0.is_empty() && is_between(placement, (-half, half))
        };
        let volumes = shading.iter().filter(|(_, loaded, placement, own)| is_shading(loaded, placement, own));
        let mut volumes: Vec<_> = volumes.collect();
        volumes.sort_by_key(|(entity, ..)| *entity);
        for (_, loaded, placement, own) in volumes {
            veils.texture_from_scene.push(scene_from_texture(loaded, placement, settings).inverse());
            veils.light_volumes.extend(own.0.iter().filter(|volume| is_wanted(volume)));
        }
        veils
    }

    /// How many there are.
    pub fn count(&self) -> VeilCount {
        let volumes = self.texture_from_scene.len();
        VeilCount { volumes, lights: self.light_volumes.len().checked_div(volumes).unwrap_or(0) }
    }

    /// What the texels that are looked up depend on.
    pub fn recipe(&self) -> Vec<(DAffine3, u64)> {
        let lights = self.count().lights;
        let of_volume = |index: usize| self.texture_from_scene[index.checked_div(lights).unwrap_or(0)];
        self.light_volumes.iter().enumerate().map(|(index, own)| (of_volume(index), own.version)).collect()
    }

    /// The buffers for a draw whose positions `scene_from_here` takes to the scene.
    pub fn buffers(&self, gpu: &Gpu, scene_from_here: DAffine3) -> VeilBuffers {
        let matrices: Vec<Mat4> = self
            .texture_from_scene
            .iter()
            .map(|texture_from_scene| DMat4::from(*texture_from_scene * scene_from_here).as_mat4())
            .collect();
        VeilBuffers {
            sweeps: lookup::sweeps(gpu, &self.light_volumes),
            sampler: lookup::sampler(gpu),
            matrices: uniform_array(gpu, "veils", &matrices, matrices.len().max(1)),
        }
    }

    /// The resources of the module's bindings.
    pub fn resources<'b>(&'b self, buffers: &'b VeilBuffers) -> Vec<wgpu::BindingResource<'b>> {
        if self.light_volumes.is_empty() {
            return Vec::new();
        }
        let mut resources = lookup::resources(&self.light_volumes, &buffers.sweeps, &buffers.sampler);
        resources.push(buffers.matrices.as_entire_binding());
        resources
    }
}

/// Buffers of one draw.
pub(crate) struct VeilBuffers {
    sweeps: wgpu::Buffer,
    sampler: wgpu::Sampler,
    matrices: wgpu::Buffer,
}

/// The bindings of the module `veils`.
pub(crate) fn bindings(count: VeilCount, filtering: Filtering) -> Vec<wgpu::BindingType> {
    let mut bindings = lookup::bindings(count.volumes * count.lights, filtering);
    if !bindings.is_empty() {
        bindings.push(binding::UNIFORM);
    }
    bindings
}

/// The modules `light_volumes` and `veils`: `through_volumes(position, light)` is the share of a light that volumes let through to a
/// position.
pub(crate) fn modules(count: VeilCount, filtering: Filtering, first: usize) -> [(&'static str, String); 2] {
    let VeilCount { volumes, lights } = count;
    let all = volumes * lights;
    let light_volumes = lookup::light_volumes_module(all, filtering, first);
    let binding = first + 2 + all;
    let veils = match all {
        0 => "fn through_volumes(position: vec3f, light: u32) -> f32 {\n    return 1.0;\n}\n".to_owned(),
        _ => format!(
            "#import light_volumes
@group(0) @binding({binding}) var<uniform> texture_from_here: array<mat4x4f, {volumes}>;
fn through_volumes(position: vec3f, light: u32) -> f32 {{
    var left = 1.0;
    // Others have no light volume of their own.
    if light >= {lights}u {{
        return left;
    }}
    for (var volume = 0u; volume < {volumes}u; volume += 1u) {{
        let index = volume * {lights}u + light;
        let place = (texture_from_here[volume] * vec4f(position, 1.0)).xyz;
        let meets = light_meets(sweeps[index], place);
        if meets >= 0.0 {{
            left *= light_left(index, place - sweeps[index].step * meets);
        }}
    }}
    return left;
}}
"
        ),
    };
    [light_volumes, ("veils", veils)]
}
