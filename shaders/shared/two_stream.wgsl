// Multiply scattered light in two streams along an axis, for three colours at once: src/optics/two_stream.rs, in 32 bits.
//
// d D / dz = -gamma1 D + gamma2 U + S (1 + b) / 2, and U the other way; gamma2 = 3/2 mu1 sigma_s (1 - g), gamma1 = gamma2 + sigma_a / mu1.
// The light that feeds S is T' = T^(1 - albedo f), f = g^2 (0 for g < 0), b = 3/2 g' mu0, g' = g / (1 + g) (g for g < 0).
// Meador and Weaver 1980; Joseph, Wiscombe and Weinman 1976.

const TWO_STREAM_MU1: f32 = 0.45;

// Share of the streams of a layer that turns round, goes on and is absorbed, which sum to 1, and what comes of the light, per irradiance.
struct TwoStreamLayer {
    r: vec3f,
    t: vec3f,
    absorbed: vec3f,
    s_forward: vec3f,
    s_backward: vec3f,
}

// All layers before a face: 1 less their reflectance, and what comes out of them if nothing comes in.
struct TwoStreamStack {
    kept: vec3f,
    down: vec3f,
}

struct TwoStreams {
    forward: vec3f,
    backward: vec3f,
}

// Extinction of T' by that of the direct light.
fn two_stream_beam(albedo: vec3f, g: f32) -> vec3f {
    let ahead = max(g, 0.0);
    return (1.0 - albedo) + albedo * ((1.0 - ahead) * (1.0 + ahead));
}

// (1 - exp(-x)) / x
fn two_stream_lessening(x: vec3f) -> vec3f {
    let series = 1.0 - x * (1.0 / 2.0 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x * (1.0 / 720.0)))));
    return select((1.0 - exp(-x)) / max(x, vec3f(0.1)), series, x < vec3f(0.3));
}

// A layer of the optical thickness `tau` along the axis, its light at the cosine `mu0` to it and T' of `first` and `second` at its ends.
fn two_stream_layer(tau_given: f32, albedo: vec3f, g: f32, mu0: f32, first: vec3f, second: vec3f) -> TwoStreamLayer {
    let tau = min(tau_given, 1e9);
    let scattered = albedo * tau;
    let lost = (1.0 - albedo) * (tau / TWO_STREAM_MU1);
    let turned = 1.5 * TWO_STREAM_MU1 * (1.0 - g) * scattered;
    let gamma = sqrt(lost) * sqrt(lost + 2.0 * turned);

    // The mean of T', and how far from the first end it loses its light on average.
    let greater = max(first, second);
    let less = min(first, second);
    let fall = greater - less;
    let x = fall / max(greater, vec3f(1e-37));
    let thin = x < vec3f(0.1);
    let ratio = 1.0 / (1.0 + x * (1.0 / 2.0 + x * (1.0 / 3.0 + x * (1.0 / 4.0 + x * (1.0 / 5.0 + x * (1.0 / 6.0))))));
    let rest = less / max(greater, vec3f(1e-37));
    // With less than that left it is `left` below that counts.
    let steep = select(x / max(-log(max(rest, vec3f(1e-30))), vec3f(0.1)), vec3f(0.0), rest < vec3f(1e-30));
    let logarithmic = greater * select(steep, ratio, thin);
    let depth = two_stream_beam(albedo, g) * (tau / max(abs(mu0), 1e-6));
    let left = select(fall / max(depth, vec3f(1e-37)), vec3f(0.0), depth <= vec3f(0.0));
    let mean = min(max(logarithmic, left), 0.5 * (greater + less));
    let series = 0.5 - x * (1.0 / 12.0 + x * (1.0 / 24.0 + x * (19.0 / 720.0)));
    let far = select((mean - less) / max(fall, vec3f(1e-37)), series, x < vec3f(0.03));
    let above = clamp(select(1.0 - far, far, first >= second), vec3f(0.0), vec3f(1.0));
    let below = 1.0 - above;

    let e_above = exp(-gamma * above);
    let e_below = exp(-gamma * below);
    let e = e_above * e_below;
    let whole = 2.0 * two_stream_lessening(2.0 * gamma);
    let by = 1.0 / (1.0 + e * e + (lost + turned) * whole);

    let ahead = max(g, 0.0);
    let g_prime = g / (1.0 + ahead);
    let source = (1.0 - ahead) * (1.0 + ahead) * scattered * mean;
    let bias = clamp(1.5 * g_prime * mu0, -1.0, 1.0);
    let rise_above = 2.0 * above * two_stream_lessening(2.0 * gamma * above) * e_below;
    let rise_below = 2.0 * below * two_stream_lessening(2.0 * gamma * below) * e_above;
    let forward = e_below * (1.0 + e_above * e_above) + lost * rise_above;
    let backward = e_above * (1.0 + e_below * e_below) + lost * rise_below;
    let gone = gamma * two_stream_lessening(gamma);
    return TwoStreamLayer(
        turned * whole * by,
        2.0 * e * by,
        (gone * gone + lost * whole) * by,
        source * (0.5 * (1.0 + bias) * forward + turned * rise_above) * by,
        source * (0.5 * (1.0 - bias) * backward + turned * rise_below) * by,
    );
}

// Sum over light that goes to and fro between a stack and a layer.
fn two_stream_rounds(stack: TwoStreamStack, layer: TwoStreamLayer) -> vec3f {
    return 1.0 / max(stack.kept + (1.0 - stack.kept) * (layer.t + layer.absorbed), vec3f(1e-37));
}

// A step of the sweep forward, from a stack of (1, 0).
fn two_stream_add(stack: TwoStreamStack, layer: TwoStreamLayer) -> TwoStreamStack {
    let r = 1.0 - stack.kept;
    let rounds = two_stream_rounds(stack, layer);
    let left = layer.t + layer.absorbed;
    return TwoStreamStack(
        (left * stack.kept + r * layer.absorbed * (2.0 * layer.t + layer.absorbed)) * rounds,
        layer.s_forward + layer.t * (stack.down + r * layer.s_backward) * rounds,
    );
}

// A step of the sweep back: the streams before `layer`, of which `stack` is before, from what comes to it from behind.
fn two_stream_resolve(stack: TwoStreamStack, layer: TwoStreamLayer, behind: vec3f) -> TwoStreams {
    let up = layer.s_backward + layer.t * behind;
    let forward = (stack.down + (1.0 - stack.kept) * up) * two_stream_rounds(stack, layer);
    return TwoStreams(forward, up + layer.r * forward);
}

// Scattered radiance at the cosine `cosine` to the axis, per albedo.
fn two_stream_scattered(streams: TwoStreams, g: f32, cosine: f32) -> vec3f {
    let fluence = (streams.forward + streams.backward) / TWO_STREAM_MU1;
    return max(fluence + 3.0 * g * cosine * (streams.forward - streams.backward), vec3f(0.0)) / 12.566370614359172;
}
