// Samples on a disc across the light for kernels of every width at once: a lattice in the angle and in the logarithm of the radius.
//
// The radius of u in 0..1 is c (e^(L u) - 1): even within the core c, where the kernel is flat, and even in the logarithm beyond. The
// integrand is 0 at both ends of u and periodic in the angle, so a lattice converges fast where the light is smooth. Each point shifts
// the lattice by an amount of its own. Where the light grazes the surface, the disc is as narrow as the light sees one on the surface.

const PI = 3.14159265358979;

struct Disc {
    samples: u32,
    // Shift of the lattice in u and in the angle's turn.
    shift: vec2f,
    core: f32,
    // L.
    decades: f32,
    // The direction in which the disc is narrower, and how much.
    steepest: vec2f,
    narrowing: f32,
}

// A hash with good avalanche (PCG; O'Neill 2014), as two numbers in 0..1.
fn hash(seed: vec2u) -> vec2f {
    var state = seed.x * 747796405u + seed.y * 2891336453u + 2891336453u;
    state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    let first = (state >> 22u) ^ state;
    state = first * 747796405u + 2891336453u;
    state = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    let second = (state >> 22u) ^ state;
    return vec2f(f32(first >> 8u), f32(second >> 8u)) / 16777216.0;
}

fn disc_of(x_o: vec3f, index: u32) -> Disc {
    // Below the lit surface the kernel is as wide as the point is deep.
    let above = lit_at(x_o.xy);
    let depth = select(0.0, max(above.w - x_o.z, 0.0), any(above.xyz != vec3f(0.0)));
    let core = estimator.core + 0.05 * depth;
    // Beyond e^-14 there is nothing to see: where mu sqrt(depth^2 + radius^2) exceeds mu depth by 14.
    let fade = 14.0 / max(estimator.least_mu, 1e-20);
    // No narrower than that: near a terminator the surface bends away within the disc.
    let narrowing = select(1.0, clamp(above.z, 0.3, 1.0), any(above.xyz != vec3f(0.0)));
    let slant = length(above.xy);
    let steepest = select(vec2f(1.0, 0.0), above.xy / max(slant, 1e-6), slant > 1e-6);
    let radius = min(sqrt(fade) * sqrt(fade + 2.0 * depth), estimator.radius) / narrowing;
    // Further sets of samples fill the gaps of the earlier ones (R2 sequence; Roberts 2018).
    let shift = fract(hash(vec2u(index, 0u)) + f32(estimator.pass_index) * vec2f(0.7548776662, 0.5698402910));
    // None at a point that is nowhere. (So the number is not the same for all points, or Lavapipe would compile the kernel anew for it and
    // for all that it is in one buffer with, whenever a light turns.)
    let samples = select(0u, estimator.samples, core > 0.0);
    return Disc(samples, shift, core, log(1.0 + radius / core), steepest, narrowing);
}

// A place on the disc, and its weight: the area that it stands for.
fn disc_sample(disc: Disc, i: u32) -> vec3f {
    let u = (f32(i) + disc.shift.x) / f32(disc.samples);
    // The golden ratio, in fixed point so that no bit is lost.
    let turn = fract(f32((i * 2654435769u) >> 8u) / 16777216.0 + disc.shift.y);
    let stretched = disc.core * exp(disc.decades * u);
    let radius = stretched - disc.core;
    let weight = disc.narrowing * 2.0 * PI * radius * stretched * disc.decades / f32(disc.samples);
    let along = disc.narrowing * radius * cos(2.0 * PI * turn);
    let across = radius * sin(2.0 * PI * turn);
    return vec3f(along * disc.steepest + across * vec2f(-disc.steepest.y, disc.steepest.x), weight);
}
