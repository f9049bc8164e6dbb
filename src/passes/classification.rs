//! What the ray caster binds for volumes that are not classified sample by sample, and the WGSL that reads it.

use crate::components::Classification;
use crate::gpu::binding;
use std::fmt::Write;

/// How the ray caster reads what was made of a volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Manner {
    /// When the function is applied.
    pub classification: Classification,
    /// Whether an entry of the table is a value of its own, with nothing between it and the next.
    pub is_exact: bool,
    /// Whether there are classified voxels to take normals from.
    pub has_surfaces: bool,
}

/// What the texture beside a volume's own holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beside {
    Voxels,
    Pairs,
}

impl Manner {
    /// Of a volume that is classified sample by sample.
    pub const POST: Self =
        Self { classification: Classification::Post, is_exact: false, has_surfaces: false };

    fn beside(&self) -> Option<Beside> {
        match self.classification {
            Classification::Post => self.has_surfaces.then_some(Beside::Voxels),
            Classification::Pre => Some(Beside::Voxels),
            Classification::PreIntegrated => Some(Beside::Pairs),
        }
    }

    /// Whether the volume has a texture beside its own.
    pub fn has_texture(&self) -> bool {
        self.beside().is_some()
    }
}

/// What a shader calls each classification.
fn number(classification: Classification) -> u32 {
    match classification {
        Classification::Post => 0,
        Classification::Pre => 1,
        Classification::PreIntegrated => 2,
    }
}

/// How the texture of each volume that has one is bound, in order.
pub(crate) fn bindings(manners: &[Manner]) -> Vec<wgpu::BindingType> {
    let kind = |beside| match beside {
        Beside::Voxels => binding::texture(wgpu::TextureViewDimension::D3, true),
        Beside::Pairs => binding::TEXTURE,
    };
    manners.iter().filter_map(Manner::beside).map(kind).collect()
}

/// The WGSL module `classifications`: how each volume is classified, those textures from a binding on, and functions that read that of a volume. Where no volume has
/// such a texture a constant says so, and the shader is what it would be without.
pub(crate) fn module(manners: &[Manner], first_binding: usize) -> String {
    let has = |classification| manners.iter().any(|manner| manner.classification == classification);
    let mut text = format!(
        "const ANY_PRE = {};\nconst ANY_PRE_INTEGRATED = {};\nconst ANY_EXACT = {};\nconst ANY_SURFACES = {};\n",
        has(Classification::Pre),
        has(Classification::PreIntegrated),
        manners.iter().any(|manner| manner.is_exact),
        manners.iter().any(|manner| manner.has_surfaces),
    );
    let (mut voxels, mut pairs) = (String::new(), String::new());
    let textured = manners.iter().enumerate().filter_map(|(volume, manner)| Some((volume, manner.beside()?)));
    for (binding, (volume, beside)) in (first_binding..).zip(textured) {
        // Writing to a String cannot fail.
        let _ = match beside {
            Beside::Voxels => {
                let sample = format!("textureSampleLevel(voxels_{volume}, linear_sampler, place, 0.0)");
                let _ = writeln!(voxels, "        case {volume}u: {{ return {sample}; }}");
                writeln!(text, "@group(0) @binding({binding}) var voxels_{volume}: texture_3d<f32>;")
            }
            Beside::Pairs => {
                let _ = writeln!(
                    pairs,
                    "        case {volume}u: {{ return textureLoad(pairs_{volume}, place, 0); }}"
                );
                writeln!(text, "@group(0) @binding({binding}) var pairs_{volume}: texture_2d<f32>;")
            }
        };
    }
    let (mut kinds, mut surfaces) = (String::new(), String::new());
    for (volume, manner) in manners.iter().enumerate() {
        let _ = writeln!(kinds, "        case {volume}u: {{ return {}u; }}", number(manner.classification));
        let _ = writeln!(surfaces, "        case {volume}u: {{ return {}; }}", manner.has_surfaces);
    }
    for (signature, cases, nothing) in [
        ("classification_of(volume: u32) -> u32", kinds, "0u"),
        ("has_surfaces(volume: u32) -> bool", surfaces, "false"),
        ("voxels_at(volume: u32, place: vec3f) -> vec4f", voxels, "vec4f(0.0)"),
        ("pair_at(volume: u32, place: vec2u) -> vec4f", pairs, "vec4f(0.0)"),
    ] {
        let _ = write!(
            text,
            "fn {signature} {{\n    switch volume {{\n{cases}        default: {{ return {nothing}; }}\n    }}\n}}\n"
        );
    }
    text
}
