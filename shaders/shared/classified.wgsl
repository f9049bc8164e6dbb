// The medium that a transfer function makes of a volume, place by place, for kernels that sweep it.

#import volumes

struct Classified {
    // Place in the table = texel * scale + offset.
    lookup_scale: f32,
    lookup_offset: f32,
    // The last entry of the table.
    last: f32,
    // Texels beyond this touch a sample that is not finite.
    sentinel: f32,
    // Voxels along each axis.
    size: vec3f,
    bricks: vec3u,
}

@group(0) @binding(0) var<uniform> classified: Classified;
// Colour and sigma_t per scene unit.
@group(0) @binding(1) var table: texture_2d<f32>;
@group(0) @binding(2) var brick_distances: texture_2d<u32>;
@group(0) @binding(3) var linear_sampler: sampler;

fn holds_nothing(place: vec3f) -> bool {
    let at = vec3u(clamp(place * classified.size / BRICK, vec3f(0.0), vec3f(classified.bricks) - 0.5));
    let brick = (at.z * classified.bricks.y + at.y) * classified.bricks.x + at.x;
    return textureLoad(brick_distances, vec2u(brick % BRICK_ROW, brick / BRICK_ROW), 0).r != 0u;
}

// Colour and sigma_t per scene unit, constant beyond the faces of the volume.
fn classified_at(place: vec3f) -> vec4f {
    let inside = clamp(place, vec3f(0.0), vec3f(1.0));
    if holds_nothing(inside) {
        return vec4f(0.0);
    }
    let texel = texel_at(0u, inside);
    let at = clamp(texel * classified.lookup_scale + classified.lookup_offset, 0.0, 1.0) * classified.last;
    let below = min(floor(at), classified.last - 1.0);
    let entry = vec2u(u32(below), 0u);
    let found = mix(textureLoad(table, entry, 0), textureLoad(table, entry + vec2u(1u, 0u), 0), at - below);
    return select(found, vec4f(0.0), texel > classified.sentinel);
}
