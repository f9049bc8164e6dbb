// Henyey and Greenstein's phase function (1941), per steradian: its integral over the sphere is 1 and its mean cosine g.
//
// Nothing cancels and nothing is divided by g, so that 32 bits are enough for every g between -1 and 1.

// For light that travels in the direction `before` and then in `after`, both of unit length. 1 - cos (or 1 + cos, where light is thrown
// back) comes of the vectors' difference: their product has lost it already.
fn henyey_greenstein(before: vec3f, after: vec3f, g: f32) -> f32 {
    let apart = select(before - after, before + after, g < 0.0);
    let least = 1.0 - abs(g);
    let spread = least * least + abs(g) * dot(apart, apart);
    return (1.0 - g) * (1.0 + g) / (12.566370614359172 * spread * sqrt(spread));
}

// Cosine and sine of the angle by which light is scattered, less than which has the probability `u` in 0..1 for the cosine.
// With v = 1 - u the common form's denominator is (1 - g) v + (1 + g) u, a sum of what cannot cancel, and so are 1 - cos and 1 + cos.
fn henyey_greenstein_angle(u: f32, g: f32) -> vec2f {
    let v = 1.0 - u;
    let ahead = 1.0 + g;
    let back = 1.0 - g;
    let split = back * v + ahead * u;
    let above = 2.0 * (back / split) * (back / split) * v * (v + ahead * u);
    let below = 2.0 * (ahead / split) * (ahead / split) * u * (u + back * v);
    return vec2f(select(below - 1.0, 1.0 - above, above < below), sqrt(above * below));
}

// A direction into which light that travels in the direction `before` is scattered, for two random numbers in 0..1.
fn henyey_greenstein_sample(before: vec3f, u: vec2f, g: f32) -> vec3f {
    let angle = henyey_greenstein_angle(u.x, g);
    let turn = 6.283185307179586 * u.y;
    // Two directions across (Duff and others 2017, "Building an orthonormal basis, revisited").
    let side = select(-1.0, 1.0, before.z >= 0.0);
    let a = -1.0 / (side + before.z);
    let b = before.x * before.y * a;
    let first = vec3f(1.0 + side * before.x * before.x * a, side * b, -side * before.x);
    let second = vec3f(b, side + before.y * before.y * a, -before.y);
    return normalize(angle.x * before + angle.y * (cos(turn) * first + sin(turn) * second));
}
