// Light that goes on towards the eye: in a medium that scatters forwards, what is seen of a place has come through what is behind it.
//
// Henyey and Greenstein's phase function is taken for a share 1 - g that is scattered evenly and g that goes on within a cone. Along the way
// to the eye
//
//   dL/ds = -sigma_t (1 - albedo g) L + sigma_t albedo (sum over lights of p E T' + (1 - g) fluence / 4 pi),
//
// with p and T' without the peak, which goes on with the light itself. The network has the same share 1 - g leave its way, so what is seen is
// what was let out. From slice to slice the cone spreads as in `cells.wgsl`. The way is that of the middle of the volume to the eye.
//
// reads  light cells, fluence, light volumes, shadows of meshes
// writes radiance towards the eye, as a share of `scale`

#import cells
#import peak
#import light_volumes
#import shadows

struct EyeSweep {
    // Cells across that the way moves from slice to slice.
    slope: vec2f,
    lights: u32,
    // Fluence = texel * this.
    scale: f32,
}

@group(0) @binding(4) var fluence: texture_3d<f32>;
@group(0) @binding(5) var<storage, read_write> towards_eye: array<vec4f>;
@group(0) @binding(6) var<uniform> eye: EyeSweep;
// Irradiance of each light times the phase function from it to the eye, without its peak.
@group(0) @binding(7) var<storage, read> sources: array<vec4f>;
@group(0) @binding(8) var eye_light: texture_storage_3d<rgba16float, write>;

// What has come to a cell of a slice from the slice before, whole cells aside.
fn arrived(across: vec2u, slice_index: u32) -> vec3f {
    let before = vec2i(round(eye.slope * f32(slice_index - 1u)));
    let there = vec2i(across) - (vec2i(round(eye.slope * f32(slice_index))) - before);
    if any(there < vec2i(0)) || any(there >= vec2i(extent().xy)) {
        return vec3f(0.0);
    }
    return spread_out(vec2u(there), (slice_index - 1u) & 1u);
}

@compute @workgroup_size(64)
fn sweep(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = extent();
    let columns = n.x * n.y;
    if index >= columns {
        return;
    }
    let across = vec2u(index % n.x, index / n.x);
    let here = slice.index;
    let at = cell_of(across, here);
    let cell = textureLoad(light_cells, at, 0);
    let beam = beam_extinction(cell.rgb, sweep_of.g);
    var arriving = (1.0 - sweep_of.g) / 12.566370614359172 * eye.scale * textureLoad(fluence, at, 0).rgb;
    for (var i = 0u; i < eye.lights; i += 1u) {
        let place = place_of(vec2f(across) + 0.5, f32(here) + 0.5);
        arriving += sources[i].rgb * light_seen(i, place) * exp(-light_depth(i, place) * beam);
    }
    let lost = 1.0 - cell.rgb * sweep_of.g;
    let source = cell.rgb * arriving / max(lost, vec3f(1e-6));
    let depth = cell.a * lost * (sweep_of.along / max(sweep_of.mu0, 1e-3));
    var before = vec3f(0.0);
    if here > 0u {
        before = arrived(across, here);
    }
    let mean = vec3f(lessening(depth.x), lessening(depth.y), lessening(depth.z));
    let after = before + (source - before) * depth * mean;
    faces[2u * ((here & 1u) * columns + index)] = vec4f(after, spread_in(cell));
    let out = (at.z * sweep_of.cells.y + at.y) * sweep_of.cells.x + at.x;
    towards_eye[out] += vec4f(sweep_of.shares[sweep_of.axis] * (source + (before - source) * mean), 0.0);
}

@compute @workgroup_size(64)
fn keep(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = sweep_of.cells;
    if index >= n.x * n.y * n.z {
        return;
    }
    let cell = vec3u(index % n.x, (index / n.x) % n.y, index / (n.x * n.y));
    textureStore(eye_light, cell, towards_eye[index] / max(eye.scale, 1e-30));
}
