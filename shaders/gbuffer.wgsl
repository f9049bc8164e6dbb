// A mesh seen from one side, by its light or by one of its scattering cameras: what is nearest, and in which direction that faces.
//
// reads  vertices (position, normal), the mesh
// writes rgba32float: normal in the view's space (z towards the viewer; all 0 where nothing is seen), height towards the viewer

struct SeenMesh {
    // To the view: x and y across it, z towards the viewer, in units of the body.
    view_from_mesh: mat4x4f,
    view_from_mesh_normal: mat4x4f,
    // The middle of the view, and one over half of its sides.
    centre: vec3f,
    // 1 for the body that is looked at, 0 for what only stands in its light.
    is_seen: f32,
    inverse_half: vec3f,
}

@group(0) @binding(0) var<uniform> mesh: SeenMesh;

struct Varyings {
    @builtin(position) position_in_clip: vec4f,
    @location(0) position_in_view: vec3f,
    @location(1) normal_in_view: vec3f,
}

@vertex
fn transform(@location(0) position: vec3f, @location(1) normal: vec3f) -> Varyings {
    let position_in_view = (mesh.view_from_mesh * vec4f(position, 1.0)).xyz;
    let normal_in_view = (mesh.view_from_mesh_normal * vec4f(normal, 0.0)).xyz;
    let device = (position_in_view - mesh.centre) * mesh.inverse_half;
    // Reversed depth: what is nearest to the viewer has 1.
    return Varyings(vec4f(device.xy, 0.5 + 0.5 * device.z, 1.0), position_in_view, normal_in_view);
}

@fragment
fn record(in: Varyings) -> @location(0) vec4f {
    // The side that is seen decides which way the normal points.
    let across = cross(dpdx(in.position_in_view), dpdy(in.position_in_view));
    let towards_viewer = across * sign(across.z);
    let facing = normalize(in.normal_in_view);
    let normal = select(-facing, facing, dot(facing, towards_viewer) >= 0.0);
    return vec4f(mesh.is_seen * normal, in.position_in_view.z);
}
