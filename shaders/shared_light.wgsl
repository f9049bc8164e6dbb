// Light of lights that have no light volume of their own, in the cells of a volume: what arrives of each, and what of it was scattered before.
//
// reads  light cells, one light's scattered light, its light volume, the shadow of meshes
// writes one vec4f a cell: fluence, summed over such lights

#import peak
#import light_volumes
#import shadows

struct Share {
    // Irradiance of the light.
    irradiance: vec3f,
    cells: vec3u,
    // Mean cosine of scattering in a peak that counts as none; 0 where light is scattered once.
    g: f32,
    // What is there already counts so much.
    keep: f32,
}

@group(0) @binding(0) var<uniform> share: Share;
@group(0) @binding(1) var light_cells: texture_3d<f32>;
@group(0) @binding(2) var<storage, read> scattered: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> fluence: array<vec4f>;

@compute @workgroup_size(64)
fn add(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = share.cells;
    if index >= n.x * n.y * n.z {
        return;
    }
    let cell = vec3u(index % n.x, (index / n.x) % n.y, index / (n.x * n.y));
    let extinction = beam_extinction(textureLoad(light_cells, cell, 0).rgb, share.g);
    var arriving = vec3f(0.0);
    for (var corner = 0u; corner < 8u; corner += 1u) {
        let part = 0.25 + 0.5 * vec3f(f32(corner & 1u), f32((corner >> 1u) & 1u), f32(corner >> 2u));
        let place = (vec3f(cell) + part) / vec3f(n);
        arriving += 0.125 * light_seen(0u, place) * exp(-light_depth(0u, place) * extinction);
    }
    let before = select(fluence[index].rgb, vec3f(0.0), share.keep == 0.0);
    fluence[index] = vec4f(before + share.irradiance * (arriving + scattered[index].rgb), 0.0);
}
