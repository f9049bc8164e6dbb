// The light that leaves each point of a translucent body, of all lights together: what the surface pass interpolates.
//
// reads  one vec4f a point and light
// writes one vec4f a point: M_o

struct Combination {
    points: u32,
    lights: u32,
}

@group(0) @binding(0) var<uniform> combination: Combination;
// What the layer of each light is multiplied by.
@group(0) @binding(1) var<storage, read> irradiances: array<vec4f>;
@group(0) @binding(2) var<storage, read> layers: array<vec4f>;
@group(0) @binding(3) var<storage, read_write> radiosity: array<vec4f>;

@compute @workgroup_size(64)
fn combine(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= combination.points {
        return;
    }
    var sum = vec3f(0.0);
    for (var light = 0u; light < combination.lights; light += 1u) {
        sum += irradiances[light].xyz * layers[light * combination.points + index].xyz;
    }
    radiosity[index] = vec4f(sum, 1.0);
}
