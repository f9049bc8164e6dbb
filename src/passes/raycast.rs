//! Volumes by ray casting, over what the surface pass left.
//!
//! Reads volume textures, lookup tables, brick distances and the surface; writes [`RayCaster::radiance`], rgba32float, one texel a
//! pixel: radiance, and how many samples it took. Runs each frame in which a volume is there. The shader is made for the number of volumes,
//! since each needs a texture binding of its own: their number is limited by what the adapter can bind at once. Rays that take more than one
//! invocation may do are cast in several draws, see [`parts`].

mod instance;
pub(crate) mod parts;
mod pipeline;
mod tables;

use super::classification::Manner;
use super::classify::{Classified, classify};
use super::eye_light::EyeLight;
use super::light_budget::KeptLights;
use super::light_volume::{LightVolume, LightVolumes, lookup, scene_from_texture};
use super::lighting::Kinds;
use super::preclassify::{ClassifiedVoxels, Preclassifier, preclassify};
use super::preintegrate::{PreintegratedPairs, preintegrate};
use super::summed_light::SummedLight;
use super::surface::Surface;
use super::upload::{VolumeTexture, VolumeUploadPlugin};
use super::volume_shadow::{self, VolumeShadow, VolumeShadows};
use super::voxels::Reading;
use crate::components::{
    Classification, Placement, RayCast as RayCastSettings, SceneSettings, Shading, VolumeLighting,
};
use crate::failure::Failure;
use crate::gpu::{Draw, Gpu, GpuError, PassTimer, Recent, Target, texture_of, uniform_array};
use crate::loading::LoadedVolume;
use crate::scene::{EntityProblems, Problem, Problems};
use crate::view::{
    Coarseness, Comparison, CutOut, FAR, FrameBuffers, Part, Picture, Pixels, View, background, covered,
    in_parts, is_wanted,
};
use crate::{Stage, report::Report};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use glam::{UVec2, Vec3};
pub(super) use instance::Lit;
pub(crate) use instance::VolumeInstance;
use instance::{instances, lit, shortest_step, stretch};
pub(crate) use parts::PartUniform;
use parts::{Plan, Rays, Rectangles};
pub(crate) use pipeline::{Scattered, classifications_module, parts_module, scattered_module, sweeps_module};
use pipeline::{Variant, make};
use std::collections::BTreeMap;
pub(crate) use tables::{BRICK_ROW, TABLE_ROW, table_texture};
use tables::{Tables, tables, view_of};

/// Casts rays through volumes.
pub(crate) struct RayCastPlugin;

impl Plugin for RayCastPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<RayCaster>().init_resource::<Preclassifier>().add_plugins(VolumeUploadPlugin);
        let classifying = (preintegrate, preclassify).run_if(resource_exists::<Gpu>);
        app.add_systems(Update, (classify, classifying).chain().in_set(Stage::Classify))
            .add_systems(Update, run.in_set(Stage::RayCast).run_if(resource_exists::<Gpu>).run_if(is_wanted));
    }
}

/// What the pass keeps between frames.
#[derive(Resource, Default, Debug)]
pub(crate) struct RayCaster {
    /// The pipelines, by what they are made for.
    draws: Recent<Variant, Draw>,
    rays: Rays,
    tables: Option<Tables>,
    target: Option<Target>,
    sampler: Option<wgpu::Sampler>,
}

impl RayCaster {
    /// Radiance and sample count of each pixel, if there is a volume.
    pub fn radiance(&self) -> Option<&Target> {
        self.target.as_ref()
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Textures of the shader besides those of volumes.
const OTHER_TEXTURES: usize = 3;

/// Which binding has the volumes as they are drawn in a part of the picture.
const INSTANCES: usize = 2;

/// A volume with all that its picture depends on.
#[derive(QueryData)]
pub(crate) struct VolumeQuery {
    entity: Entity,
    loaded: &'static LoadedVolume,
    classified: Ref<'static, Classified>,
    texture: &'static VolumeTexture,
    placement: &'static Placement,
    lighting: &'static VolumeLighting,
    ray_cast: &'static RayCastSettings,
    shading: Option<&'static Shading>,
    pairs: Option<&'static PreintegratedPairs>,
    voxels: Option<&'static ClassifiedVoxels>,
    light_volumes: Option<&'static LightVolumes>,
    shadows: Option<&'static VolumeShadows>,
    summed: Option<&'static SummedLight>,
    eye_light: Option<&'static EyeLight>,
}

type VolumeData<'a> = VolumeQueryItem<'a, 'a>;

fn run(
    mut commands: Commands,
    (gpu, frame, view, picture, settings): (
        Res<Gpu>,
        Res<FrameBuffers>,
        Res<View>,
        Res<Picture>,
        Res<SceneSettings>,
    ),
    (comparison, cut_out, coarseness, kept_lights): (
        Res<Comparison>,
        Res<CutOut>,
        Res<Coarseness>,
        Res<KeptLights>,
    ),
    (volumes, surface): (Query<VolumeQuery>, Res<Surface>),
    mut caster: ResMut<RayCaster>,
    (mut timer, mut too_fine): (Option<ResMut<PassTimer>>, Local<BTreeMap<Entity, String>>),
    (mut report, mut failure, mut problems): (ResMut<Report>, ResMut<Failure>, ResMut<Problems>),
) {
    let mut volumes: Vec<_> = volumes.iter().collect();
    volumes.sort_by_key(|volume| volume.entity);
    if let Some(problem) = too_many(&volumes, textures_for_volumes(&gpu)) {
        problems.0.push(problem);
        return;
    }
    if volumes.is_empty() {
        *caster = RayCaster::default();
        return;
    }
    let timing = timer.as_mut().and_then(|timer| timer.time("raycast"));
    let parts = in_parts(&comparison, picture.size);
    let lit_in = |volume| parts.iter().map(|part| lit(volume, &settings, part.shading)).collect();
    let lights = frame.light_count.min(kept_lights.0 as u32);
    let kinds = Kinds::of(volumes.iter().map(lit_in).collect(), lights);
    tell_too_fine(&mut commands, &view, &settings, &volumes, &mut too_fine);
    let plan = |variant: &Variant| {
        let stretches: Vec<_> =
            volumes.iter().map(|volume| stretch((&view, &coarseness), &settings, volume)).collect();
        Plan::new(&stretches, variant, frame.light_count)
    };
    let drawn =
        prepare(&gpu, &picture, kinds, &volumes, &frame, plan, &mut caster, &mut report).and_then(|plan| {
            let boxes =
                volumes.iter().map(|volume| scene_from_texture(volume.loaded, volume.placement, &settings));
            // Beside the volumes there is nothing but the background, unless there are meshes.
            let pixels = match surface.colour() {
                Some(_) => Pixels::all(picture.size),
                None => covered(&view, picture.size, boxes),
            };
            let starts = caster.tables.as_ref().map(|tables| tables.starts.as_slice()).unwrap_or_default();
            let of_part = |Part { columns, shading }: Part| {
                let instances = instances((&view, &coarseness), &settings, &volumes, shading, starts);
                (pixels.within(&columns), instances)
            };
            let parts: Vec<_> = parts.into_iter().map(of_part).collect();
            let background = background(&settings, &cut_out);
            draw(&gpu, &frame, background, &volumes, &parts, &surface, &mut caster, plan, timing)?;
            let pixels = parts.iter().map(|(pixels, _)| pixels.count()).sum();
            match plan.share {
                None => report.ran("raycast", &[("pixels", pixels)]),
                Some(_) => report.ran("raycast", &[("pixels", pixels), ("draws", plan.draws)]),
            }
            Ok(())
        });
    failure.keep(drawn);
}

/// Tells of volumes whose step is so short beside their length that rays take a longer one.
fn tell_too_fine(
    commands: &mut Commands,
    view: &View,
    settings: &SceneSettings,
    volumes: &[VolumeData],
    told: &mut BTreeMap<Entity, String>,
) {
    let too_fine = volumes.iter().filter_map(|volume| {
        let (wanted, shortest) = (volume.ray_cast.step, shortest_step(view, settings, volume));
        (f64::from(wanted) < shortest).then(|| {
            let most = parts::MOST_SEGMENTS;
            let message = format!(
                "a ray is cut into {most} segments at most: `step` is {shortest:.3e} voxels here rather than {wanted}, for the longest \
                 diagonal of the volume is so much longer than a voxel's shortest edge"
            );
            (volume.entity, message)
        })
    });
    let now: BTreeMap<Entity, String> = too_fine.collect();
    for (entity, message) in now.iter().filter(|(entity, message)| told.get(entity) != Some(message)) {
        let help = "check the `spacing` of the volume, or write a longer `step`";
        let problem = Problem::note(message.clone()).help(help).on(*entity, "RayCast.step");
        EntityProblems::set(commands, *entity, "raycast", vec![problem]);
    }
    for entity in told.keys().filter(|entity| !now.contains_key(*entity)) {
        EntityProblems::set(commands, *entity, "raycast", Vec::new());
    }
    *told = now;
}

/// Textures that volumes and their light may have between them.
pub(crate) fn textures_for_volumes(gpu: &Gpu) -> usize {
    gpu.device.limits().max_sampled_textures_per_shader_stage as usize - OTHER_TEXTURES
}

/// What is told where volumes and their light volumes are more textures than can be bound.
fn too_many(volumes: &[VolumeData], limit: usize) -> Option<Problem> {
    let classified = volumes.iter().filter(|volume| manner_of(volume).has_texture()).count();
    let scattered: usize = volumes.iter().map(|volume| scattered_of(volume).textures()).sum();
    let light = light_volumes(volumes).len() + shadows(volumes).iter().flatten().count() + scattered;
    if volumes.len() + light + classified <= limit {
        return None;
    }
    let mut message = format!("{} volumes are in the scene", volumes.len());
    if light > 0 {
        message += &format!(", with {light} textures of light between them");
    }
    if classified > 0 {
        message += &format!(", {classified} of them twice for their classification");
    }
    message += &format!("; this adapter can show {limit} at once");
    let help = "merge volumes, leave some out, or classify them by `Post`; a volume that scatters has a texture for each light, a light volume one more, and another with `towards_eye`";
    Some(Problem::error(message).help(help).on(volumes[volumes.len() - 1].entity, "Volume"))
}

/// What there is of the light that a volume scatters often.
fn scattered_of(volume: &VolumeData) -> Scattered {
    match (volume.summed, volume.eye_light) {
        (None, _) => Scattered::Nothing,
        (Some(_), None) => Scattered::Fluence,
        (Some(_), Some(_)) => Scattered::TowardsEye,
    }
}

/// How a volume is classified: as it asks, once what that takes is there.
fn classification_of(volume: &VolumeData) -> Classification {
    match (volume.classified.classification, volume.pairs, volume.voxels) {
        (Classification::PreIntegrated, Some(_), _) => Classification::PreIntegrated,
        (Classification::Pre, _, Some(_)) => Classification::Pre,
        _ => Classification::Post,
    }
}

/// How it is read.
fn manner_of(volume: &VolumeData) -> Manner {
    let classification = classification_of(volume);
    let has_surfaces = volume.classified.is_nearest && volume.voxels.is_some();
    Manner { classification, is_exact: volume.classified.table.is_exact, has_surfaces }
}

/// Makes what is missing or stale: pipeline, tables, target. Answers how rays are cast.
#[expect(clippy::too_many_arguments, reason = "what one draw depends on")]
fn prepare(
    gpu: &Gpu,
    picture: &Picture,
    kinds: Kinds,
    volumes: &[VolumeData],
    frame: &FrameBuffers,
    plan: impl Fn(&Variant) -> Plan,
    caster: &mut RayCaster,
    report: &mut Report,
) -> Result<Plan, GpuError> {
    let readings =
        volumes.iter().map(|volume| Reading::of(volume.texture.format, &volume.classified)).collect();
    let light_volumes = shadows(volumes).iter().map(Option::is_some).collect();
    let lights_of = |volume: &VolumeData| volume.light_volumes.map_or(0, |own| own.0.len() as u32);
    let light_counts = volumes.iter().map(lights_of).collect();
    let near_of = |volume: &VolumeData| volume.light_volumes?.0.iter().map(LightVolume::near).max();
    let near = volumes.iter().map(|volume| near_of(volume).unwrap_or(0)).collect();
    let scattered = volumes.iter().map(scattered_of).collect();
    let manners = volumes.iter().map(manner_of).collect();
    let light_capacity = frame.light_capacity;
    let mut variant = Variant {
        readings,
        manners,
        light_capacity,
        kinds,
        light_volumes,
        light_counts,
        near,
        scattered,
        light_filtering: lookup::filtering(gpu),
        share: None,
    };
    let plan = plan(&variant);
    variant.share = plan.share;
    caster.draws.get(variant, |variant| {
        report.pipelines.push("raycast");
        make(gpu, variant)
    })?;
    if caster.tables.as_ref().is_none_or(|tables| tables.starts.len() != volumes.len())
        || volumes.iter().any(|volume| volume.classified.is_changed())
    {
        let tables = tables(gpu, volumes);
        report.gpu_bytes.insert("lookup tables", tables.bytes.0);
        report.gpu_bytes.insert("brick distances", tables.bytes.1);
        caster.tables = Some(tables);
    }
    caster.sampler.get_or_insert_with(|| {
        gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("volume"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        })
    });
    let size = wgpu::Extent3d { width: picture.size.x, height: picture.size.y, depth_or_array_layers: 1 };
    if caster.target.as_ref().is_none_or(|target| target.texture.size() != size) {
        caster.target = None;
        let target = Target::new(gpu, "raycast", picture.size, FORMAT)?;
        report.gpu_bytes.insert("raycast", target.bytes());
        caster.target = Some(target);
    }
    Ok(plan)
}

/// The shadow on each of them.
fn shadows<'a>(volumes: &[VolumeData<'a>]) -> Vec<Option<&'a VolumeShadow>> {
    let of_volume = |volume: &VolumeData<'a>| {
        let (all, shadows) = (volume.light_volumes.into_iter().flat_map(|own| &own.0), volume.shadows);
        all.map(|own| shadows?.of(own.light)).collect::<Vec<_>>()
    };
    volumes.iter().flat_map(of_volume).collect()
}

/// The light volumes of all volumes, in order.
fn light_volumes<'a>(volumes: &[VolumeData<'a>]) -> Vec<&'a LightVolume> {
    volumes.iter().filter_map(|volume| volume.light_volumes).flat_map(|own| &own.0).collect()
}

#[expect(clippy::too_many_arguments, reason = "what one draw reads")]
fn draw(
    gpu: &Gpu,
    frame: &FrameBuffers,
    background: Vec3,
    volumes: &[VolumeData],
    parts: &[(Pixels, Vec<VolumeInstance>)],
    surface: &Surface,
    caster: &mut RayCaster,
    plan: Plan,
    timing: Option<wgpu::RenderPassTimestampWrites>,
) -> Result<(), GpuError> {
    let RayCaster { draws, rays, tables, target, sampler } = caster;
    let (Some(draw), Some(tables), Some(target), Some(sampler)) = (draws.last(), tables, target, sampler)
    else {
        return Ok(());
    };
    let instances_in = |(_, instances): &(_, Vec<VolumeInstance>)| {
        uniform_array(gpu, "volume instances", instances, instances.len())
    };
    let instances: Vec<_> = parts.iter().map(instances_in).collect();
    let Some(first) = instances.first() else { return Ok(()) };
    let (entries, distances) = (view_of(&tables.entries), view_of(&tables.distances));
    let far_away;
    let behind = match surface.colour() {
        Some(target) => &target.view,
        None => {
            far_away = far_away_texture(gpu, background);
            &far_away
        }
    };
    let mut resources = vec![
        frame.frame.as_entire_binding(),
        frame.lights.as_entire_binding(),
        first.as_entire_binding(),
        wgpu::BindingResource::TextureView(&entries),
        wgpu::BindingResource::TextureView(&distances),
        wgpu::BindingResource::TextureView(behind),
        wgpu::BindingResource::Sampler(sampler),
    ];
    resources.extend(volumes.iter().map(|volume| wgpu::BindingResource::TextureView(&volume.texture.view)));
    let light_volumes = light_volumes(volumes);
    let (sweeps, repeating) = (lookup::sweeps(gpu, &light_volumes), lookup::sampler(gpu));
    resources.extend(lookup::resources(&light_volumes, &sweeps, &repeating));
    let shadows: Vec<&VolumeShadow> = shadows(volumes).into_iter().flatten().collect();
    let shadow_places = volume_shadow::places(gpu, &shadows);
    resources.extend(volume_shadow::resources(&shadows, &shadow_places));
    let textured = volumes.iter().filter(|volume| manner_of(volume).has_texture());
    let classified = textured.filter_map(|volume| match classification_of(volume) {
        Classification::PreIntegrated => volume.pairs.map(|pairs| &pairs.view),
        _ => volume.voxels.map(|voxels| &voxels.view),
    });
    resources.extend(classified.map(wgpu::BindingResource::TextureView));
    let scattered = volumes.iter().filter_map(|volume| Some((volume.summed?, volume.eye_light)));
    let grids = scattered.flat_map(|(summed, eye_light)| {
        std::iter::once(&summed.fluence).chain(eye_light.map(|eye_light| &eye_light.grid))
    });
    resources.extend(grids.map(|grid| wgpu::BindingResource::TextureView(&grid.view)));
    let mut bound = Vec::new();
    for ((pixels, _), instances) in parts.iter().zip(&instances) {
        resources[INSTANCES] = instances.as_entire_binding();
        bound.push((pixels.clone(), resources.clone()));
    }
    // The last number counts samples, or says what is hidden: neither there.
    let [r, g, b] = background.to_array().map(f64::from);
    let beside = wgpu::Color { r, g, b, a: 0.0 };
    if plan.share.is_some() {
        let rectangles = Rectangles { parts: bound, beside, target: &target.view };
        return rays.draw(gpu, draw, (plan, volumes.len()), rectangles, timing);
    }
    let bound: Vec<_> =
        bound.into_iter().map(|(Pixels { columns, rows }, resources)| ([columns, rows], resources)).collect();
    draw.cover_parts(gpu, &bound, beside, &target.view, timing);
    Ok(())
}

/// One texel that says: background, infinitely far away.
fn far_away_texture(gpu: &Gpu, background: Vec3) -> wgpu::TextureView {
    let texel = background.extend(FAR).to_array();
    view_of(&texture_of(gpu, "background", UVec2::ONE, FORMAT, bytemuck::bytes_of(&texel)))
}
