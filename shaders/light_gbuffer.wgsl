// A mesh as its light sees it: what the light reaches, and in which direction that faces.
//
// reads  vertices (position, normal), the mesh
// writes rgba32float: normal in light space (z towards the light, so above 0; all 0 where no light arrives), height towards the light

struct LightMesh {
    // To the light's view: x and y across the light, z towards it, in units of the body.
    light_from_mesh: mat4x4f,
    light_from_mesh_normal: mat4x4f,
    // The middle of the view, and one over half of its sides.
    centre: vec3f,
    // 1 for the body that scatters, 0 for what only stands in its light.
    is_lit: f32,
    inverse_half: vec3f,
}

@group(0) @binding(0) var<uniform> mesh: LightMesh;

struct Varyings {
    @builtin(position) position_in_clip: vec4f,
    @location(0) position_in_light: vec3f,
    @location(1) normal_in_light: vec3f,
}

@vertex
fn transform(@location(0) position: vec3f, @location(1) normal: vec3f) -> Varyings {
    let position_in_light = (mesh.light_from_mesh * vec4f(position, 1.0)).xyz;
    let normal_in_light = (mesh.light_from_mesh_normal * vec4f(normal, 0.0)).xyz;
    let device = (position_in_light - mesh.centre) * mesh.inverse_half;
    // Reversed depth: what is nearest to the light has 1.
    return Varyings(vec4f(device.xy, 0.5 + 0.5 * device.z, 1.0), position_in_light, normal_in_light);
}

@fragment
fn record(in: Varyings) -> @location(0) vec4f {
    // The side that the light sees decides which way the normal points.
    let across = cross(dpdx(in.position_in_light), dpdy(in.position_in_light));
    let towards_light = across * sign(across.z);
    let facing = normalize(in.normal_in_light);
    let normal = select(-facing, facing, dot(facing, towards_light) >= 0.0);
    return vec4f(mesh.is_lit * normal, in.position_in_light.z);
}
