//! Materials of a glTF document.
//!
//! Base colour, metalness and roughness become what a Phong surface has, see [`phong`]; the index of `KHR_materials_ior` gives the
//! reflectance of what is no metal, `((n - 1) / (n + 1))^2`. Pictures of all but the base colour are left out.
//!
//! A medium is taken of a material with `KHR_materials_volume`, if light gets into it: it transmits, or is said to scatter. With the
//! attenuation colour c and distance d, and the multiple-scattering albedo of `KHR_materials_volume_scatter` (drafts of it call it
//! `KHR_materials_scatter` and `KHR_materials_sss`, and the albedo differently):
//!
//! ```text
//! sigma_t = -ln(c) / d,   s = 4.09712 + 4.20863 a - sqrt(9.59217 + 41.6808 a + 17.7126 a^2)
//! sigma_s = sigma_t (1 - s^2) / (1 - g s^2),   sigma_a = sigma_t - sigma_s
//! ```
//!
//! (Kulla and Conty, "Revisiting physically based shading at Imageworks", 2017, with the similarity relation for the anisotropy g.) Lengths
//! are metres in glTF; coefficients are per millimetre here. Without an albedo the medium is clear: sigma_s is 0.

use std::collections::{BTreeSet, HashMap};

use glam::{Affine2, Vec2, Vec3};
use gltf::json;
use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked;

use super::File;
use super::nodes;
use super::primitive::Texture;
use crate::sources::mesh::draft::Draft;
use crate::sources::mesh::{MeshMaterial, MeshSubsurface, TextureImage, phong};
use crate::sources::texture::{self, Textures};
use std::sync::Arc;

/// What scattering is called in the extension and its drafts, and the names of the albedo there.
const SCATTERING: &[&str] = &["KHR_materials_volume_scatter", "KHR_materials_scatter", "KHR_materials_sss"];
const ALBEDO: &[&str] = &["multiscatterColorFactor", "multiscatterColor", "scatterAlbedo", "scatterColor"];

/// Attenuation colours below this would make a medium infinitely dense.
const LEAST_ATTENUATION: f32 = 1e-6;

const MILLIMETRES_PER_METRE: f32 = 1000.0;

/// The materials that are used, in the order of their first use.
pub(super) struct Materials<'a> {
    root: &'a json::Root,
    numbers: HashMap<usize, u32>,
    read: Vec<(MeshMaterial, Texture)>,
    pictures: HashMap<usize, Option<Arc<TextureImage>>>,
    textures: Textures,
    unused: BTreeSet<String>,
    clear: bool,
}

impl<'a> Materials<'a> {
    pub fn new(file: &File<'a>) -> Self {
        Self {
            root: file.root,
            numbers: HashMap::new(),
            read: Vec::new(),
            pictures: HashMap::new(),
            textures: Textures::default(),
            unused: BTreeSet::new(),
            clear: false,
        }
    }

    /// Which of the draft's materials one of the document is.
    pub fn number(&mut self, file: &File<'_>, index: json::Index<json::Material>) -> Result<u32, String> {
        let place = index.value();
        if let Some(&number) = self.numbers.get(&place) {
            return Ok(number);
        }
        let material = self.root.get(index).ok_or_else(|| format!("there is no material {place}"))?;
        let read = self.material(file, material);
        let number = self.read.len() as u32;
        self.read.push(read);
        self.numbers.insert(place, number);
        Ok(number)
    }

    /// How the picture of a material lies on its surface.
    pub fn texture(&self, number: u32) -> Texture {
        self.read.get(number as usize).map(|(_, texture)| *texture).unwrap_or_default()
    }

    /// Hands the materials on, and what of them is not used.
    pub fn finish(mut self, draft: &mut Draft, unused: &mut BTreeSet<String>) {
        if self.clear {
            let note = "a clear medium (KHR_materials_volume without scattering) lets no light out that is scattered in it";
            draft.notes.push(note.to_owned());
        }
        unused.append(&mut self.unused);
        draft.notes.append(&mut self.textures.notes);
        draft.materials = self.read.into_iter().map(|(material, _)| material).collect();
    }

    fn material(&mut self, file: &File<'_>, written: &json::Material) -> (MeshMaterial, Texture) {
        let name = written.name.clone().unwrap_or_default();
        let mut material = MeshMaterial { name, ..MeshMaterial::default() };
        let pbr = &written.pbr_metallic_roughness;
        let ior = written.extensions.as_ref().and_then(|all| all.ior.as_ref()).map_or(1.5, |ior| ior.ior.0);
        // An index of 0 stands for infinity: all is reflected.
        let reflectance = if ior == 0.0 { 1.0 } else { ((ior - 1.0) / (ior + 1.0)).powi(2) };
        let mut base = colour(pbr.base_color_factor.0);
        let mut picture = pbr.base_color_texture.as_ref();
        let roughness = pbr.roughness_factor.0;
        phong::set_metallic_roughness(
            &mut material,
            base.truncate(),
            pbr.metallic_factor.0,
            roughness,
            reflectance,
        );
        let old = written.extensions.as_ref().and_then(|all| all.pbr_specular_glossiness.as_ref());
        if let Some(old) = old {
            base = colour(old.diffuse_factor.0);
            picture = old.diffuse_texture.as_ref();
            let roughness = 1.0 - old.glossiness_factor.0;
            phong::set_metallic_roughness(&mut material, base.truncate(), 0.0, roughness, 0.0);
            material.specular = Vec3::from_array(old.specular_factor.0).clamp(Vec3::ZERO, Vec3::ONE);
        }
        material.opacity = match written.alpha_mode {
            Checked::Valid(AlphaMode::Blend) => base.w,
            Checked::Valid(AlphaMode::Mask) => {
                let cutoff = written.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                f32::from(u8::from(base.w >= cutoff))
            }
            _ => 1.0,
        };
        material.subsurface = self.medium(written, ior);
        let texture = picture.map(|info| self.base_texture(file, info, written.alpha_mode, &mut material));
        self.tell_unused(written);
        (material, texture.unwrap_or_default())
    }

    /// Gives a material its picture, and says how it lies.
    fn base_texture(
        &mut self,
        file: &File<'_>,
        info: &json::texture::Info,
        alpha_mode: Checked<AlphaMode>,
        material: &mut MeshMaterial,
    ) -> Texture {
        let transform = info.extensions.as_ref().and_then(|all| all.texture_transform.as_ref());
        let mut texture = Texture { is_any: true, set: info.tex_coord, ..Texture::default() };
        if let Some(transform) = transform {
            texture.set = transform.tex_coord.unwrap_or(texture.set);
            // Clockwise, as v goes down.
            texture.transform = Affine2::from_scale_angle_translation(
                Vec2::from_array(transform.scale.0),
                -transform.rotation.0,
                Vec2::from_array(transform.offset.0),
            );
        }
        let mut picture = self.picture(file, info);
        if alpha_mode == Checked::Valid(AlphaMode::Opaque)
            && let Some(opaque) = picture.as_mut()
            && opaque.texels.iter().any(|texel| texel[3] < 255)
        {
            let texels = opaque.texels.iter().map(|&[red, green, blue, _]| [red, green, blue, 255]).collect();
            picture = Some(Arc::new(TextureImage { width: opaque.width, height: opaque.height, texels }));
        }
        texture.is_any = picture.is_some();
        material.diffuse_texture = picture;
        texture
    }

    /// The picture of a texture, or none and a note.
    fn picture(&mut self, file: &File<'_>, info: &json::texture::Info) -> Option<Arc<TextureImage>> {
        let image = self.root.get(info.index).map(|texture| texture.source);
        let Some(image) = image.filter(|image| self.root.get(*image).is_some()) else {
            self.textures.tell(format!("texture {} is of a format that is not read", info.index.value()));
            return None;
        };
        let place = image.value();
        if let Some(known) = self.pictures.get(&place) {
            return known.clone();
        }
        let written = self.root.get(image)?;
        let decoded = match (&written.uri, written.buffer_view) {
            (Some(uri), _) => file.buffers.resource(uri).and_then(|bytes| texture::decode(&bytes)),
            (None, Some(view)) => file.buffers.view(view).and_then(texture::decode),
            (None, None) => Err("it names no file".to_owned()),
        };
        let picture = match decoded {
            Ok(picture) => self.textures.keep(picture),
            Err(problem) => {
                self.textures.tell(format!("image {place} cannot be read: {problem}"));
                None
            }
        };
        self.pictures.insert(place, picture.clone());
        picture
    }

    /// The medium inside, see the module.
    fn medium(&mut self, written: &json::Material, ior: f32) -> Option<MeshSubsurface> {
        let extensions = written.extensions.as_ref()?;
        let volume = extensions.volume.as_ref()?;
        let scattering = SCATTERING.iter().find_map(|name| extensions.others.get(*name));
        let number =
            |name: &str| scattering.and_then(|all| all.get(name)).and_then(serde_json::Value::as_f64);
        let albedo = scattering.and_then(|all| ALBEDO.iter().find_map(|name| triple(all.get(*name)?)));
        let is_thick = volume.thickness_factor.0 > 0.0 || volume.thickness_texture.is_some();
        let transmits = extensions.transmission.as_ref().is_some_and(|transmission| {
            transmission.transmission_factor.0 > 0.0 || transmission.transmission_texture.is_some()
        });
        let diffuse = extensions.others.contains_key("KHR_materials_diffuse_transmission");
        if albedo.is_none() && !(is_thick && (transmits || diffuse)) {
            return None;
        }
        let distance = volume.attenuation_distance.0 * MILLIMETRES_PER_METRE;
        let colour = Vec3::from_array(volume.attenuation_color.0);
        let sigma_t = colour.clamp(Vec3::splat(LEAST_ATTENUATION), Vec3::ONE).map(|c| -c.ln() / distance);
        if !(distance > 0.0 && sigma_t.is_finite() && sigma_t.max_element() > 0.0) {
            return None;
        }
        let g = number("scatterAnisotropy").unwrap_or(0.0).clamp(-1.0, 1.0) as f32;
        let albedo = albedo.unwrap_or(Vec3::ZERO).clamp(Vec3::ZERO, Vec3::ONE);
        self.clear |= albedo == Vec3::ZERO;
        let sigma_s = sigma_t * albedo.map(|albedo| single_scattering_albedo(albedo, g));
        let eta = if ior > 0.0 { ior } else { 1.5 };
        Some(MeshSubsurface { sigma_a: (sigma_t - sigma_s).max(Vec3::ZERO), sigma_s, g, eta })
    }

    fn tell_unused(&mut self, written: &json::Material) {
        let emits = written.emissive_factor.0 != [0.0; 3];
        let pbr = &written.pbr_metallic_roughness;
        let told = [
            (emits, "light of its own"),
            (written.normal_texture.is_some(), "normal maps"),
            (written.occlusion_texture.is_some(), "occlusion maps"),
            (pbr.metallic_roughness_texture.is_some(), "maps of metalness and roughness"),
        ];
        self.unused.extend(told.into_iter().filter(|(is_any, _)| *is_any).map(|(_, name)| name.to_owned()));
        if let Some(extensions) = &written.extensions {
            let known = |name: &String| !super::KNOWN_EXTENSIONS.contains(&name.as_str());
            self.unused.extend(nodes::names(&extensions.others).filter(known));
        }
    }
}

/// The share of light that is scattered at one event, of what comes back after all of them: see the module.
fn single_scattering_albedo(albedo: f32, g: f32) -> f32 {
    if albedo <= 0.0 {
        return 0.0;
    }
    let albedo = f64::from(albedo);
    let s = 4.09712 + 4.20863 * albedo - (9.59217 + 41.6808 * albedo + 17.7126 * albedo * albedo).sqrt();
    let s = s.clamp(0.0, 1.0);
    ((1.0 - s * s) / (1.0 - f64::from(g) * s * s)).clamp(0.0, 1.0) as f32
}

fn colour(factor: [f32; 4]) -> glam::Vec4 {
    let clamped = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
    glam::Vec4::from_array(factor.map(clamped))
}

/// Three numbers.
fn triple(value: &serde_json::Value) -> Option<Vec3> {
    let numbers: Vec<f32> =
        value.as_array()?.iter().map(|number| number.as_f64().map(|n| n as f32)).collect::<Option<_>>()?;
    let numbers: [f32; 3] = numbers.try_into().ok()?;
    Some(Vec3::from_array(numbers))
}
