// How much light leaves a point of a translucent body, by sampling the surface that the light sees.
//
//   M(x_o) = integral over what the light reaches of T(eta, omega_i) S_d(x_i, omega_i; x_o) dPhi_i,
//
// where the light's own view measures the flux dPhi_i: irradiance times area across the light. So a sample of density p per such area
// counts S_d T / (N p), without any cosine, and the result is independent of texels, samples and the unit of length.

#import bssrdf
#import sampling

struct Estimator {
    // Positions and normals of points to the light's view.
    light_from_mesh: mat4x4f,
    light_from_mesh_normal: mat4x4f,
    // Lower corner of the light's view, and the inverse size of its texels.
    low: vec2f,
    inverse_texel: vec2f,
    // Samples of a point.
    samples: u32,
    // Which set of samples this is, from 0.
    pass_index: u32,
    // Candidates of which the nearest `samples` are taken (Uniform).
    candidates: u32,
    points: u32,
    // Where the light's results begin.
    first: u32,
    // Length over which the kernel is flat, and the least effective transport coefficient, per unit of the body's length.
    core: f32,
    least_mu: f32,
    // The greatest radius of a disc.
    radius: f32,
    // The result is the irradiance times this: (1, 1, 1) where lights are kept apart.
    irradiance: vec3f,
}

// The lit surface at a place.
struct Lit {
    // Towards the light z is not below 0.
    normal: vec3f,
    height: f32,
    // Share of the neighbourhood that light reaches; where it is 0, the rest means nothing.
    coverage: f32,
}

// The lit surface at a place across the light, over 2^level texels.
fn lit_at(place: vec2f, level: u32) -> Lit {
    let at = (place - estimator.low) * estimator.inverse_texel / f32(1u << level);
    let size = vec2f(textureDimensions(light_gbuffer, level));
    if any(at < vec2f(0.0)) || any(at >= size) {
        return Lit(vec3f(0.0), 0.0, 0.0);
    }
    // The first row of a texture is the top.
    let texel = textureLoad(light_gbuffer, vec2u(vec2f(at.x, size.y - 1.0 - floor(at.y))), level);
    let mean = texel.xyz / max(texel.w, 1e-6);
    let normal = vec3f(mean.xy, sqrt(max(1.0 - dot(mean.xy, mean.xy), 0.0)));
    // From the middle of the texel to the place, along the tangent plane. Steep planes are not to be trusted that far.
    let aside = (fract(at) - 0.5) * f32(1u << level) / estimator.inverse_texel;
    let slope = -normal.xy / max(normal.z, 0.25);
    return Lit(normal, mean.z + dot(slope, aside), texel.w);
}

// The level whose texels are as large as the share of the disc that a sample stands for.
fn level_of(area: f32) -> u32 {
    let texels = FOOTPRINT * sqrt(area) * estimator.inverse_texel.x;
    return u32(clamp(log2(max(texels, 1.0)), 0.0, f32(textureNumLevels(light_gbuffer) - 1u)));
}

// What leaves at a point for a unit of irradiance. `n_o` is of unit length and points away from the body.
fn scattered(medium: Medium, x_o: vec3f, n_o: vec3f, index: u32) -> vec3f {
    const TO_LIGHT = vec3f(0.0, 0.0, 1.0);
    let disc = disc_of(x_o, index);
    var sum = vec3f(0.0);
    for (var i = 0u; i < disc.samples; i += 1u) {
        let sample = disc_sample(disc, i);
        let lit = lit_at(x_o.xy + sample.xy, level_of(sample.z));
        let between = vec3f(-sample.xy, x_o.z - lit.height);
        let weight = sample.z * lit.coverage;
        if weight > 0.0 {
            sum += weight * subsurface(medium, between, lit.normal, TO_LIGHT, n_o);
        }
    }
    return sum;
}
