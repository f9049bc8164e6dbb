// What is found at a place of a volume, and how texels say it. Imported by the module `volumes`, which has `voxel_at`.

struct Voxel {
    // The value, as a texel holds it.
    texel: f32,
    // How much of what surrounds the place is there: below 1 beside samples that are missing.
    share: f32,
    // What that leaves of the extinction.
    shown: f32,
    // Linear colour of the data itself, which colours of the transfer function are times.
    tint: vec3f,
}

// Of a volume in which every voxel has a value.
fn plain(texel: vec4f) -> Voxel {
    return Voxel(texel.r, 1.0, 1.0, vec3f(1.0));
}

// Of one in which some have none. Texels are (value, 1) and (0, 0), so what lies between them is the mean of the values that there are, by
// their weights. The medium ends where half of them are missing, within a quarter on both sides, so that samples do not show as steps.
fn masked(texel: vec4f) -> Voxel {
    return Voxel(texel.r / max(texel.g, 1e-30), texel.g, clamp(2.0 * texel.g - 0.5, 0.0, 1.0), vec3f(1.0));
}

// Of one in which they are colours. Texels are red, green and blue as sRGB encodes them, 0 to 255, times opacity, and opacity. The value is the
// luminance of the colour between voxels, by the weights of ITU-R BT.709; what is clear counts for nothing.
fn coloured(texel: vec4f) -> Voxel {
    let encoded = texel.rgb / max(texel.a, 1e-30);
    return Voxel(dot(encoded, vec3f(0.2126, 0.7152, 0.0722)), texel.a, texel.a, linear_of_srgb(encoded / 255.0));
}

fn linear_of_srgb(encoded: vec3f) -> vec3f {
    let above = pow(max((encoded + 0.055) / 1.055, vec3f(0.0)), vec3f(2.4));
    return select(above, encoded / 12.92, encoded <= vec3f(0.04045));
}
