// The forward peak of a phase function, which where light is scattered often counts as no scattering: `src/optics/peak.rs`.

// 1 - f: the share of scattered light that is beside the peak.
fn beside_peak(g: f32) -> f32 {
    let ahead = max(g, 0.0);
    return (1.0 - ahead) * (1.0 + ahead);
}

// 1 - albedo f: extinction without what stays in the peak.
fn beam_extinction(albedo: vec3f, g: f32) -> vec3f {
    return (1.0 - albedo) + albedo * beside_peak(g);
}

// The same of a medium for all colours at once.
fn mean_beam_extinction(albedo: vec3f, g: f32) -> f32 {
    return mean_extinction(albedo, beside_peak(g));
}

// Extinction where only the share `aside` of scattered light counts as scattered.
fn mean_extinction(albedo: vec3f, aside: f32) -> f32 {
    return dot((1.0 - albedo) + albedo * aside, vec3f(1.0 / 3.0));
}

// T' of the share of the light that arrives unscattered.
fn beam_of(light: f32, albedo: vec3f, g: f32) -> vec3f {
    let power = exp(log(max(light, 1e-37)) * beam_extinction(albedo, g));
    return select(vec3f(0.0), power, light > 0.0);
}

// (1 - exp(-x)) / x, the mean of exp(-x u) over u in 0..1, for x of either sign.
fn lessening(x: f32) -> f32 {
    let series = 1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0))));
    let safe = select(x, 1.0, abs(x) < 0.1);
    return select((1.0 - exp(-safe)) / safe, series, abs(x) < 0.1);
}
