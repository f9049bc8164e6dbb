// The light volume of a volume and a light: its columns, see `src/passes/light_volume/sweep.rs`.

struct Sweep {
    // Place in the texture of the columns, from 0 to 1: repeated across, clamped along.
    texel_from_texture: mat4x4f,
    // The way back towards the light inside the volume, in slices, is the least of place * scale + offset over the axes.
    reach_scale: vec3f,
    reach_offset: vec3f,
    // Columns across, and slices.
    size: vec3f,
    // How far light travels from slice to slice, in the texture of the volume.
    step: vec3f,
    // The same in scene units.
    slice: f32,
}

// How far light has come through the volume to a place in it, in slices.
fn light_reach(sweep: Sweep, place: vec3f) -> f32 {
    let reach = place * sweep.reach_scale + sweep.reach_offset;
    return max(min(reach.x, min(reach.y, reach.z)), 0.0);
}

// A straight way through the volume, place = start + direction * along, among the columns: nothing but sums are left to do along it.
struct LightWay {
    texel: vec3f,
    texel_pace: vec3f,
    reach: vec3f,
    reach_pace: vec3f,
}

fn way_through(sweep: Sweep, start: vec3f, direction: vec3f) -> LightWay {
    return LightWay(
        (sweep.texel_from_texture * vec4f(start, 1.0)).xyz,
        (sweep.texel_from_texture * vec4f(direction, 0.0)).xyz,
        start * sweep.reach_scale + sweep.reach_offset,
        direction * sweep.reach_scale,
    );
}

fn reach_on(way: LightWay, along: f32) -> f32 {
    let reach = way.reach + way.reach_pace * along;
    return max(min(reach.x, min(reach.y, reach.z)), 0.0);
}

// A texel of a repeated grid, for interpolation by hand.
fn light_texel(sweep: Sweep, at: vec3i) -> vec3i {
    let size = vec3i(sweep.size);
    let across = ((at.xy % size.xy) + size.xy) % size.xy;
    return vec3i(across, clamp(at.z, 0, size.z - 1));
}

// Where the way from a place towards the light first meets the volume, in slices from the place; less than 0 where it never does.
fn light_meets(sweep: Sweep, place: vec3f) -> f32 {
    let back = select(-sweep.step, vec3f(1e-30), abs(sweep.step) < vec3f(1e-30));
    let a = -place / back;
    let b = (1.0 - place) / back;
    let near = min(a, b);
    let far = max(a, b);
    let enter = max(max(near.x, near.y), max(near.z, 0.0));
    return select(-1.0, enter, enter < min(far.x, min(far.y, far.z)));
}
