// The medium that a transfer function makes of a volume, place by place, for kernels that sweep it.

#import volumes

struct Classified {
    // Place in the table = texel * scale + offset.
    lookup_scale: f32,
    lookup_offset: f32,
    // The last entry of the table, and whether each is a value of its own.
    last: f32,
    is_exact: u32,
    // Voxels along each axis.
    size: vec3f,
    bricks: vec3u,
}

@group(0) @binding(0) var<uniform> classified: Classified;
// What is known of each entry: see `Medium`.
@group(0) @binding(1) var table: texture_2d<f32>;
@group(0) @binding(2) var brick_distances: texture_2d<u32>;
@group(0) @binding(3) var linear_sampler: sampler;

// How many bricks away the nearest one is that holds something; 0 if it is the one at a place.
fn brick_distance(place: vec3f) -> f32 {
    let at = vec3u(clamp(place * classified.size / BRICK, vec3f(0.0), vec3f(classified.bricks) - 0.5));
    let brick = (at.z * classified.bricks.y + at.y) * classified.bricks.x + at.x;
    return f32(textureLoad(brick_distances, vec2u(brick % BRICK_ROW, brick / BRICK_ROW), 0).r);
}

// What is at a place of the volume; constant beyond its faces.
fn voxel_in(place: vec3f) -> Voxel {
    return voxel_at(0u, clamp(place, vec3f(0.0), vec3f(1.0)));
}

// Its place in the table, in entries.
fn entry_of(voxel: Voxel) -> f32 {
    let place = clamp(voxel.texel * classified.lookup_scale + classified.lookup_offset, 0.0, 1.0) * classified.last;
    return select(place, round(place), classified.is_exact == 1u);
}

fn entry(index: u32) -> vec4f {
    return textureLoad(table, vec2u(index % TABLE_ROW, index / TABLE_ROW), 0);
}
