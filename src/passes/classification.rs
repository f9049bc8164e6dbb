//! What the ray caster binds for volumes that are not classified sample by sample, and the WGSL that reads it.

use crate::components::Classification;
use crate::gpu::binding;
use std::fmt::Write;

/// What a shader calls each classification.
fn number(classification: Classification) -> u32 {
    match classification {
        Classification::Post => 0,
        Classification::Pre => 1,
        Classification::PreIntegrated => 2,
    }
}

/// How the texture of each volume that has one is bound, in order.
pub(crate) fn bindings(classifications: &[Classification]) -> Vec<wgpu::BindingType> {
    let kind = |classification: &Classification| match classification {
        Classification::Post => None,
        Classification::Pre => Some(binding::texture(wgpu::TextureViewDimension::D3, true)),
        Classification::PreIntegrated => Some(binding::TEXTURE),
    };
    classifications.iter().filter_map(kind).collect()
}

/// The WGSL module `classifications`: how each volume is classified, those textures from a binding on, and functions that read that of a volume. Where no volume has
/// such a texture a constant says so, and the shader is what it would be without.
pub(crate) fn module(classifications: &[Classification], first_binding: usize) -> String {
    let has = |classification| classifications.contains(&classification);
    let mut text = format!(
        "const ANY_PRE = {};\nconst ANY_PRE_INTEGRATED = {};\n",
        has(Classification::Pre),
        has(Classification::PreIntegrated)
    );
    let (mut pre, mut pairs) = (String::new(), String::new());
    let textured = classifications.iter().enumerate().filter(|(_, kind)| **kind != Classification::Post);
    for (binding, (volume, classification)) in (first_binding..).zip(textured) {
        // Writing to a String cannot fail.
        let _ = if *classification == Classification::Pre {
            let _ = writeln!(
                pre,
                "        case {volume}u: {{ return textureSampleLevel(voxels_{volume}, linear_sampler, place, 0.0); }}"
            );
            writeln!(text, "@group(0) @binding({binding}) var voxels_{volume}: texture_3d<f32>;")
        } else {
            let _ = writeln!(
                pairs,
                "        case {volume}u: {{ return textureLoad(pairs_{volume}, place, 0); }}"
            );
            writeln!(text, "@group(0) @binding({binding}) var pairs_{volume}: texture_2d<f32>;")
        };
    }
    let mut kinds = String::new();
    for (volume, classification) in classifications.iter().enumerate() {
        let _ = writeln!(kinds, "        case {volume}u: {{ return {}u; }}", number(*classification));
    }
    let nothing = "        default: { return vec4f(0.0); }\n";
    let _ = write!(
        text,
        "fn classification_of(volume: u32) -> u32 {{\n    switch volume {{\n{kinds}        default: {{ return 0u; }}\n    }}\n}}\n\
         fn voxels_at(volume: u32, place: vec3f) -> vec4f {{\n    switch volume {{\n{pre}{nothing}    }}\n}}\n\
         fn pair_at(volume: u32, place: vec2u) -> vec4f {{\n    switch volume {{\n{pairs}{nothing}    }}\n}}\n"
    );
    text
}
