// How much of a light a place sees past meshes, from the four texels around it of the light's view: `volume_shadow.rs`.

// The texel at one of the four corners about a place in texels.
fn shadow_texel(at: vec3f, corner: u32, size: vec2u) -> vec2u {
    let low = vec2i(floor(at.xy - 0.5));
    return vec2u(clamp(low + vec2i(i32(corner & 1u), i32(corner >> 1u)), vec2i(0), vec2i(size) - 1));
}

// Whether a place is above what a texel shows (normal, height), or that is nothing.
fn shadow_misses(texel: vec4f, height: f32) -> f32 {
    return select(0.0, 1.0, texel.w <= height || all(texel.xyz == vec3f(0.0)));
}

// The share of the light that comes past.
fn shadow_share(at: vec3f, a: vec4f, b: vec4f, c: vec4f, d: vec4f) -> f32 {
    let part = fract(at.xy - 0.5);
    let above = mix(shadow_misses(a, at.z), shadow_misses(b, at.z), part.x);
    let below = mix(shadow_misses(c, at.z), shadow_misses(d, at.z), part.x);
    return mix(above, below, part.y);
}
