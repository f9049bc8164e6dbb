//! Descriptions of surfaces by metalness and roughness -> what a Phong surface needs.

use super::MeshMaterial;
use glam::Vec3;

/// Reflectance of a dielectric of index 1.5 seen head-on: what glTF takes for granted.
pub(in crate::sources) const DIELECTRIC: f32 = 0.04;

/// Exponents above this draw highlights smaller than a pixel.
pub(in crate::sources) const MOST_SHININESS: f32 = 4096.0;

/// Gives a material the diffuse and specular colour and the exponent of a base colour with metalness, roughness, and reflectance of the
/// dielectric head-on.
///
/// Colours as in glTF 2.0, appendix B: the diffuse one is the base colour of what is not metal, the specular one the reflectance
/// head-on. The exponent is that of the Blinn-Phong lobe nearest to the microfacets' (GGX with `alpha = roughness^2`): `2 / alpha^2 - 2`
/// (Walter et al., "Microfacet models for refraction through rough surfaces", 2007, after eq. 33, of Beckmann's roughness).
pub(in crate::sources) fn set_metallic_roughness(
    material: &mut MeshMaterial,
    base: Vec3,
    metallic: f32,
    roughness: f32,
    reflectance: f32,
) {
    let unit = |value: f32| if value.is_finite() { value.clamp(0.0, 1.0) } else { 1.0 };
    let (metallic, roughness) = (unit(metallic), unit(roughness));
    material.diffuse = base * (1.0 - metallic);
    material.specular = Vec3::splat(reflectance).lerp(base, metallic);
    let alpha = roughness * roughness;
    let exponent = 2.0 / (alpha * alpha) - 2.0;
    material.shininess = exponent.clamp(1.0, MOST_SHININESS);
}
