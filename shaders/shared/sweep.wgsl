// The light volume of a volume and a light: its columns, see `src/passes/light_volume/sweep.rs`.

struct Sweep {
    // Place in the texture of the columns, from 0 to 1: repeated across, clamped along.
    texel_from_texture: mat4x4f,
    // The way back towards the light inside the volume, in slices, is the least of place * scale + offset over the axes.
    reach_scale: vec3f,
    reach_offset: vec3f,
    // Columns across, and slices.
    size: vec3f,
}

// How far light has come through the volume to a place in it, in slices.
fn light_reach(sweep: Sweep, place: vec3f) -> f32 {
    let reach = place * sweep.reach_scale + sweep.reach_offset;
    return max(min(reach.x, min(reach.y, reach.z)), 0.0);
}

// A texel of a repeated grid, for interpolation by hand.
fn light_texel(sweep: Sweep, at: vec3i) -> vec3i {
    let size = vec3i(sweep.size);
    let across = ((at.xy % size.xy) + size.xy) % size.xy;
    return vec3i(across, clamp(at.z, 0, size.z - 1));
}
