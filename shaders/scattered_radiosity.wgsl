// What the light that entered a translucent body elsewhere sends out of it, point by point: M_o, for each point a sum over samples of
// the lit surface (see estimator). The radiance that leaves in the direction omega_o is T(eta, omega_o) M_o.
//
// reads  points (vertices of the refined mesh; all of them, or those on a list), the light G-buffer
// writes one vec4f a point: M_o, mean over all sets of samples so far, per unit of a light's irradiance or of all lights together

#import estimator
#import listing

@group(0) @binding(0) var<uniform> medium: Medium;
@group(0) @binding(1) var<uniform> estimator: Estimator;
@group(0) @binding(2) var light_gbuffer: texture_2d<f32>;
// Position and normal of each vertex, in mesh space.
@group(0) @binding(3) var<storage, read> vertices: array<f32>;
@group(0) @binding(4) var<storage, read_write> radiosity: array<vec4f>;

@compute @workgroup_size(64)
fn at_points(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let invocation = id.x + id.y * groups.x * 64u;
    if invocation >= listed_points() {
        return;
    }
    let index = listed_point(invocation);
    let at = 6u * index;
    let position = vec3f(vertices[at], vertices[at + 1u], vertices[at + 2u]);
    let normal = vec3f(vertices[at + 3u], vertices[at + 4u], vertices[at + 5u]);
    let x_o = (estimator.light_from_mesh * vec4f(position, 1.0)).xyz;
    let n_o = normalize((estimator.light_from_mesh_normal * vec4f(normal, 0.0)).xyz);
    let place = estimator.first + index;
    let before = select(radiosity[place].xyz, vec3f(0.0), estimator.keep == 0.0);
    radiosity[place] = vec4f(estimator.keep * before + estimator.gain * scattered(medium, x_o, n_o, index), 1.0);
}
