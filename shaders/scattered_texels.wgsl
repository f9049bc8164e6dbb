// What the light that entered a translucent body elsewhere sends out of it, at the texels of scattering cameras: see scattered_radiosity,
// which does the same at points.
//
// reads  the list of texels, the cameras' and the light's G-buffers
// writes rgba32float, a layer a camera: M_o per unit of irradiance; alpha 1 where it was evaluated

#import estimator

@group(0) @binding(0) var<uniform> medium: Medium;
@group(0) @binding(1) var<uniform> estimator: Estimator;
@group(0) @binding(2) var light_gbuffer: texture_2d<f32>;
// Texels, layer << 24 | row << 12 | column, and in front of them nothing else.
@group(0) @binding(3) var<storage, read> texels: array<u32>;
@group(0) @binding(4) var<storage, read> counts: vec2u;
@group(0) @binding(5) var map_gbuffer: texture_2d_array<f32>;
@group(0) @binding(6) var map_radiosity: texture_storage_2d_array<rgba32float, write>;
// From each camera's view to the light's: a rotation.
@group(0) @binding(7) var<storage, read> light_from_view: array<mat4x4f>;
// Of each camera: lower corner of the view and size of its texels.
@group(0) @binding(8) var<storage, read> views: array<vec4f>;

@compute @workgroup_size(64)
fn at_texels(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= counts.x {
        return;
    }
    let packed = texels[index];
    let layer = packed >> 24u;
    let texel = vec2u(packed & 0xfffu, packed >> 12u & 0xfffu);
    let seen = textureLoad(map_gbuffer, texel, layer, 0);
    let up = f32(textureDimensions(map_gbuffer).y - 1u - texel.y);
    let position = vec3f(views[layer].xy + (vec2f(f32(texel.x), up) + 0.5) * views[layer].z, seen.w);
    let x_o = (light_from_view[layer] * vec4f(position, 1.0)).xyz;
    let n_o = normalize((light_from_view[layer] * vec4f(seen.xyz, 0.0)).xyz);
    textureStore(map_radiosity, texel, layer, vec4f(scattered(medium, x_o, n_o, packed), 1.0));
}
