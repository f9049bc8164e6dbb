//! How shaders look light volumes up: bindings, and the module made for as many as there are.

use super::LightVolume;
use super::sweep::SweepUniform;
use crate::gpu::{Filtering, Gpu, binding, uniform_array};
use std::fmt::Write;

/// Who interpolates light volumes on this adapter.
pub(crate) fn filtering(gpu: &Gpu) -> Filtering {
    match gpu.has(wgpu::Features::FLOAT32_FILTERABLE) {
        true => Filtering::Sampler,
        false => Filtering::Shader,
    }
}

/// What it is without any.
const NONE: &str = "#import sweep
const SWEEPS = 0u;
fn light_depth(index: u32, place: vec3f) -> f32 {
    return 0.0;
}
fn light_way(index: u32, start: vec3f, direction: vec3f) -> LightWay {
    return LightWay();
}
fn light_depth_on(index: u32, way: LightWay, along: f32) -> f32 {
    return 0.0;
}
fn light_step(index: u32) -> vec4f {
    return vec4f(0.0);
}
";

/// The module `light_volumes` of a shader that looks up `count` light volumes: `light_depth(index, place)` is the optical depth
/// towards the light, `light_left` the share of it that arrives, and `light_depth_on(index, way, along)` the depth on a straight way, of which
/// `light_way` has found out before what it takes. `light_step` is how far light travels from slice to slice, in the texture of the volume
/// and in scene units. Its bindings, from `first` on: the sweeps, a sampler, and one texture
/// each; none at all for none.
pub(crate) fn light_volumes_module(
    count: usize,
    filtering: Filtering,
    first: usize,
) -> (&'static str, String) {
    if count == 0 {
        return ("light_volumes", NONE.into());
    }
    let mut text = format!(
        "#import sweep\nconst SWEEPS = {count}u;\n@group(0) @binding({first}) var<uniform> sweeps: array<Sweep, SWEEPS>;\n\
         @group(0) @binding({}) var repeating: sampler;\n",
        first + 1
    );
    let [mut depths, mut ways, mut on_ways, mut steps] = [const { String::new() }; 4];
    for index in 0..count {
        let binding = first + 2 + index;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "@group(0) @binding({binding}) var light_{index}: texture_3d<f32>;");
        let value = match filtering {
            Filtering::Sampler => format!("textureSampleLevel(light_{index}, repeating, at, 0.0).r"),
            Filtering::Shader => {
                text.push_str(&eight_loads(index));
                format!("mean_{index}(sweeps[{index}], at)")
            }
        };
        let label = if index == 0 { "default".into() } else { format!("case {index}u") };
        // Of each the number as it is: software adapters fetch what an index points at lane by lane.
        let sweep = format!("sweeps[{index}]");
        let _ = writeln!(
            depths,
            "        {label}: {{
            let at = ({sweep}.texel_from_texture * vec4f(place, 1.0)).xyz;
            return {value} * light_reach({sweep}, place);
        }}"
        );
        let _ = writeln!(ways, "        {label}: {{ return way_through({sweep}, start, direction); }}");
        let _ = writeln!(steps, "        {label}: {{ return vec4f({sweep}.step, {sweep}.slice); }}");
        let _ = writeln!(
            on_ways,
            "        {label}: {{
            let at = way.texel + way.texel_pace * along;
            return {value} * reach_on(way, along);
        }}"
        );
    }
    let _ = write!(
        text,
        "fn light_depth(index: u32, place: vec3f) -> f32 {{
    switch index {{\n{depths}    }}
}}
fn light_way(index: u32, start: vec3f, direction: vec3f) -> LightWay {{
    switch index {{\n{ways}    }}
}}
fn light_depth_on(index: u32, way: LightWay, along: f32) -> f32 {{
    switch index {{\n{on_ways}    }}
}}
fn light_step(index: u32) -> vec4f {{
    switch index {{\n{steps}    }}
}}
fn light_left(index: u32, place: vec3f) -> f32 {{
    return exp(-light_depth(index, place));
}}
"
    );
    ("light_volumes", text)
}

/// Trilinear interpolation with eight loads, repeated across.
fn eight_loads(index: usize) -> String {
    format!(
        "fn mean_{index}(sweep: Sweep, place: vec3f) -> f32 {{
    let at = place * sweep.size - 0.5;
    let low = vec3i(floor(at));
    let part = at - floor(at);
    var sum = 0.0;
    for (var corner = 0; corner < 8; corner += 1) {{
        let which = vec3i(corner & 1, (corner >> 1u) & 1, corner >> 2u);
        let weight = mix(1.0 - part, part, vec3f(which));
        sum += weight.x * weight.y * weight.z * textureLoad(light_{index}, light_texel(sweep, low + which), 0).r;
    }}
    return sum;
}}
"
    )
}

/// What is bound for that module.
pub(crate) fn bindings(count: usize, filtering: Filtering) -> Vec<wgpu::BindingType> {
    if count == 0 {
        return Vec::new();
    }
    let texture = binding::texture(wgpu::TextureViewDimension::D3, filtering == Filtering::Sampler);
    [binding::UNIFORM, binding::SAMPLER].into_iter().chain((0..count).map(|_| texture)).collect()
}

/// The sweeps of light volumes, in the order in which they are bound.
pub(crate) fn sweeps(gpu: &Gpu, volumes: &[&LightVolume]) -> wgpu::Buffer {
    let sweeps: Vec<SweepUniform> = volumes.iter().map(|volume| volume.lookup()).collect();
    uniform_array(gpu, "sweeps", &sweeps, sweeps.len().max(1))
}

/// A sampler that repeats across and clamps along.
pub(crate) fn sampler(gpu: &Gpu) -> wgpu::Sampler {
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("light volume"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

/// The resources of those bindings.
pub(crate) fn resources<'a>(
    volumes: &[&'a LightVolume],
    sweeps: &'a wgpu::Buffer,
    sampler: &'a wgpu::Sampler,
) -> Vec<wgpu::BindingResource<'a>> {
    if volumes.is_empty() {
        return Vec::new();
    }
    let textures = volumes.iter().map(|volume| wgpu::BindingResource::TextureView(&volume.grid.view));
    [sweeps.as_entire_binding(), wgpu::BindingResource::Sampler(sampler)]
        .into_iter()
        .chain(textures)
        .collect()
}
