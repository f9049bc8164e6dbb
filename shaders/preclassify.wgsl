// The transfer function at each voxel of a volume, for those that interpolate what it gives.
//
// reads  a volume texture, its lookup table: colour, sigma_t per scene unit
// writes rgba16float, a texel a voxel: colour times sigma_t, and sigma_t, both as shares of the greatest; nothing where a sample is missing

#import texels

struct Voxels {
    // Place in the table = texel * scale + offset.
    lookup_scale: f32,
    lookup_offset: f32,
    // Entries of the table, and whether each is a value of its own.
    entries: u32,
    is_exact: u32,
    // What colour and extinction are shares of.
    greatest_colour: f32,
    greatest_extinction: f32,
}

@group(0) @binding(0) var<uniform> voxels: Voxels;
@group(0) @binding(1) var samples: texture_3d<f32>;
@group(0) @binding(2) var table: texture_2d<f32>;
@group(0) @binding(3) var classified: texture_storage_3d<rgba16float, write>;

fn entry(index: u32) -> vec4f {
    return textureLoad(table, vec2u(index % TABLE_ROW, index / TABLE_ROW), 0);
}

@compute @workgroup_size(64)
fn preclassify(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let size = textureDimensions(samples);
    let index = id.x + id.y * groups.x * 64u;
    let row = index / size.x;
    let voxel = vec3u(index % size.x, row % size.y, row / size.y);
    if voxel.z >= size.z {
        return;
    }
    let here = voxel_of(textureLoad(samples, voxel, 0));
    let last = f32(voxels.entries - 1u);
    let between = clamp(here.texel * voxels.lookup_scale + voxels.lookup_offset, 0.0, 1.0) * last;
    let place = select(between, round(between), voxels.is_exact == 1u);
    let below = min(floor(place), last - 1.0);
    let found = mix(entry(u32(below)), entry(u32(below) + 1u), place - below);
    let extinction = here.shown * found.a / voxels.greatest_extinction;
    let shares = vec4f(found.rgb * here.tint / voxels.greatest_colour * extinction, extinction);
    textureStore(classified, voxel, shares);
}
