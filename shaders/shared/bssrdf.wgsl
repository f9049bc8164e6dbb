// Light that enters a translucent body at one point and leaves it at another: dipole models, for red, green and blue at once.
//
// Directional dipole: Frisvad, Hachisuka, Kjeldsen 2014, eqs. 14 to 20, arranged so that 32 bits are enough: lengths count in mean free
// paths (so D = 1/3), and the difference of the real and the virtual source is formed term by term before it can cancel.
// Standard dipole: Jensen, Marschner, Levoy, Hanrahan 2001, eq. 4.

#import fresnel

// A medium, its numbers per channel. Lengths are those of the body, divided by the mean free path.
struct Medium {
    // Reduced extinction, per unit of the body's length.
    sigma_t_prime: vec3f,
    // Index of refraction inside over outside.
    eta: f32,
    // Effective transport coefficient.
    mu: vec3f,
    c_phi: f32,
    // The published extension of distances.
    d_e: vec3f,
    c_e: f32,
    // How far the virtual source is: 2 A d_e from the real one; in the standard dipole its depth z_v.
    virtual_distance: vec3f,
    // Square of the least distance to the real source.
    least_distance: f32,
    // d_r^2 - r^2 where the light comes from behind.
    behind: vec3f,
    // Everything that only multiplies.
    strength: vec3f,
    // What calibrates the model, as a quadratic in the cosine of incidence.
    calibration_0: vec3f,
    calibration_1: vec3f,
    calibration_2: vec3f,
}

// exp(x) - 1 without cancellation.
fn expm1(x: vec3f) -> vec3f {
    let series = x * (1.0 + x / 2.0 * (1.0 + x / 3.0 * (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0))))));
    return select(exp(x) - 1.0, series, abs(x) < vec3f(0.5));
}

// The difference of the real and the virtual source, which may be negative; the authors clamp it at 0.
// `between` leads from where light enters, with the normal `n_i` and the refracted direction `omega_12`, to where it leaves with `n_o`.
fn directional_dipole(medium: Medium, between: vec3f, n_i: vec3f, omega_12: vec3f, n_o: vec3f) -> vec3f {
    const D = 1.0 / 3.0;
    let scale = medium.sigma_t_prime;
    let mu = medium.mu;
    // The modified normal, perpendicular to what lies between. Squares of shorter lengths leave 32 bits.
    let length_between = length(between);
    let along = select(between / max(length_between, 1e-15), vec3f(0.0), length_between < 1e-15);
    let sideways = cross(n_i, along);
    let is_parallel = length(sideways) < 1e-6;
    let n_star = select(cross(along, sideways) / max(length(sideways), 1e-6), n_i, is_parallel);
    let x_star = scale * select(0.0, dot(between, n_i), is_parallel);

    let r = scale * length_between;
    let x_w = scale * dot(between, omega_12);
    let x_n = scale * dot(between, n_o);
    let w_n = dot(omega_12, n_o);
    let w_s = dot(omega_12, n_star);
    let s_n = dot(n_star, n_o);
    let h = medium.virtual_distance;

    // Distances to the real and to the virtual source.
    let mu_0 = -w_n;
    let across = scale * length(cross(between, omega_12));
    let in_front = D * mu_0 * (D * mu_0 + 2.0 * medium.d_e * across * inverseSqrt(r * r + medium.d_e * medium.d_e));
    let extension = max(select(medium.behind, in_front, mu_0 > 0.0), vec3f(medium.least_distance) - r * r);
    let d_r = sqrt(r * r + extension);
    // Where all is in one line, the exit may lie at the virtual source.
    let further = max(h * (h - 2.0 * x_star), max(medium.least_distance, 1e-12) - r * r) - extension;
    let d_v = sqrt(r * r + extension + further);
    let delta = further / (d_v + d_r);
    let i_r = 1.0 / d_r;
    let i_v = 1.0 / d_v;
    let i_rv = i_r * i_v;

    // f_1 = e^(-mu d)/d, f_3 = (1 + mu d) e^(-mu d)/d^3, f_5 = (3 (1 + mu d) + (mu d)^2) e^(-mu d)/d^5, and their differences. Each part is
    // multiplied with e^(-mu d_r) before it can grow: e^(-mu d_v) may be greater by far.
    let m_r = mu * d_r;
    let decay = exp(-m_r);
    let e = decay * expm1(-mu * delta);
    let lag = decay * delta;
    let gap = decay * mu * further;
    let m_v = mu * d_v;
    let squares = i_r * i_r + i_rv + i_v * i_v;
    let f_1 = i_v * (lag * i_r - e);
    let f_3 = lag * i_rv * squares + gap * i_rv * i_rv - e * (1.0 + m_v) * i_v * i_v * i_v;
    let fourths = i_r * i_r * (i_r * i_r + i_rv) + i_rv * i_rv + i_v * i_v * (i_rv + i_v * i_v);
    let f_5 = 3.0 * lag * i_rv * fourths + 3.0 * gap * i_rv * i_rv * (i_r * i_r + i_v * i_v)
        + mu * mu * lag * i_rv * squares - e * (3.0 * (1.0 + m_v) + m_v * m_v) * i_v * i_v * i_v * i_v * i_v;
    // Of the virtual source alone.
    let f_3v = (decay + e) * (1.0 + m_v) * i_v * i_v * i_v;
    let f_5v = (decay + e) * (3.0 * (1.0 + m_v) + m_v * m_v) * i_v * i_v * i_v * i_v * i_v;

    let turned = w_s * (h - 2.0 * x_star);
    let g = 3.0 * medium.c_phi * x_w - 3.0 * D * medium.c_e * w_n + medium.c_e * x_n;
    let g_difference = -3.0 * medium.c_phi * turned - 6.0 * D * medium.c_e * w_s * s_n + medium.c_e * h * s_n;
    let h_difference = h * s_n * (x_w + turned) - turned * x_n;
    let sum = medium.c_phi / D * f_1 + g * f_3 + g_difference * f_3v
        + 3.0 * D * medium.c_e * (x_w * x_n * f_5 + h_difference * f_5v);
    // Beyond that, 32 bits hold nothing of it.
    return select(medium.strength * sum, vec3f(0.0), m_r > vec3f(80.0));
}

fn standard_dipole(medium: Medium, between: vec3f) -> vec3f {
    let r = medium.sigma_t_prime * length(between);
    let mu = medium.mu;
    let z_v = medium.virtual_distance;
    let d_r = sqrt(r * r + 1.0);
    let d_v = sqrt(r * r + z_v * z_v);
    return medium.strength * ((1.0 + mu * d_r) * exp(-mu * d_r) / (d_r * d_r * d_r)
        + z_v * (1.0 + mu * d_v) * exp(-mu * d_v) / (d_v * d_v * d_v));
}

// The share of the irradiance on a surface across the light that enters at a point and leaves at another, per area across the light and
// solid angle, as far as it does not depend on the direction in which it leaves: T(eta, omega_i) max(S_d, 0).
// `to_light` and the normals point away from the body.
fn subsurface(medium: Medium, between: vec3f, n_i: vec3f, to_light: vec3f, n_o: vec3f) -> vec3f {
    let cosine = dot(n_i, to_light);
    let enters = fresnel_transmittance(cosine, medium.eta);
    var s_d: vec3f;
    if STANDARD_DIPOLE {
        s_d = standard_dipole(medium, between);
    } else {
        let omega_12 = refract_into(to_light, n_i, cosine, medium.eta);
        s_d = directional_dipole(medium, between, n_i, omega_12, n_o);
    }
    let calibration = medium.calibration_0 + cosine * (medium.calibration_1 + cosine * medium.calibration_2);
    return select(vec3f(0.0), enters * max(calibration, vec3f(0.0)) * max(s_d, vec3f(0.0)), enters > 0.0);
}
