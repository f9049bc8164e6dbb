// Meshes: the radiance that each pixel's nearest surface sends to the eye, and how far away it is.
//
//   opaque       L = ambient + sum over lights of (diffuse/pi + specular (s+8)/(8 pi) (n.h)^s) E max(n.l, 0)
//   translucent  L = rho T(eta, n.o) M_o + sum over lights of specular (s+8)/(8 pi) (n.h)^s E max(n.l, 0)
//
// with E the irradiance that volumes in the way leave, diffuse the albedo times what the colours of the vertices and the picture say, and rho
// only the latter.
//
// reads  vertices (position, normal; what leaves there; colour, texture coordinate), the mesh, its picture, lights, light volumes
// writes rgba32float: radiance, distance along the ray (FAR where there is no surface)

#import albedo
#import frame
#import fresnel
#import lights
#import veils

struct MeshLook {
    ambient: vec3f,
    shininess: f32,
    diffuse: vec3f,
    specular: vec3f,
    // Index of refraction of a translucent mesh.
    eta: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lights: array<Light, LIGHT_CAPACITY>;
// What the meshes look like that are being drawn.
@group(0) @binding(2) var<uniform> mesh: MeshLook;

// Where one of them is: columns that take it to eye space, and the inverse transpose, which takes normals there.
struct MeshPlace {
    @location(5) x: vec3f,
    @location(6) y: vec3f,
    @location(7) z: vec3f,
    @location(8) origin: vec3f,
    @location(9) normal_x: vec3f,
    @location(10) normal_y: vec3f,
    @location(11) normal_z: vec3f,
}

struct Varyings {
    @builtin(position) position_in_clip: vec4f,
    @location(0) position_in_eye: vec3f,
    @location(1) normal_in_eye: vec3f,
}

fn transformed(position: vec3f, normal: vec3f, place: MeshPlace) -> Varyings {
    let position_in_eye = mat4x3f(place.x, place.y, place.z, place.origin) * vec4f(position, 1.0);
    let normal_in_eye = mat3x3f(place.normal_x, place.normal_y, place.normal_z) * normal;
    return Varyings(frame.clip_from_eye * vec4f(position_in_eye, 1.0), position_in_eye, normal_in_eye);
}

@vertex
fn transform(@location(0) position: vec3f, @location(1) normal: vec3f, place: MeshPlace) -> Varyings {
    return transformed(position, normal, place);
}

struct Seen {
    position: vec3f,
    normal: vec3f,
    to_eye: vec3f,
    distance: f32,
}

fn seen(in: Varyings) -> Seen {
    let to_eye = select(vec3f(0.0, 0.0, 1.0), -normalize(in.position_in_eye), frame.perspective == 1u);
    let distance = select(-in.position_in_eye.z, length(in.position_in_eye), frame.perspective == 1u);
    // The side that is seen decides which way the normal points, not the interpolated normal: near an outline that leans away from
    // the eye, and turning it would light the outline from behind. Derivatives know the side whatever the winding is.
    let across = cross(dpdx(in.position_in_eye), dpdy(in.position_in_eye));
    let towards_eye = across * sign(dot(across, to_eye));
    let facing = normalize(in.normal_in_eye);
    return Seen(in.position_in_eye, select(-facing, facing, dot(facing, towards_eye) >= 0.0), to_eye, distance);
}

// What reflects the lights towards the eye.
fn reflected(at: Seen, diffuse: vec3f) -> vec3f {
    var radiance = vec3f(0.0);
    for (var i = 0u; i < frame.light_count; i += 1u) {
        let light = lights[i];
        let half_way = normalize(light.to_light + at.to_eye);
        let highlight = (mesh.shininess + 8.0) / (8.0 * PI) * pow(max(dot(at.normal, half_way), 0.0), mesh.shininess);
        radiance += (diffuse / PI + mesh.specular * highlight) * light.irradiance * max(dot(at.normal, light.to_light), 0.0)
            * through_volumes(at.position, i);
    }
    return radiance;
}

struct ColouredVaryings {
    @builtin(position) position_in_clip: vec4f,
    @location(0) position_in_eye: vec3f,
    @location(1) normal_in_eye: vec3f,
    @location(3) colour: vec3f,
    @location(4) at_picture: vec2f,
}

@vertex
fn transform_coloured(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(3) colour: vec4f,
    @location(4) at_picture: vec2f,
    place: MeshPlace,
) -> ColouredVaryings {
    let out = transformed(position, normal, place);
    return ColouredVaryings(out.position_in_clip, out.position_in_eye, out.normal_in_eye, colour.rgb, at_picture);
}

@fragment
fn shade(in: Varyings) -> @location(0) vec4f {
    let at = seen(in);
    return vec4f(mesh.ambient + reflected(at, mesh.diffuse), at.distance);
}

@fragment
fn shade_coloured(in: ColouredVaryings) -> @location(0) vec4f {
    let albedo = in.colour * textured(in.at_picture);
    let at = seen(Varyings(in.position_in_clip, in.position_in_eye, in.normal_in_eye));
    return vec4f(mesh.ambient + reflected(at, mesh.diffuse * albedo), at.distance);
}

// A corner moved onto the grid of 1/256 of a pixel that rasterisers count in. Some decide by the place on the grid which pixels a triangle covers, and
// interpolate in it as it was: across triangles that are narrower than that, what is found lies far beyond what their corners have. The place in the eye's
// space moves along, so that what is interpolated stays on the ray of its pixel.
fn on_grid(corner: Varyings) -> Varyings {
    let clip = corner.position_in_clip;
    if clip.w <= 0.0 {
        return corner;
    }
    let scale = 128.0 * frame.picture;
    let place = round(clip.xy / clip.w * scale) / scale * clip.w;
    let moved = (place - clip.xy) * frame.half_extent;
    return Varyings(vec4f(place, clip.zw), corner.position_in_eye + vec3f(moved, 0.0), corner.normal_in_eye);
}

struct TranslucentVaryings {
    @builtin(position) position_in_clip: vec4f,
    @location(0) position_in_eye: vec3f,
    @location(1) normal_in_eye: vec3f,
    @location(2) radiosity: vec3f,
}

@vertex
fn transform_translucent(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) radiosity: vec4f,
    place: MeshPlace,
) -> TranslucentVaryings {
    let out = on_grid(transformed(position, normal, place));
    return TranslucentVaryings(out.position_in_clip, out.position_in_eye, out.normal_in_eye, radiosity.xyz);
}

struct ColouredTranslucentVaryings {
    @builtin(position) position_in_clip: vec4f,
    @location(0) position_in_eye: vec3f,
    @location(1) normal_in_eye: vec3f,
    @location(2) radiosity: vec3f,
    @location(3) colour: vec3f,
    @location(4) at_picture: vec2f,
}

@vertex
fn transform_coloured_translucent(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) radiosity: vec4f,
    @location(3) colour: vec4f,
    @location(4) at_picture: vec2f,
    place: MeshPlace,
) -> ColouredTranslucentVaryings {
    let out = on_grid(transformed(position, normal, place));
    return ColouredTranslucentVaryings(
        out.position_in_clip, out.position_in_eye, out.normal_in_eye, radiosity.xyz, colour.rgb, at_picture);
}

// What a translucent mesh sends to the eye.
fn sent(at: Seen, radiosity: vec3f) -> vec3f {
    // Where an interpolated normal leans away from the eye, the facet that is seen does not: without a bound, outlines of coarse meshes
    // would be dotted with black.
    let leaves = fresnel_transmittance(max(abs(dot(at.normal, at.to_eye)), 0.1), mesh.eta);
    // What rounding leaves below 0 is about a millionth of what is beside it.
    var radiance = leaves * max(radiosity, vec3f(0.0));
    if any(mesh.specular > vec3f(0.0)) {
        radiance += reflected(at, vec3f(0.0));
    }
    return radiance;
}

@fragment
fn shade_translucent(in: TranslucentVaryings) -> @location(0) vec4f {
    let at = seen(Varyings(in.position_in_clip, in.position_in_eye, in.normal_in_eye));
    return vec4f(sent(at, in.radiosity), at.distance);
}

@fragment
fn shade_coloured_translucent(in: ColouredTranslucentVaryings) -> @location(0) vec4f {
    let albedo = in.colour * textured(in.at_picture);
    let at = seen(Varyings(in.position_in_clip, in.position_in_eye, in.normal_in_eye));
    return vec4f(sent(at, in.radiosity * albedo), at.distance);
}
