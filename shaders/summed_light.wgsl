// Scattered light of all lights together: what the ray caster looks up.
//
// reads  fluence of each light, for an irradiance of 1, and of those that share one, with theirs
// writes rgba16float: fluence as a share of `scale`

struct Summation {
    cells: vec3u,
    lights: u32,
}

@group(0) @binding(0) var<uniform> summation: Summation;
// Irradiance of a light as a share of `scale`.
@group(0) @binding(1) var<storage, read> irradiances: array<vec4f>;
@group(0) @binding(2) var<storage, read> scattered: array<vec4f>;
@group(0) @binding(3) var fluence: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(64)
fn add_up(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = summation.cells;
    let count = n.x * n.y * n.z;
    if index >= count {
        return;
    }
    var sum = vec3f(0.0);
    for (var light = 0u; light < summation.lights; light += 1u) {
        sum += irradiances[light].rgb * scattered[light * count + index].rgb;
    }
    let cell = vec3u(index % n.x, (index / n.x) % n.y, index / (n.x * n.y));
    textureStore(fluence, cell, vec4f(sum, 0.0));
}
