// Fresnel's equations for unpolarised light at a smooth boundary.

// Share of the light that is reflected. `cosine` is that of incidence, `n` the index on the far side over that on the near side.
//
// rs = (c - q)/(c + q) and rp = (n^2 c - q)/(n^2 c + q) with q = sqrt(n^2 - 1 + c^2) = n cos t, in the form that does not cancel as n
// goes to 1.
fn fresnel_reflectance(cosine: f32, n: f32) -> f32 {
    let step = (n - 1.0) * (n + 1.0);
    let k = step + cosine * cosine;
    let q = sqrt(max(k, 0.0));
    let s = cosine + q;
    let p = n * n * cosine + q;
    // Both sums vanish only where there is no boundary and the light grazes it; then nothing is reflected.
    let rs = select(step / (s * s), 0.0, step == 0.0);
    let rp = select(step * ((n * n + 1.0) * cosine * cosine - 1.0) / (p * p), 0.0, step == 0.0);
    // Total internal reflection.
    return select(min(0.5 * (rs * rs + rp * rp), 1.0), 1.0, k <= 0.0 && step != 0.0);
}

// Share of the light that passes; none from below the horizon.
fn fresnel_transmittance(cosine: f32, n: f32) -> f32 {
    return select(0.0, 1.0 - fresnel_reflectance(cosine, n), cosine > 0.0);
}

// The refracted direction, pointing into the medium. `to_light` and `normal` point away from it; `cosine` is the one between them.
// Only where there is no total reflection.
fn refract_into(to_light: vec3f, normal: vec3f, cosine: f32, n: f32) -> vec3f {
    let root = sqrt(max((n - 1.0) * (n + 1.0) + cosine * cosine, 0.0));
    return (normal * (cosine - root) - to_light) / n;
}
