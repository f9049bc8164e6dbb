//! Fresnel's equations for unpolarised light at a smooth boundary between dielectrics, and Snell's law.

use glam::DVec3;

/// Share of the power that a boundary reflects: light arrives at the cosine `cos` from the normal, and `n` is the index of refraction
/// of where it would go over that of where it comes from. 1 where it is totally reflected, 0 where `n` is 1.
///
/// Fresnel's `(rs² + rp²) / 2` with both differences multiplied out, `n² - 1` in place of `cos - n cos_t`, which keeps every digit as
/// `n` approaches 1.
pub fn reflectance(cos: f64, n: f64) -> f64 {
    if n == 1.0 {
        return 0.0;
    }
    let contrast = (n - 1.0) * (n + 1.0);
    let squared = contrast + cos * cos;
    if squared <= 0.0 {
        return 1.0;
    }
    // n times the cosine of the refracted ray.
    let q = squared.sqrt();
    let senkrecht = contrast / (cos + q).powi(2);
    let parallel = contrast * ((n * n + 1.0) * cos * cos - 1.0) / (n * n * cos + q).powi(2);
    (0.5 * (senkrecht * senkrecht + parallel * parallel)).min(1.0)
}

/// Share of the power that a boundary lets through: what [`reflectance`] leaves.
pub fn transmittance(cos: f64, n: f64) -> f64 {
    1.0 - reflectance(cos, n)
}

/// Direction into the medium of light that comes from `omega_i`, which points away from the surface: `omega_12`, Snell's law.
/// Nothing where all of it is reflected, which takes `eta < 1`.
pub fn refract(omega_i: DVec3, normal: DVec3, eta: f64) -> Option<DVec3> {
    if eta == 1.0 {
        return Some(-omega_i);
    }
    let cos = omega_i.dot(normal);
    let squared = (eta - 1.0) * (eta + 1.0) + cos * cos;
    (squared >= 0.0).then(|| (normal * (cos - squared.sqrt()) - omega_i) / eta)
}

/// Jensen's polynomial for the diffuse Fresnel reflectance `2 C1`, which the standard dipole uses (Jensen, Marschner, Levoy and
/// Hanrahan 2001, "A practical model for subsurface light transport", after Egan and others).
pub fn diffuse_reflectance_polynomial(eta: f64) -> f64 {
    if eta < 1.0 {
        -0.4399 + 0.7099 / eta - 0.3319 / (eta * eta) + 0.0636 / eta.powi(3)
    } else {
        -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta
    }
}
