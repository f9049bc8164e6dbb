//! Shaders and what they share: `#import name` brings in `shaders/shared/name.wgsl` once.
//!
//! They are built into the program. With `TYNDALL_SHADERS` set to a folder, a file of the same path in it is used instead.

use super::{Gpu, GpuError};
use crate::plain;
use crate::regular_file::{self, Unopened};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

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
    "raycast_parts" => "raycast_parts.wgsl",
    "sampling_adaptive" => "shared/sampling_adaptive.wgsl",
    "sampling_uniform" => "shared/sampling_uniform.wgsl",
    "scattered_light" => "scattered_light.wgsl",
    "scattered_radiosity" => "scattered_radiosity.wgsl",
    "scattered_texels" => "scattered_texels.wgsl",
    "scattering_texels" => "scattering_texels.wgsl",
    "shadow" => "shared/shadow.wgsl",
    "shared_light" => "shared_light.wgsl",
    "summed_light" => "summed_light.wgsl",
    "surface" => "surface.wgsl",
    "sweep" => "shared/sweep.wgsl",
    "tonemap" => "tonemap.wgsl",
    "voxel" => "shared/voxel.wgsl",
}

/// The folder whose files are used instead of the shaders built in, where there is one.
pub fn folder() -> Option<PathBuf> {
    std::env::var_os("TYNDALL_SHADERS").map(PathBuf::from)
}

/// The shaders that these files of [`folder`] are, and those that import them, be it through modules made for a use, which `generated`
/// gives examples of.
pub(crate) fn affected<'a>(
    files: impl IntoIterator<Item = &'a Path>,
    generated: &[(&str, String)],
) -> BTreeSet<String> {
    let Some(folder) = folder() else { return BTreeSet::new() };
    let files: BTreeSet<&Path> = files.into_iter().collect();
    let changed = SOURCES.iter().filter(|(_, path, _)| files.contains(folder.join(path).as_path()));
    let mut affected: BTreeSet<String> = changed.map(|(name, ..)| (*name).to_owned()).collect();
    if affected.is_empty() {
        return affected;
    }
    let names = SOURCES.iter().map(|(name, ..)| *name).chain(generated.iter().map(|(name, _)| *name));
    let imports: Vec<(&str, Vec<String>)> = names
        .map(|name| {
            // One that cannot be read is told of when it is compiled.
            let text = source(name, generated).ok().flatten().unwrap_or_default();
            (name, text.lines().filter_map(import).map(str::to_owned).collect())
        })
        .collect();
    let is_made = |name: &str| generated.iter().any(|(made, _)| *made == name);
    let is_shared =
        |name: &str| SOURCES.iter().any(|(known, path, _)| *known == name && path.starts_with("shared/"));
    let is_imported = |name: &str| imports.iter().flat_map(|(_, own)| own).any(|import| import == name);
    loop {
        // What nothing here imports may be imported by another version of any module that is made.
        let through_any = affected.iter().any(|name| is_shared(name) && !is_imported(name));
        let concerns = |module: &String| affected.contains(module) || through_any && is_made(module);
        let found: Vec<String> = imports
            .iter()
            .filter(|(name, own)| !affected.contains(*name) && own.iter().any(concerns))
            .map(|(name, _)| (*name).to_owned())
            .collect();
        if found.is_empty() {
            affected.retain(|name| !is_made(name));
            return affected;
        }
        affected.extend(found);
    }
}

/// The text of a shader with all its imports in front of what needs them. `generated` are modules made for this use.
pub fn expand(name: &str, generated: &[(&str, String)]) -> Result<String, GpuError> {
    Expanded::new(name, generated).map(|expanded| expanded.text)
}

/// A shader with its imports, and where each line came from.
pub(super) struct Expanded {
    text: String,
    /// By line: the module that it is in, and which of its lines it is.
    origin: Vec<(String, usize)>,
}

impl Expanded {
    pub fn new(name: &str, generated: &[(&str, String)]) -> Result<Self, GpuError> {
        let mut expanded = Self { text: String::new(), origin: Vec::new() };
        expanded.append(name, generated, &mut Vec::new())?;
        Ok(expanded)
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    /// Where a line, counted from 1, is written: `surface.wgsl:12`.
    fn place(&self, line: usize) -> Option<String> {
        let (name, line) = self.origin.get(line.checked_sub(1)?)?;
        let path = SOURCES.iter().find(|(known, ..)| known == name).map(|(_, path, _)| *path);
        Some(match path {
            Some(path) => format!("{path}:{line}"),
            None => format!("the module `{name}` made for it, line {line}"),
        })
    }

    fn append(
        &mut self,
        name: &str,
        generated: &[(&str, String)],
        done: &mut Vec<String>,
    ) -> Result<(), GpuError> {
        done.push(name.into());
        for (index, line) in source(name, generated)?.unwrap_or_default().lines().enumerate() {
            let Some(import) = import(line) else {
                self.text.push_str(line);
                self.text.push('\n');
                self.origin.push((name.into(), index + 1));
                continue;
            };
            if done.iter().any(|known| known == import) {
                continue;
            }
            if source(import, generated)?.is_none() {
                return Err(GpuError::Import {
                    file: format!("{name}.wgsl"),
                    line: index + 1,
                    import: import.into(),
                });
            }
            self.append(import, generated, done)?;
        }
        Ok(())
    }
}

/// What a line imports, if it does.
fn import(line: &str) -> Option<&str> {
    line.strip_prefix("#import ").map(str::trim)
}

/// The text of a module, if there is one of this name.
fn source<'a>(name: &str, generated: &'a [(&str, String)]) -> Result<Option<Cow<'a, str>>, GpuError> {
    if let Some((_, text)) = generated.iter().find(|(known, _)| *known == name) {
        return Ok(Some(Cow::Borrowed(text)));
    }
    let Some((_, path, built_in)) = SOURCES.iter().find(|(known, ..)| *known == name) else {
        return Ok(None);
    };
    let own = folder().map_or(Ok(None), |folder| own_text(&folder.join(path)));
    own.map(|own| Some(own.map_or(Cow::Borrowed(*built_in), Cow::Owned)))
}

/// Bytes of a shader file; a longer one is something else.
const LONGEST: u64 = 1 << 24;

/// The text of a file in [`folder`], if it is there.
fn own_text(path: &Path) -> Result<Option<String>, GpuError> {
    let failed = |reason: String| Err(GpuError::ShaderFile { path: path.to_owned(), reason });
    match regular_file::read(path, LONGEST) {
        Ok(bytes) if bytes.len() as u64 > LONGEST => failed(format!("it is longer than {LONGEST} bytes")),
        Ok(bytes) => match String::from_utf8(bytes) {
            Ok(text) => Ok(Some(text)),
            Err(_) => failed("it is not UTF-8 text".into()),
        },
        Err(Unopened::NotAFile(found)) => failed(format!("expected a file, found {found}")),
        Err(Unopened::Io(error)) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(Unopened::Io(error)) => failed(error.to_string()),
    }
}

/// Compiles a shader. Errors are those of naga, with the text around them and the place in its file.
pub(super) fn compile(gpu: &Gpu, name: &str, expanded: &Expanded) -> Result<wgpu::ShaderModule, GpuError> {
    let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let source = wgpu::ShaderSource::Wgsl(Cow::Borrowed(expanded.text()));
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some(name), source });
    let Some(error) = pollster::block_on(scope.pop()) else { return Ok(module) };
    let messages = pollster::block_on(module.get_compilation_info()).messages;
    let location = messages.iter().find_map(|message| message.location);
    let place = location.and_then(|location| {
        let place = expanded.place(location.line_number as usize)?;
        Some(format!("{place}:{}", location.line_position))
    });
    let file = place.map_or(format!("{name}.wgsl"), |place| format!("{name}.wgsl ({place})"));
    // Lines of shaders may be of any length.
    Err(GpuError::Shader(file, plain::message(&error.to_string())))
}
