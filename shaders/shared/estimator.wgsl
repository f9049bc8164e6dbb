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
    // What is there already counts so much, and what is found so much.
    keep: f32,
    gain: vec3f,
}

// The point of the lit surface at a place across the light, as (normal, height). The normal is as long as the share of light that arrives.
fn lit_at(place: vec2f) -> vec4f {
    let at = (place - estimator.low) * estimator.inverse_texel;
    let size = vec2f(textureDimensions(light_gbuffer));
    if any(at < vec2f(0.0)) || any(at >= size) {
        return vec4f(0.0);
    }
    // The first row of a texture is the top.
    let texel = textureLoad(light_gbuffer, vec2u(vec2f(at.x, size.y - 1.0 - floor(at.y))), 0);
    // From the middle of the texel to the place, along the tangent plane.
    let aside = (fract(at) - 0.5) / estimator.inverse_texel;
    let slope = -texel.xy / max(texel.z, 0.01);
    return vec4f(texel.xyz, texel.w + dot(slope, aside));
}

// What leaves at a point for a unit of irradiance. `n_o` is of unit length and points away from the body.
fn scattered(medium: Medium, x_o: vec3f, n_o: vec3f, index: u32) -> vec3f {
    const TO_LIGHT = vec3f(0.0, 0.0, 1.0);
    let disc = disc_of(x_o, index);
    var sum = vec3f(0.0);
    for (var i = 0u; i < disc.samples; i += 1u) {
        let sample = disc_sample(disc, i);
        let lit = lit_at(x_o.xy + sample.xy);
        let between = vec3f(-sample.xy, x_o.z - lit.w);
        if any(lit.xyz != vec3f(0.0)) && sample.z > 0.0 {
            let arrives = length(lit.xyz);
            sum += sample.z * arrives * subsurface(medium, between, lit.xyz / arrives, TO_LIGHT, n_o);
        }
    }
    return sum;
}
