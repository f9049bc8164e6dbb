//! Volumes by ray casting, over what the surface pass left.
//!
//! Reads volume textures, lookup tables, brick distances and the surface; writes [`RayCaster::radiance`], rgba32float, one texel a
//! pixel: radiance, and how many samples it took. Runs each frame in which a volume is there. The shader is made for the number of volumes,
//! since each needs a texture binding of its own: their number is limited by what the adapter can bind at once.

use super::classification;
use super::classify::{Classified, classify};
use super::eye_light::EyeLight;
use super::light_budget::KeptLights;
use super::light_volume::{LightVolume, LightVolumes, lighting_in_force, lookup, scene_from_texture};
use super::lighting::{EMITS, GRADIENT, Kinds, SCATTERS, SCATTERS_ONCE, SCATTERS_TOWARDS_EYE, UNLIT};
use super::preclassify::{ClassifiedVoxels, Preclassifier, preclassify};
use super::preintegrate::{PreintegratedPairs, preintegrate};
use super::summed_light::SummedLight;
use super::surface::Surface;
use super::upload::{SENTINEL_THRESHOLD, VolumeTexture, VolumeUploadPlugin};
use super::volume_shadow::{self, VolumeShadow, VolumeShadows};
use crate::components::{
    Classification, Placement, RayCast as RayCastSettings, SceneSettings, Shading, VolumeLighting,
};
use crate::failure::Failure;
use crate::gpu::{
    Draw, DrawDescriptor, Filtering, Gpu, GpuError, PassTimer, Target, binding, texture_of, uniform_array,
};
use crate::loading::LoadedVolume;
use crate::optics::peak::Peak;
use crate::scene::{Problem, Problems};
use crate::sources::BrickRanges;
use crate::view::{
    Coarseness, Comparison, FrameBuffers, Part, Picture, Pixels, View, covered, far_background, in_parts,
    is_wanted, lights_module,
};
use crate::{Stage, mirrors::mirror, report::Report};
use bevy_app::{App, Plugin, Update};
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use glam::{DAffine3, DVec3, Mat4, UVec2, UVec3, Vec3, Vec4};
use std::fmt::Write;

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
    /// The pipeline, and what it is made for.
    draw: Option<(Variant, Draw)>,
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

/// What a pipeline is made for.
#[derive(Clone, Debug, PartialEq)]
struct Variant {
    /// One for each volume.
    filtering: Vec<Filtering>,
    /// One for each volume.
    classifications: Vec<Classification>,
    light_capacity: usize,
    /// How volumes are lit, which costs more than the rest together.
    kinds: Kinds,
    /// For each light volume of all volumes together whether meshes shadow it.
    light_volumes: Vec<bool>,
    /// What scattered light each volume has.
    scattered: Vec<Scattered>,
}

/// The lookup tables and brick distances of all volumes.
#[derive(Debug)]
struct Tables {
    /// One row a volume.
    entries: wgpu::Texture,
    /// One behind the other, in rows of [`BRICK_ROW`].
    distances: wgpu::Texture,
    /// First brick of each volume.
    starts: Vec<u32>,
    bytes: (u64, u64),
}

/// Bricks in a row of their texture.
pub(crate) const BRICK_ROW: u32 = 2048;

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
        bricks_start: u32,
        bricks: UVec3,
        least_transmittance: f32,
        skip_empty: u32,
        lighting: u32,
        ambient: f32,
        diffuse: f32,
        specular: f32,
        shininess: f32,
        sentinel: f32,
        reach: f32,
        g: f32,
        emission: f32,
        first_sweep: u32,
        fluence_scale: f32,
        peak_cap: f32,
        greatest_colour: f32,
        greatest_extinction: f32,
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Textures of the shader besides those of volumes.
const OTHER_TEXTURES: usize = 3;

/// Which binding has the volumes as they are drawn in a part of the picture.
const INSTANCES: usize = 2;

/// Bindings of the shader in front of the volume textures.
pub(crate) const FIXED_BINDINGS: usize = 7;

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
    (gpu, frame, view, picture, settings): (
        Res<Gpu>,
        Res<FrameBuffers>,
        Res<View>,
        Res<Picture>,
        Res<SceneSettings>,
    ),
    (comparison, coarseness, kept_lights): (Res<Comparison>, Res<Coarseness>, Res<KeptLights>),
    volumes: Query<VolumeQuery>,
    surface: Res<Surface>,
    mut caster: ResMut<RayCaster>,
    mut timer: Option<ResMut<PassTimer>>,
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
    let drawn = prepare(&gpu, &picture, kinds, &volumes, &frame, &mut caster, &mut report).map(|()| {
        let boxes =
            volumes.iter().map(|volume| scene_from_texture(volume.loaded, volume.placement, &settings));
        // Beside the volumes there is nothing but the background, unless there are meshes.
        let pixels = match surface.colour() {
            Some(_) => Pixels::all(picture.size),
            None => covered(&view, picture.size, boxes),
        };
        let of_part = |Part { columns, shading }: Part| {
            let instances = instances((&view, &coarseness), &settings, &volumes, shading, &caster);
            (pixels.within(&columns), instances)
        };
        let parts: Vec<_> = parts.into_iter().map(of_part).collect();
        draw(&gpu, &frame, &settings, &volumes, &parts, &surface, &caster, timing);
        report.ran("raycast", &[("pixels", parts.iter().map(|(pixels, _)| pixels.count()).sum())]);
    });
    failure.keep(drawn);
}

/// Textures that volumes and their light may have between them.
pub(crate) fn textures_for_volumes(gpu: &Gpu) -> usize {
    gpu.device.limits().max_sampled_textures_per_shader_stage as usize - OTHER_TEXTURES
}

/// What is told where volumes and their light volumes are more textures than can be bound.
fn too_many(volumes: &[VolumeData], limit: usize) -> Option<Problem> {
    let classified =
        volumes.iter().filter(|volume| classification_of(volume) != Classification::Post).count();
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

/// Makes what is missing or stale: pipeline, tables, target.
fn prepare(
    gpu: &Gpu,
    picture: &Picture,
    kinds: Kinds,
    volumes: &[VolumeData],
    frame: &FrameBuffers,
    caster: &mut RayCaster,
    report: &mut Report,
) -> Result<(), GpuError> {
    let filtering = volumes.iter().map(|volume| volume.texture.format.filtering).collect();
    let light_volumes = shadows(volumes).iter().map(Option::is_some).collect();
    let scattered = volumes.iter().map(scattered_of).collect();
    let classifications = volumes.iter().map(classification_of).collect();
    let light_capacity = frame.light_capacity;
    let variant = Variant { filtering, classifications, light_capacity, kinds, light_volumes, scattered };
    if caster.draw.as_ref().is_none_or(|(made_for, _)| *made_for != variant) {
        caster.draw = Some((variant.clone(), make(gpu, &variant)?));
        report.pipelines.push("raycast");
    }
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
    Ok(())
}

fn make(gpu: &Gpu, variant: &Variant) -> Result<Draw, GpuError> {
    let fixed = [
        binding::UNIFORM,
        binding::UNIFORM,
        binding::UNIFORM,
        binding::TEXTURE,
        binding::INTEGERS,
        binding::TEXTURE,
        binding::SAMPLER,
    ];
    let textures = variant
        .filtering
        .iter()
        .map(|filtering| binding::texture(wgpu::TextureViewDimension::D3, *filtering == Filtering::Sampler));
    let light_volumes = lookup::bindings(variant.light_volumes.len(), lookup::filtering(gpu));
    let shadows = volume_shadow::bindings(&variant.light_volumes);
    let scattered: usize = variant.scattered.iter().map(|scattered| scattered.textures()).sum();
    let scattered = std::iter::repeat_n(binding::texture(wgpu::TextureViewDimension::D3, true), scattered);
    let first = FIXED_BINDINGS + variant.filtering.len();
    let first_shadow = first + light_volumes.len();
    let first_classified = first_shadow + shadows.len();
    let classified = classification::bindings(&variant.classifications);
    let first_scattered = first_classified + classified.len();
    let bindings: Vec<_> = fixed
        .into_iter()
        .chain(textures)
        .chain(light_volumes)
        .chain(shadows)
        .chain(classified)
        .chain(scattered)
        .collect();
    Draw::new(
        gpu,
        &DrawDescriptor {
            name: "raycast",
            generated: &[
                ("volumes", volumes_module(&variant.filtering, FIXED_BINDINGS)),
                variant.kinds.module(),
                classifications_module(&variant.classifications, first_classified),
                lights_module(variant.light_capacity),
                lookup::light_volumes_module(variant.light_volumes.len(), lookup::filtering(gpu), first),
                volume_shadow::module(&variant.light_volumes, first_shadow),
                scattered_module(&variant.scattered, first_scattered),
            ],
            entry_points: ("cover", "march"),
            bindings: &bindings,
            vertex_buffers: &[],
            format: FORMAT,
            depth: false,
        },
    )
}

/// The WGSL module `classifications`, whose textures are bound behind all others.
pub(crate) fn classifications_module(
    classifications: &[Classification],
    first_binding: usize,
) -> (&'static str, String) {
    ("classifications", classification::module(classifications, first_binding))
}

/// The WGSL module `volumes`: one texture binding a volume, and `texel_at(volume, place)` that interpolates in it.
pub(crate) fn volumes_module(filtering: &[Filtering], first_binding: usize) -> String {
    let brick = BrickRanges::BRICK;
    let count = filtering.len();
    let mut text =
        format!("const VOLUMES = {count}u;\nconst BRICK_ROW = {BRICK_ROW}u;\nconst BRICK = {brick}.0;\n");
    let mut cases = String::new();
    for (index, filtering) in filtering.iter().enumerate() {
        let binding = first_binding + index;
        let value = match filtering {
            Filtering::Sampler => format!("textureSampleLevel(volume_{index}, linear_sampler, place, 0.0).r"),
            Filtering::Shader => {
                text.push_str(&eight_loads(index));
                format!("trilinear_{index}(place)")
            }
        };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "@group(0) @binding({binding}) var volume_{index}: texture_3d<f32>;");
        let label = if index == 0 { "default".into() } else { format!("case {index}u") };
        let _ = writeln!(cases, "        {label}: {{ return {value}; }}");
    }
    let _ = write!(
        text,
        "fn texel_at(volume: u32, place: vec3f) -> f32 {{\n    switch volume {{\n{cases}    }}\n}}\n"
    );
    text
}

/// What is looked up of light that was scattered before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scattered {
    /// Nothing.
    Nothing,
    /// Fluence.
    Fluence,
    /// Fluence, and light that goes on towards the eye.
    TowardsEye,
}

impl Scattered {
    fn textures(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Fluence => 1,
            Self::TowardsEye => 2,
        }
    }
}

/// The WGSL module `scattered`: `fluence_at(volume, place)` and `eye_light_at`, of the volumes that have scattered light.
pub(crate) fn scattered_module(scattered: &[Scattered], first: usize) -> (&'static str, String) {
    let mut text = String::new();
    let mut binding = first;
    let mut cases = [String::new(), String::new()];
    for (index, scattered) in scattered.iter().enumerate() {
        for (name, cases) in ["fluence", "eye_light"].iter().zip(&mut cases).take(scattered.textures()) {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "@group(0) @binding({binding}) var {name}_{index}: texture_3d<f32>;");
            let sample = format!("textureSampleLevel({name}_{index}, linear_sampler, place, 0.0).rgb");
            let _ = writeln!(cases, "        case {index}u: {{ return {sample}; }}");
            binding += 1;
        }
    }
    for (name, cases) in ["fluence", "eye_light"].iter().zip(cases) {
        let _ = write!(
            text,
            "fn {name}_at(volume: u32, place: vec3f) -> vec3f {{\n    switch volume {{\n{cases}        \
             default: {{ return vec3f(0.0); }}\n    }}\n}}\n"
        );
    }
    ("scattered", text)
}

/// Trilinear interpolation with eight loads, clamped at the border.
fn eight_loads(index: usize) -> String {
    format!(
        "fn trilinear_{index}(place: vec3f) -> f32 {{
    let last = vec3i(textureDimensions(volume_{index})) - 1;
    let at = place * vec3f(textureDimensions(volume_{index})) - 0.5;
    let low = vec3i(floor(at));
    let part = at - floor(at);
    var rows: array<f32, 4>;
    for (var row = 0; row < 4; row += 1) {{
        let y = low.y + (row & 1);
        let z = low.z + (row >> 1u);
        let a = textureLoad(volume_{index}, clamp(vec3i(low.x, y, z), vec3i(0), last), 0).r;
        let b = textureLoad(volume_{index}, clamp(vec3i(low.x + 1, y, z), vec3i(0), last), 0).r;
        rows[row] = mix(a, b, part.x);
    }}
    return mix(mix(rows[0], rows[1], part.y), mix(rows[2], rows[3], part.y), part.z);
}}
"
    )
}

fn tables(gpu: &Gpu, volumes: &[VolumeData]) -> Tables {
    let width = volumes.iter().map(|volume| volume.classified.table.entries.len()).max().unwrap_or(1);
    let (mut entries, mut distances, mut starts) = (Vec::new(), Vec::new(), Vec::new());
    for VolumeData { classified, .. } in volumes {
        starts.push(distances.len() as u32);
        entries.extend_from_slice(&classified.table.entries);
        entries.resize(entries.len().next_multiple_of(width), Vec4::ZERO);
        distances.extend_from_slice(&classified.distances);
    }
    distances.resize(distances.len().next_multiple_of(BRICK_ROW as usize), 0);
    let entries_size = UVec2::new(width as u32, volumes.len() as u32);
    let distances_size = UVec2::new(BRICK_ROW, (distances.len() / BRICK_ROW as usize) as u32);
    let texels: &[u8] = bytemuck::cast_slice(&entries);
    Tables {
        entries: texture_of(gpu, "lookup tables", entries_size, FORMAT, texels),
        distances: texture_of(
            gpu,
            "brick distances",
            distances_size,
            wgpu::TextureFormat::R8Uint,
            &distances,
        ),
        starts,
        bytes: (texels.len() as u64, distances.len() as u64),
    }
}

fn instances(
    view: (&View, &Coarseness),
    settings: &SceneSettings,
    volumes: &[VolumeData],
    shading: Shading,
    caster: &RayCaster,
) -> Vec<VolumeInstance> {
    let starts = caster.tables.as_ref().map(|tables| tables.starts.as_slice()).unwrap_or_default();
    let mut first_sweep = 0;
    let mut all = Vec::new();
    for (volume, start) in volumes.iter().zip(starts) {
        all.push(instance(
            view,
            volume,
            scene_from_texture(volume.loaded, volume.placement, settings),
            lit(volume, settings, shading),
            *start,
            first_sweep,
        ));
        first_sweep += volume.light_volumes.map_or(0, |own| own.0.len() as u32);
    }
    all
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

fn instance(
    (view, coarseness): (&View, &Coarseness),
    volume: &VolumeData,
    scene_from_texture: DAffine3,
    lit: Lit,
    bricks_start: u32,
    first_sweep: u32,
) -> VolumeInstance {
    let VolumeData { loaded, classified, texture, ray_cast, voxels, summed, .. } = volume;
    let eye_from_texture = view.eye_from_scene * scene_from_texture;
    let size = DVec3::from(loaded.data.size.map(f64::from));
    let axes = eye_from_texture.matrix3;
    let voxel =
        (axes.x_axis.length() / size.x).min(axes.y_axis.length() / size.y).min(axes.z_axis.length() / size.z);
    let (lookup_scale, lookup_offset) = classified.lookup(texture.format);
    let [greatest_colour, greatest_extinction] = voxels.map_or([1.0; 2], |voxels| voxels.greatest);
    let coarser = match classification_of(volume) {
        Classification::PreIntegrated => 1.0,
        _ => coarseness.step,
    };
    VolumeInstance {
        texture_from_eye: glam::DMat4::from(eye_from_texture.inverse()).as_mat4(),
        size: size.as_vec3(),
        step: (voxel * f64::from(ray_cast.step * coarser)) as f32,
        lookup_scale,
        lookup_offset,
        table_entries: classified.table.entries.len() as u32,
        bricks_start,
        bricks: UVec3::from(classified.bricks),
        least_transmittance: 1.0 - ray_cast.early_termination,
        skip_empty: u32::from(ray_cast.skip_empty),
        lighting: lit.kind,
        ambient: lit.ambient,
        diffuse: lit.diffuse,
        specular: lit.specular,
        shininess: lit.shininess,
        sentinel: SENTINEL_THRESHOLD,
        reach: view.reach as f32,
        g: lit.g,
        emission: lit.emission,
        first_sweep,
        fluence_scale: summed.map_or(0.0, |summed| summed.scale),
        peak_cap: Peak::new(f64::from(lit.g)).cap.min(f64::from(f32::MAX)) as f32,
        greatest_colour,
        greatest_extinction,
    }
}

/// How a volume is lit where the picture is shaded so.
fn lit(volume: &VolumeData, settings: &SceneSettings, shading: Shading) -> Lit {
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
pub(super) struct Lit {
    pub(super) kind: u32,
    ambient: f32,
    diffuse: f32,
    pub(super) specular: f32,
    shininess: f32,
    pub(super) g: f32,
    emission: f32,
    /// Whether there is light of lights that share a sum.
    pub(super) shares: bool,
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

#[expect(clippy::too_many_arguments, reason = "what one draw reads")]
fn draw(
    gpu: &Gpu,
    frame: &FrameBuffers,
    settings: &SceneSettings,
    volumes: &[VolumeData],
    parts: &[(Pixels, Vec<VolumeInstance>)],
    surface: &Surface,
    caster: &RayCaster,
    timing: Option<wgpu::RenderPassTimestampWrites>,
) {
    let (Some((_, draw)), Some(tables), Some(target), Some(sampler)) =
        (&caster.draw, &caster.tables, &caster.target, &caster.sampler)
    else {
        return;
    };
    let instances_in = |(_, instances): &(_, Vec<VolumeInstance>)| {
        uniform_array(gpu, "volume instances", instances, instances.len())
    };
    let instances: Vec<_> = parts.iter().map(instances_in).collect();
    let Some(first) = instances.first() else { return };
    let (entries, distances) = (view_of(&tables.entries), view_of(&tables.distances));
    let background;
    let behind = match surface.colour() {
        Some(target) => &target.view,
        None => {
            background = background_texture(gpu, settings);
            &background
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
    let classified = volumes.iter().filter_map(|volume| match classification_of(volume) {
        Classification::Post => None,
        Classification::Pre => volume.voxels.map(|voxels| &voxels.view),
        Classification::PreIntegrated => volume.pairs.map(|pairs| &pairs.view),
    });
    resources.extend(classified.map(wgpu::BindingResource::TextureView));
    let scattered = volumes.iter().filter_map(|volume| Some((volume.summed?, volume.eye_light)));
    let grids = scattered.flat_map(|(summed, eye_light)| {
        std::iter::once(&summed.fluence).chain(eye_light.map(|eye_light| &eye_light.grid))
    });
    resources.extend(grids.map(|grid| wgpu::BindingResource::TextureView(&grid.view)));
    let mut bound = Vec::new();
    for ((Pixels { columns, rows }, _), instances) in parts.iter().zip(&instances) {
        resources[INSTANCES] = instances.as_entire_binding();
        bound.push(([columns.clone(), rows.clone()], resources.clone()));
    }
    // The last number counts samples.
    let [r, g, b] = settings.background.to_array().map(f64::from);
    draw.cover_parts(gpu, &bound, wgpu::Color { r, g, b, a: 0.0 }, &target.view, timing);
}

fn view_of(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

/// One texel that says: background, infinitely far away.
fn background_texture(gpu: &Gpu, settings: &SceneSettings) -> wgpu::TextureView {
    let texel = far_background(settings).to_array();
    view_of(&texture_of(gpu, "background", UVec2::ONE, FORMAT, bytemuck::bytes_of(&texel)))
}
