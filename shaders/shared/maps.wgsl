// The maps of the scattering cameras around a body: which of them see a point, and what they hold for it.

struct MapCamera {
    view_from_mesh: mat4x4f,
    view_from_mesh_normal: mat4x4f,
    // Lower corner of the view, and the inverse size of its texels.
    low: vec2f,
    inverse_texel: f32,
}

struct Maps {
    cameras: u32,
    points: u32,
    // How far behind what a map shows a point may lie and still be seen; below 0 it follows from the texels.
    bias: f32,
    // Whether one camera decides for each point, the one that sees it best, or all that see it together.
    best_only: u32,
}

struct Point {
    position: vec3f,
    normal: vec3f,
}

fn point_at(index: u32) -> Point {
    let at = 6u * index;
    return Point(
        vec3f(vertices[at], vertices[at + 1u], vertices[at + 2u]),
        vec3f(vertices[at + 3u], vertices[at + 4u], vertices[at + 5u]),
    );
}

// A point in a camera's view.
struct Seen {
    // Texels from the lower left corner.
    place: vec2f,
    // Towards the camera, and what it changes by from texel to texel.
    height: f32,
    slope: vec2f,
    // How far a texel may lie off the point's tangent plane and still show the same surface.
    bias: f32,
    // Its z is the cosine between the normal and the direction to the camera.
    normal: vec3f,
}

fn seen_by(camera: MapCamera, point: Point) -> Seen {
    let position = (camera.view_from_mesh * vec4f(point.position, 1.0)).xyz;
    let normal = normalize((camera.view_from_mesh_normal * vec4f(point.normal, 0.0)).xyz);
    let slope = -normal.xy / max(normal.z, 0.2) / camera.inverse_texel;
    // A tangent plane is off by what the surface curves within a texel, the more the more it leans.
    let automatic = (1.0 + 2.0 * length(slope) * camera.inverse_texel) / camera.inverse_texel;
    let bias = select(maps.bias, automatic, maps.bias < 0.0);
    return Seen((position.xy - camera.low) * camera.inverse_texel, position.z, slope, bias, normal);
}

// The height that a texel shows above the point's tangent plane; huge where it shows nothing, or a surface that faces elsewhere, as
// beyond an edge or on another side of something thin.
fn above(seen: Seen, layer: u32, texel: vec2i) -> f32 {
    let size = vec2i(textureDimensions(map_gbuffer));
    if any(texel < vec2i(0)) || any(texel >= size) {
        return 1e9;
    }
    let shown = textureLoad(map_gbuffer, vec2i(texel.x, size.y - 1 - texel.y), layer, 0);
    let plane = seen.height + dot(seen.slope, vec2f(texel) + 0.5 - seen.place);
    return select(1e9, shown.w - plane, dot(shown.xyz, seen.normal) > 0.5 * length(shown.xyz));
}

// How well a camera sees a point: the share of the nine texels around it that show its surface (percentage-closer filtering; Reeves,
// Salesin, Cook 1987), times the square of the cosine, so that cameras in front count for more. Where the nearest texels show something
// else, it does not see the point.
fn visibility(seen: Seen, layer: u32) -> f32 {
    if seen.normal.z <= 0.05 {
        return 0.0;
    }
    let middle = vec2i(floor(seen.place));
    var count = 0.0;
    for (var i = 0; i < 9; i += 1) {
        let offset = vec2i(i % 3 - 1, i / 3 - 1);
        count += select(0.0, 1.0, abs(above(seen, layer, middle + offset)) <= seen.bias);
    }
    return count / 9.0 * seen.normal.z * seen.normal.z * select(0.0, 1.0, abs(above(seen, layer, middle)) <= seen.bias);
}
