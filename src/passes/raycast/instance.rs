//! A volume as the ray caster's shader knows it.

use super::parts::{self, Stretch};
use super::{VolumeData, classification_of};
use crate::components::{Classification, SceneSettings, Shading, VolumeLighting};
use crate::gpu::Texels;
use crate::mirrors::mirror;
use crate::optics::peak::Peak;
use crate::passes::light_volume::{lighting_in_force, scene_from_texture};
use crate::passes::lighting::{EMITS, GRADIENT, SCATTERS, SCATTERS_ONCE, SCATTERS_TOWARDS_EYE, UNLIT};
use crate::view::{Coarseness, View};
use glam::{DAffine3, DMat3, DVec3, Mat4, UVec3, Vec3};

mirror! {
    /// Mirror of `VolumeInstance` in `shaders/raycast.wgsl`.
    "raycast":
    pub(crate) struct VolumeInstance as "VolumeInstance" {
        texture_from_eye: Mat4,
        size: Vec3,
        step: f32,
        lookup_scale: f32,
        lookup_offset: f32,
        table_entries: u32,
        table_row: u32,
        is_exact: u32,
        bricks_start: u32,
        bricks: UVec3,
        least_transmittance: f32,
        skip_empty: u32,
        lighting: u32,
        ambient: f32,
        diffuse: f32,
        specular: f32,
        shininess: f32,
        edge: f32,
        reach: f32,
        g: f32,
        emission: f32,
        fluence_scale: f32,
        peak_cap: f32,
        greatest_colour: f32,
        greatest_extinction: f32,
    }
}

/// All volumes for one draw.
pub fn instances(
    view: (&View, &Coarseness),
    settings: &SceneSettings,
    volumes: &[VolumeData],
    shading: Shading,
    starts: &[[u32; 2]],
) -> Vec<VolumeInstance> {
    let of_volume = |(volume, start): (&VolumeData, &[u32; 2])| {
        let scene_from_texture = scene_from_texture(volume.loaded, volume.placement, settings);
        instance(view, volume, scene_from_texture, lit(volume, settings, shading), *start)
    };
    volumes.iter().zip(starts).map(of_volume).collect()
}

/// How much of a ray a volume takes at most.
pub fn stretch(view: (&View, &Coarseness), settings: &SceneSettings, volume: &VolumeData) -> Stretch {
    let scene_from_texture = scene_from_texture(volume.loaded, volume.placement, settings);
    Stretch::new(
        axes_in_eye(view.0, scene_from_texture),
        step(view, volume, scene_from_texture),
        volume.classified.bricks,
    )
}

/// The shortest step of the rays through a volume, in voxels.
pub fn shortest_step(view: &View, settings: &SceneSettings, volume: &VolumeData) -> f64 {
    let axes = axes_in_eye(view, scene_from_texture(volume.loaded, volume.placement, settings));
    parts::longest(axes) / parts::MOST_SEGMENTS / shortest_edge(axes, volume)
}

fn axes_in_eye(view: &View, scene_from_texture: DAffine3) -> DMat3 {
    (view.eye_from_scene * scene_from_texture).matrix3
}

/// The shortest edge of a voxel.
fn shortest_edge(axes: DMat3, volume: &VolumeData) -> f64 {
    let size = DVec3::from(volume.loaded.data.size.map(f64::from));
    (axes.x_axis.length() / size.x).min(axes.y_axis.length() / size.y).min(axes.z_axis.length() / size.z)
}

/// Length of a segment, eye space.
fn step((view, coarseness): (&View, &Coarseness), volume: &VolumeData, scene_from_texture: DAffine3) -> f64 {
    let axes = axes_in_eye(view, scene_from_texture);
    let coarser = match classification_of(volume) {
        Classification::PreIntegrated => 1.0,
        _ => coarseness.step,
    };
    let wanted = shortest_edge(axes, volume) * f64::from(volume.ray_cast.step * coarser);
    wanted.max(parts::longest(axes) / parts::MOST_SEGMENTS)
}

fn instance(
    (view, coarseness): (&View, &Coarseness),
    volume: &VolumeData,
    scene_from_texture: DAffine3,
    lit: Lit,
    [bricks_start, table_row]: [u32; 2],
) -> VolumeInstance {
    let VolumeData { loaded, classified, texture, ray_cast, voxels, summed, .. } = volume;
    let eye_from_texture = view.eye_from_scene * scene_from_texture;
    let (lookup_scale, lookup_offset) = classified.lookup(texture.format);
    let [greatest_colour, greatest_extinction] = voxels.map_or([1.0; 2], |voxels| voxels.greatest);
    VolumeInstance {
        texture_from_eye: glam::DMat4::from(eye_from_texture.inverse()).as_mat4(),
        size: UVec3::from(loaded.data.size).as_vec3(),
        step: step((view, coarseness), volume, scene_from_texture) as f32,
        lookup_scale,
        lookup_offset,
        table_entries: classified.table.entries.len() as u32,
        table_row,
        is_exact: u32::from(classified.table.is_exact),
        bricks_start,
        bricks: UVec3::from(classified.bricks),
        least_transmittance: 1.0 - ray_cast.early_termination,
        skip_empty: u32::from(ray_cast.skip_empty),
        lighting: lit.kind,
        ambient: lit.ambient,
        diffuse: lit.diffuse,
        specular: lit.specular,
        shininess: lit.shininess,
        edge: edge(volume),
        reach: view.reach as f32,
        g: lit.g,
        emission: lit.emission,
        fluence_scale: summed.map_or(0.0, |summed| summed.scale),
        peak_cap: Peak::new(f64::from(lit.g)).cap.min(f64::from(f32::MAX)) as f32,
        greatest_colour,
        greatest_extinction,
    }
}

/// How far below 0 a missing sample counts as where gradients are taken, in texels: one range of the data below the least of it, so that
/// the edge of what is there always stands out. 0 where none is missing.
fn edge(VolumeData { loaded, classified, texture, .. }: &VolumeData) -> f32 {
    if texture.format.texels == Texels::Values {
        return 0.0;
    }
    let ((least, greatest), domain) = (loaded.data.range, classified.domain);
    let width = (greatest - least).max(domain.1 - domain.0);
    ((width - least) - texture.format.offset) / texture.format.scale
}

/// How a volume is lit where the picture is shaded so.
pub fn lit(volume: &VolumeData, settings: &SceneSettings, shading: Shading) -> Lit {
    let lighting = lighting_in_force(volume.lighting, volume.shading, settings);
    let mut lit = Lit::of(&match shading {
        Shading::Scattering => lighting,
        Shading::Local => lighting.local(),
    });
    let is_scattering = [SCATTERS_ONCE, SCATTERS].contains(&lit.kind);
    if is_scattering && volume.light_volumes.is_none_or(|own| own.0.is_empty()) {
        // Nothing arrives where there is no light.
        lit.kind = UNLIT;
    }
    lit.shares = volume.summed.is_some();
    if lit.kind == SCATTERS && volume.eye_light.is_some() {
        lit.kind = SCATTERS_TOWARDS_EYE;
    }
    lit
}

/// A lighting as the shader knows it.
#[derive(Default)]
pub(in crate::passes) struct Lit {
    pub(in crate::passes) kind: u32,
    ambient: f32,
    diffuse: f32,
    pub(in crate::passes) specular: f32,
    shininess: f32,
    pub(in crate::passes) g: f32,
    emission: f32,
    /// Whether there is light of lights that share a sum.
    pub(in crate::passes) shares: bool,
}

impl Lit {
    fn of(lighting: &VolumeLighting) -> Self {
        match *lighting {
            VolumeLighting::EmissionAbsorption => Self { kind: EMITS, ..Default::default() },
            VolumeLighting::Gradient { ambient, diffuse, specular, shininess } => {
                Self { kind: GRADIENT, ambient, diffuse, specular, shininess, ..Default::default() }
            }
            VolumeLighting::SingleScattering { g, .. } => {
                Self { kind: SCATTERS_ONCE, g, ..Default::default() }
            }
            VolumeLighting::LightVolume { g, emission, gradient_specular, .. } => {
                let shininess = GRADIENT_SHININESS;
                Self {
                    kind: SCATTERS,
                    g,
                    emission,
                    specular: gradient_specular,
                    shininess,
                    ..Default::default()
                }
            }
        }
    }
}

/// Blinn's exponent of highlights in light volumes.
const GRADIENT_SHININESS: f32 = 16.0;
