//! The ray caster's pipeline, and the modules of its shader that are made for what is in a scene.

use super::FORMAT;
use super::parts::{self, Share};
use crate::gpu::{Draw, DrawDescriptor, Filtering, Gpu, GpuError, binding};
use crate::passes::classification::Manner;
use crate::passes::light_volume::cells::{LEAST_LOOKED, NEAR_SAMPLES};
use crate::passes::light_volume::lookup;
use crate::passes::lighting::Kinds;
use crate::passes::voxels::{self, Reading};
use crate::passes::{classification, volume_shadow};
use crate::view::lights_module;
use std::fmt::Write;

/// What a pipeline is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// One for each volume.
    pub readings: Vec<Reading>,
    /// One for each volume.
    pub manners: Vec<Manner>,
    pub light_capacity: usize,
    /// How volumes are lit, which costs more than the rest together.
    pub kinds: Kinds,
    /// For each light volume of all volumes together whether meshes shadow it.
    pub light_volumes: Vec<bool>,
    /// How many of them are each volume's.
    pub light_counts: Vec<u32>,
    /// How many slices of them rays look through for themselves, in each volume.
    pub near: Vec<u32>,
    /// What scattered light each volume has.
    pub scattered: Vec<Scattered>,
    /// Who interpolates light volumes.
    pub light_filtering: Filtering,
    /// How rays are shared out over draws, where one is not enough.
    pub share: Option<Share>,
}

/// Bindings of the shader in front of the volume textures.
pub(crate) const FIXED_BINDINGS: usize = 7;

/// Compiles the shader for a variant.
pub fn make(gpu: &Gpu, variant: &Variant) -> Result<Draw, GpuError> {
    let fixed = [
        binding::UNIFORM,
        binding::UNIFORM,
        binding::UNIFORM,
        binding::TEXTURE,
        binding::INTEGERS,
        binding::TEXTURE,
        binding::SAMPLER,
    ];
    let textures = variant.readings.iter().map(|reading| reading.binding());
    let filtering = variant.light_filtering;
    let light_volumes = lookup::bindings(variant.light_volumes.len(), filtering);
    let shadows = volume_shadow::bindings(&variant.light_volumes);
    let scattered: usize = variant.scattered.iter().map(|scattered| scattered.textures()).sum();
    let scattered = std::iter::repeat_n(binding::texture(wgpu::TextureViewDimension::D3, true), scattered);
    let first = FIXED_BINDINGS + variant.readings.len();
    let first_shadow = first + light_volumes.len();
    let first_classified = first_shadow + shadows.len();
    let classified = classification::bindings(&variant.manners);
    let first_scattered = first_classified + classified.len();
    let mut bindings: Vec<_> = fixed
        .into_iter()
        .chain(textures)
        .chain(light_volumes)
        .chain(shadows)
        .chain(classified)
        .chain(scattered)
        .collect();
    let parts = parts::module(variant.share, bindings.len());
    let (name, fragment) = match variant.share {
        None => ("raycast", "march"),
        Some(_) => ("raycast_parts", "march_on"),
    };
    if variant.share.is_some() {
        bindings.extend([binding::UNIFORM, binding::STORAGE_OUT]);
    }
    Draw::new(
        gpu,
        &DrawDescriptor {
            name,
            generated: &[
                parts,
                ("volumes", voxels::module(&variant.readings, FIXED_BINDINGS)),
                variant.kinds.module(),
                sweeps_module(&variant.light_counts, &variant.near),
                classifications_module(&variant.manners, first_classified),
                lights_module(variant.light_capacity),
                lookup::light_volumes_module(variant.light_volumes.len(), filtering, first),
                volume_shadow::module(&variant.light_volumes, first_shadow),
                scattered_module(&variant.scattered, first_scattered),
            ],
            entry_points: ("cover", fragment),
            bindings: &bindings,
            vertex_buffers: &[],
            instances: &[],
            format: FORMAT,
            depth: false,
        },
    )
}

/// The WGSL module `first_sweeps`: which light volume is the first of each volume, and how many of its slices rays look through for themselves.
///
/// Not in a uniform: lavapipe compiles a shader anew for the values of uniforms that it branches on, whichever shadow is meant among them, and
/// with them for others, which change from frame to frame; and it keeps all that it compiled.
pub(crate) fn sweeps_module(counts: &[u32], near: &[u32]) -> (&'static str, String) {
    let mut text = format!(
        "const ANY_NEAR = {};\nconst NEAR_SAMPLES = {NEAR_SAMPLES}u;\nconst LEAST_LOOKED = {LEAST_LOOKED:?};\n",
        near.iter().any(|slices| *slices > 0)
    );
    let first = counts.iter().scan(0, |next, count| Some(std::mem::replace(next, *next + count)));
    for (name, values) in [("first_sweep", first.collect()), ("near_slices", near.to_vec())] {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "fn {name}(volume: u32) -> u32 {{\n    switch volume {{");
        for (volume, value) in values.iter().enumerate() {
            let _ = writeln!(text, "        case {volume}u: {{ return {value}u; }}");
        }
        text.push_str("        default: { return 0u; }\n    }\n}\n");
    }
    ("first_sweeps", text)
}

/// The WGSL module `parts` of a shader that casts rays in parts, as an example.
pub(crate) fn parts_module(binding: usize) -> (&'static str, String) {
    parts::module(Some(Share::default()), binding)
}

/// The WGSL module `classifications`, whose textures are bound behind all others.
pub(crate) fn classifications_module(manners: &[Manner], first_binding: usize) -> (&'static str, String) {
    ("classifications", classification::module(manners, first_binding))
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
    /// How many of them there are.
    pub fn textures(self) -> usize {
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
