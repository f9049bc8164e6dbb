// What is found at a place of a volume, and how texels say it. Imported by the module `volumes`, which has `voxel_at`.

struct Voxel {
    // The value, as a texel holds it.
    texel: f32,
    // How much of what surrounds the place is there: below 1 beside samples that are missing.
    share: f32,
    // What that leaves of the extinction.
    shown: f32,
}

// Of a volume in which every voxel has a value.
fn plain(texel: vec4f) -> Voxel {
    return Voxel(texel.r, 1.0, 1.0);
}

// Of one in which some have none. Texels are (value, 1) and (0, 0), so what lies between them is the mean of the values that there are, by
// their weights. The medium ends where half of them are missing, within a quarter on both sides, so that samples do not show as steps.
fn masked(texel: vec4f) -> Voxel {
    return Voxel(texel.r / max(texel.g, 1e-30), texel.g, clamp(2.0 * texel.g - 0.5, 0.0, 1.0));
}
