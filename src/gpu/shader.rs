//! Shaders and what they share: `#import name` brings in `shaders/shared/name.wgsl` once.
//!
//! They are built into the program. With `TYNDALL_SHADERS` set to a folder, a file of the same path in it is used instead.

use super::{Gpu, GpuError};
use std::borrow::Cow;

macro_rules! sources {
    ($($name:literal => $path:literal),* $(,)?) => {
        /// Every shader file by its name, as built into the program.
        pub const SOURCES: &[(&str, &str, &str)] =
            &[$(($name, $path, include_str!(concat!("../../shaders/", $path)))),*];
    };
}

sources! {
    "bssrdf" => "shared/bssrdf.wgsl",
    "cells" => "shared/cells.wgsl",
    "classified" => "shared/classified.wgsl",
    "classify" => "shared/classify.wgsl",
    "combine" => "combine.wgsl",
    "diffusion" => "diffusion.wgsl",
    "dimmed_gbuffer" => "dimmed_gbuffer.wgsl",
    "estimator" => "shared/estimator.wgsl",
    "eye_light" => "eye_light.wgsl",
    "frame" => "shared/frame.wgsl",
    "fresnel" => "shared/fresnel.wgsl",
    "fullscreen" => "shared/fullscreen.wgsl",
    "gather" => "gather.wgsl",
    "gbuffer" => "gbuffer.wgsl",
    "level" => "shared/level.wgsl",
    "light_cells" => "light_cells.wgsl",
    "light_escape" => "light_escape.wgsl",
    "light_network" => "light_network.wgsl",
    "light_volume" => "light_volume.wgsl",
    "maps" => "shared/maps.wgsl",
    "peak" => "shared/peak.wgsl",
    "phase" => "shared/phase.wgsl",
    "preclassify" => "preclassify.wgsl",
    "raycast" => "raycast.wgsl",
    "sampling_adaptive" => "shared/sampling_adaptive.wgsl",
    "sampling_uniform" => "shared/sampling_uniform.wgsl",
    "scattered_light" => "scattered_light.wgsl",
    "scattered_radiosity" => "scattered_radiosity.wgsl",
    "scattered_texels" => "scattered_texels.wgsl",
    "scattering_texels" => "scattering_texels.wgsl",
    "shadow" => "shared/shadow.wgsl",
    "summed_light" => "summed_light.wgsl",
    "surface" => "surface.wgsl",
    "sweep" => "shared/sweep.wgsl",
    "tonemap" => "tonemap.wgsl",
}

/// The text of a shader with all its imports in front of what needs them. `generated` are modules made for this use.
pub fn expand(name: &str, generated: &[(&str, String)]) -> Result<String, GpuError> {
    let mut text = String::new();
    append(name, generated, &mut Vec::new(), &mut text)?;
    Ok(text)
}

fn append(
    name: &str,
    generated: &[(&str, String)],
    done: &mut Vec<String>,
    text: &mut String,
) -> Result<(), GpuError> {
    done.push(name.into());
    for (index, line) in source(name, generated).unwrap_or_default().lines().enumerate() {
        let Some(import) = line.strip_prefix("#import ").map(str::trim) else {
            text.push_str(line);
            text.push('\n');
            continue;
        };
        if done.iter().any(|known| known == import) {
            continue;
        }
        if source(import, generated).is_none() {
            return Err(GpuError::Import {
                file: format!("{name}.wgsl"),
                line: index + 1,
                import: import.into(),
            });
        }
        append(import, generated, done, text)?;
    }
    Ok(())
}

fn source<'a>(name: &str, generated: &'a [(&str, String)]) -> Option<Cow<'a, str>> {
    if let Some((_, text)) = generated.iter().find(|(known, _)| *known == name) {
        return Some(Cow::Borrowed(text));
    }
    let (_, path, built_in) = SOURCES.iter().find(|(known, ..)| *known == name)?;
    let folder = std::env::var_os("TYNDALL_SHADERS");
    let own =
        folder.and_then(|folder| std::fs::read_to_string(std::path::Path::new(&folder).join(path)).ok());
    Some(own.map_or(Cow::Borrowed(*built_in), Cow::Owned))
}

/// Compiles a shader. Errors are those of naga, with the text around them.
pub fn module(gpu: &Gpu, name: &str, generated: &[(&str, String)]) -> Result<wgpu::ShaderModule, GpuError> {
    let text = expand(name, generated)?;
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let source = wgpu::ShaderSource::Wgsl(Cow::Owned(text));
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source });
    match pollster::block_on(scope.pop()) {
        Some(error) => Err(GpuError::Shader(format!("{name}.wgsl"), error.to_string())),
        None => Ok(module),
    }
}
