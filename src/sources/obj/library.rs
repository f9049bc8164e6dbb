//! Material libraries of OBJ files, MTL.
//!
//! | statement | meaning here |
//! |---|---|
//! | `Kd` | diffuse colour: a reflectance, hence linear as written; `map_Kd` is multiplied by it, except by black |
//! | `Ks`, `Ns` | highlight `Ks (n.h)^Ns`, relative to a white diffuse surface as OBJ means it: the share of light in it is `8 Ks / (Ns + 8)` |
//! | `d`, `Tr` | opacity, 1 - opacity |
//! | `Pr`, `Pm` | roughness and metalness, in place of `Ks` and `Ns` |
//! | `map_Kd` | a picture in sRGB; its options are left out |
//!
//! All else is named in a note.

use crate::sources::file;
use crate::sources::mesh::{MeshMaterial, counted, listed, phong, quoted};
use crate::sources::statements::Statements;
use crate::sources::texture::{self, Textures};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

/// The longest library that is read, in bytes.
const MAX_LIBRARY_BYTES: u64 = 1 << 26;

/// Names in one note, at most.
const MOST_NAMED: usize = 8;

/// What a library says of a material.
#[derive(Default)]
struct Written {
    diffuse: Option<Vec3>,
    specular: Option<Vec3>,
    shininess: Option<f32>,
    opacity: Option<f32>,
    roughness: Option<f32>,
    metallic: Option<f32>,
    texture: Option<String>,
    /// The folder that the texture's name is relative to.
    folder: PathBuf,
}

/// The materials of these names, in their order, out of the libraries that a file names. One that is in none looks like any surface.
pub(super) fn read(
    path: &Path,
    libraries: &[String],
    names: &[String],
    notes: &mut Vec<String>,
) -> Vec<MeshMaterial> {
    let mut library = Library::default();
    let folder = path.parent().unwrap_or(Path::new(""));
    for written in libraries {
        for file in library_paths(folder, written, notes) {
            library.read(&file, notes);
        }
    }
    let mut textures = Textures::default();
    let mut missing = Vec::new();
    let mut materials = Vec::with_capacity(names.len());
    for name in names {
        let written = library.materials.get(name);
        if written.is_none() {
            missing.push(format!("`{}`", quoted(name)));
        }
        materials.push(material(name, written.unwrap_or(&Written::default()), folder, &mut textures));
    }
    notes.append(&mut textures.notes);
    if !missing.is_empty() {
        let count = counted(missing.len() as u64, "material");
        missing.truncate(MOST_NAMED);
        notes.push(format!("{count} in no library, taken as grey: {}", listed(&missing)));
    }
    materials
}

/// The files that a `mtllib` means: one whose name may have spaces, or several.
fn library_paths(folder: &Path, written: &str, notes: &mut Vec<String>) -> Vec<PathBuf> {
    if written.is_empty() {
        return Vec::new();
    }
    let name = written.trim_matches('"');
    if let Some(file) = texture::find(&[folder], name) {
        return vec![file];
    }
    let mut files = Vec::new();
    let mut missing = Vec::new();
    for word in written.split_whitespace() {
        match texture::find(&[folder], word) {
            Some(file) => files.push(file),
            None => missing.push(word),
        }
    }
    // If none of several is there, it is more likely the name of one.
    let missing = if files.is_empty() { vec![name] } else { missing };
    for name in missing.iter().take(MOST_NAMED) {
        notes.push(format!("material library `{}` is not there", quoted(name)));
    }
    files
}

#[derive(Default)]
struct Library {
    materials: BTreeMap<String, Written>,
}

impl Library {
    fn read(&mut self, path: &Path, notes: &mut Vec<String>) {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let name = quoted(&name);
        let opened = file::open(path).and_then(|(file, bytes)| {
            if bytes > MAX_LIBRARY_BYTES {
                let (limit, mend) = (MAX_LIBRARY_BYTES, "is it a material library?");
                let path = path.to_owned();
                return Err(crate::sources::SourceError::TooLarge { path, bytes, limit, mend });
            }
            Ok(file)
        });
        let Ok(file) = opened else {
            notes.push(format!("material library `{name}` cannot be read"));
            return;
        };
        let mut statements = Statements::new(BufReader::new(file.take(MAX_LIBRARY_BYTES)));
        let mut unused = BTreeSet::new();
        let mut current = None;
        while statements.advance().unwrap_or(false) {
            self.statement(&statements.text(), path, &mut current, &mut unused);
        }
        if !unused.is_empty() {
            let unused: Vec<_> = unused.into_iter().take(2 * MOST_NAMED).collect();
            notes.push(format!("{name}: not used: {}", listed(&unused)));
        }
    }

    fn statement(
        &mut self,
        text: &str,
        path: &Path,
        current: &mut Option<String>,
        unused: &mut BTreeSet<String>,
    ) {
        let text = super::scan::without_comment(text.trim_start_matches('\u{feff}'));
        let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        if keyword.is_empty() || keyword.starts_with('#') {
            return;
        }
        if keyword == "newmtl" {
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            self.materials.insert(rest.to_owned(), Written { folder, ..Written::default() });
            *current = Some(rest.to_owned());
            return;
        }
        let Some(material) = current.as_ref().and_then(|name| self.materials.get_mut(name)) else { return };
        let number =
            rest.split_whitespace().next().and_then(|word| word.parse().ok()).filter(|n: &f32| n.is_finite());
        let is_used = match keyword {
            "Kd" => set(&mut material.diffuse, colour(rest)),
            "Ks" => set(&mut material.specular, colour(rest)),
            "Ns" => set(&mut material.shininess, number),
            "d" => set(&mut material.opacity, number),
            "Tr" => set(&mut material.opacity, number.map(|transparency| 1.0 - transparency)),
            "Pr" => set(&mut material.roughness, number),
            "Pm" => set(&mut material.metallic, number),
            "map_Kd" => {
                let (name, options) = texture_name(rest);
                unused.extend(options.into_iter().map(|option| format!("map_Kd {option}")));
                material.texture = (!name.is_empty()).then(|| name.to_owned());
                true
            }
            // Black says that there is no light of its own.
            "Ke" => colour(rest) == Some(Vec3::ZERO),
            _ => false,
        };
        if !is_used {
            unused.insert(quoted(keyword));
        }
    }
}

/// Whether there was a value to set.
fn set<T>(field: &mut Option<T>, value: Option<T>) -> bool {
    let is_any = value.is_some();
    if is_any {
        *field = value;
    }
    is_any
}

/// One number for all channels, or three.
fn colour(rest: &str) -> Option<Vec3> {
    let mut words = rest.split_whitespace();
    let red: f32 = words.next()?.parse().ok()?;
    let green = words.next().map_or(Some(red), |word| word.parse().ok())?;
    let blue = words.next().map_or(Some(red), |word| word.parse().ok())?;
    let colour = Vec3::new(red, green, blue);
    colour.is_finite().then(|| colour.clamp(Vec3::ZERO, Vec3::ONE))
}

/// The name of a picture, which may have spaces, behind options with their values; and the options.
fn texture_name(rest: &str) -> (&str, Vec<&str>) {
    let mut rest = rest;
    let mut options = Vec::new();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let (least, most) = match option {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-texres" | "-bm" | "-boost" | "-imfchan"
            | "-type" => (1, 1),
            // A name that begins like this.
            _ => break,
        };
        options.push(option);
        rest = after.trim_start();
        for value in 0..most {
            let (word, after) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            if value >= least && word.parse::<f32>().is_err() {
                break;
            }
            rest = after.trim_start();
        }
    }
    (rest.trim().trim_matches('"'), options)
}

fn material(name: &str, written: &Written, folder: &Path, textures: &mut Textures) -> MeshMaterial {
    let mut material = MeshMaterial { name: name.to_owned(), ..MeshMaterial::default() };
    material.diffuse = written.diffuse.unwrap_or(material.diffuse);
    if let Some(texture) = &written.texture {
        material.diffuse_texture = textures.load(&[&written.folder, folder], texture);
        if material.diffuse_texture.is_some() && material.diffuse == Vec3::ZERO {
            material.diffuse = Vec3::ONE;
        }
    }
    if written.roughness.is_some() || written.metallic.is_some() {
        let (metallic, roughness) = (written.metallic.unwrap_or(0.0), written.roughness.unwrap_or(0.5));
        let base = material.diffuse;
        phong::set_metallic_roughness(&mut material, base, metallic, roughness, phong::DIELECTRIC);
    } else if let Some(specular) = written.specular {
        material.shininess =
            written.shininess.unwrap_or(material.shininess).clamp(1.0, phong::MOST_SHININESS);
        // Phong's highlight has the strength `specular (s + 8) / (8 pi)` where a white surface has 1 / pi.
        material.specular = specular * 8.0 / (material.shininess + 8.0);
    }
    material.opacity = written.opacity.unwrap_or(1.0).clamp(0.0, 1.0);
    material
}
