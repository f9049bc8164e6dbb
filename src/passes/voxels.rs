//! How shaders read volumes: the WGSL module `volumes`.

use super::classify::Classified;
use super::raycast::{BRICK_ROW, TABLE_ROW};
use crate::gpu::{Filtering, Texels, VolumeFormat, binding};
use crate::sources::BrickRanges;
use std::fmt::Write;

/// How the texture of a volume is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reading {
    /// Who interpolates.
    pub filtering: Filtering,
    /// What its texels are.
    pub texels: Texels,
    /// Whether nothing is interpolated.
    pub is_nearest: bool,
}

impl Reading {
    /// Of a texture of some format, by what was made of it.
    pub fn of(format: VolumeFormat, classified: &Classified) -> Self {
        Self { filtering: format.filtering, texels: format.texels, is_nearest: classified.is_nearest }
    }

    /// How the texture is bound.
    pub fn binding(self) -> wgpu::BindingType {
        binding::texture(wgpu::TextureViewDimension::D3, self.filtering == Filtering::Sampler)
    }

    /// The function of `shared/voxel.wgsl` that says what a texel means.
    fn meaning(self) -> &'static str {
        match self.texels {
            Texels::Values => "plain",
            Texels::Masked => "masked",
            Texels::Colours => "coloured",
        }
    }

    /// An expression for the texel at `place`, and what it needs.
    fn texel(self, index: usize) -> (String, String) {
        match self.filtering {
            _ if self.is_nearest => (format!("nearest_{index}(place)"), one_load(index)),
            Filtering::Sampler => {
                (format!("textureSampleLevel(volume_{index}, linear_sampler, place, 0.0)"), String::new())
            }
            Filtering::Shader => (format!("trilinear_{index}(place)"), eight_loads(index)),
        }
    }
}

/// The WGSL module `volumes`: one texture binding a volume, and `voxel_at(volume, place)` that interpolates in it, or does not.
pub(crate) fn module(readings: &[Reading], first_binding: usize) -> String {
    let brick = BrickRanges::BRICK;
    let count = readings.len();
    let any_partial = readings.iter().any(|reading| reading.texels != Texels::Values);
    let any_tinted = readings.iter().any(|reading| reading.texels == Texels::Colours);
    let any_nearest = readings.iter().any(|reading| reading.is_nearest);
    let mut text = format!(
        "#import voxel\nconst VOLUMES = {count}u;\nconst BRICK_ROW = {BRICK_ROW}u;\nconst BRICK = {brick}.0;\n\
         const TABLE_ROW = {TABLE_ROW}u;\nconst ANY_PARTIAL = {any_partial};\nconst ANY_NEAREST = {any_nearest};\n\
         const ANY_TINTED = {any_tinted};\n"
    );
    let mut cases = String::new();
    for (index, reading) in readings.iter().enumerate() {
        let binding = first_binding + index;
        let (texel, needed) = reading.texel(index);
        text.push_str(&needed);
        let meaning = reading.meaning();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "@group(0) @binding({binding}) var volume_{index}: texture_3d<f32>;");
        let label = if index == 0 { "default".into() } else { format!("case {index}u") };
        let _ = writeln!(cases, "        {label}: {{ return {meaning}({texel}); }}");
    }
    let _ = write!(
        text,
        "fn voxel_at(volume: u32, place: vec3f) -> Voxel {{\n    switch volume {{\n{cases}    }}\n}}\n"
    );
    text
}

/// The WGSL module `texels`: `voxel_of(texel)`, for kernels that go from voxel to voxel.
pub(crate) fn texels_module(reading: Reading) -> (&'static str, String) {
    let meaning = reading.meaning();
    (
        "texels",
        format!(
            "#import voxel\nconst TABLE_ROW = {TABLE_ROW}u;\nfn voxel_of(texel: vec4f) -> Voxel {{\n    return {meaning}(texel);\n}}\n"
        ),
    )
}

/// The texel that a place is in.
fn one_load(index: usize) -> String {
    format!(
        "fn nearest_{index}(place: vec3f) -> vec4f {{
    let size = vec3i(textureDimensions(volume_{index}));
    return textureLoad(volume_{index}, clamp(vec3i(floor(place * vec3f(size))), vec3i(0), size - 1), 0);
}}
"
    )
}

/// Trilinear interpolation with eight loads, clamped at the border.
fn eight_loads(index: usize) -> String {
    format!(
        "fn trilinear_{index}(place: vec3f) -> vec4f {{
    let last = vec3i(textureDimensions(volume_{index})) - 1;
    let at = place * vec3f(textureDimensions(volume_{index})) - 0.5;
    let low = vec3i(floor(at));
    let part = at - floor(at);
    var rows: array<vec4f, 4>;
    for (var row = 0; row < 4; row += 1) {{
        let y = low.y + (row & 1);
        let z = low.z + (row >> 1u);
        let a = textureLoad(volume_{index}, clamp(vec3i(low.x, y, z), vec3i(0), last), 0);
        let b = textureLoad(volume_{index}, clamp(vec3i(low.x + 1, y, z), vec3i(0), last), 0);
        rows[row] = mix(a, b, part.x);
    }}
    return mix(mix(rows[0], rows[1], part.y), mix(rows[2], rows[3], part.y), part.z);
}}
"
    )
}
