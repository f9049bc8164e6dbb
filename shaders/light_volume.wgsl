// The light volume: how much of a directional light each place of a volume gets, column by column along the light.
//
// A texel holds the mean of sigma_t along the light from where it enters the volume, times the length of a slice; times the slices
// passed it is tau, and exp(-tau) of the light is left. The mean varies slowly even where tau does not, and where the medium is the same
// everywhere it is exact at whatever resolution. tau is the sum over segments of at most a voxel, sampled in their middles: second order.
//
// Meshes in the way add an optical depth behind which nothing is left.
//
// reads  volume texture, extinction table, brick distances, shadow map
// writes r32float: mean sigma_t times the length of a slice

#import classified
#import shadows

struct Columns {
    // Takes (across, across, slice), in cells from the corner of the volume, to the texture of the volume.
    texture_from_cells: mat4x4f,
    // Cells that a column moves across from slice to slice.
    slope: vec2f,
    // Cells of the volume across.
    cells: vec2f,
    // Texels: columns across, and slices.
    size: vec3u,
}

struct Segments {
    // Length of a segment, scene units.
    length: f32,
    // From slice to slice.
    count: u32,
}

// What meshes keep from the volume.
struct Shadow {
    // From the texture of the volume to the light's view: texels from the lower left, and height towards the light.
    view_from_texture: mat4x4f,
}

@group(0) @binding(4) var<uniform> columns: Columns;
@group(0) @binding(5) var light_volume: texture_storage_3d<r32float, write>;
@group(0) @binding(6) var<uniform> shadow: Shadow;
// As `gbuffer.wgsl` writes it.
@group(0) @binding(7) var shadow_map: texture_2d<f32>;
@group(0) @binding(8) var<uniform> segments: Segments;

// The optical depth of a mesh that is in the way, and how soon behind the face at which light enters it counts in full, in slices.
const OPAQUE = 16.0;
const SOONEST = 0.05;

// How high up the light is met, seen from a place; far below where it is not.
fn blocked_at(place: vec3f) -> f32 {
    let at = (shadow.view_from_texture * vec4f(place, 1.0)).xy;
    let size = vec2i(textureDimensions(shadow_map));
    let texel = vec2i(i32(floor(at.x)), size.y - 1 - i32(floor(at.y)));
    if any(texel < vec2i(0)) || any(texel >= size) {
        return -1e30;
    }
    let found = textureLoad(shadow_map, texel, 0);
    return select(-1e30, found.w, any(found.xyz != vec3f(0.0)));
}

// The same at four places that share the area of a column, since the edge of a shadow may pass between.
fn blocked(across: vec2f, slice: f32) -> vec4f {
    return vec4f(
        blocked_at(place_of(across + vec2f(-0.25, -0.25), slice)),
        blocked_at(place_of(across + vec2f(0.25, -0.25), slice)),
        blocked_at(place_of(across + vec2f(-0.25, 0.25), slice)),
        blocked_at(place_of(across + vec2f(0.25, 0.25), slice)),
    );
}

// Optical depth of the meshes between a place and the light.
fn shade(blockers: vec4f, place: vec3f) -> f32 {
    let height = (shadow.view_from_texture * vec4f(place, 1.0)).z;
    let visible = dot(vec4f(0.25), select(vec4f(0.0), vec4f(1.0), blockers <= vec4f(height)));
    return min(-log(max(visible, 1e-7)), OPAQUE);
}

fn place_of(across: vec2f, slice: f32) -> vec3f {
    return (columns.texture_from_cells * vec4f(across, slice, 1.0)).xyz;
}

// Optical depth of the stretch of a column that ends at `across` in a slice; of one that starts there, as if all of it were as there.
fn depth_before(across: vec2f, slice: f32, starts: bool) -> f32 {
    let part = 1.0 / f32(segments.count);
    var sum = 0.0;
    for (var i = 0u; i < segments.count; i += 1u) {
        let back = select(1.0 - (f32(i) + 0.5) * part, 0.0, starts);
        sum += classified_at(place_of(across - columns.slope * back, slice - back)).a;
    }
    return sum * segments.length;
}

// How far inside the volume a place is across, in slices; less than 0 outside.
fn inside(across: vec2f) -> f32 {
    let steep = max(abs(columns.slope), vec2f(1e-12));
    // From the face at which light enters.
    let passed = select(columns.cells - across, across, columns.slope > vec2f(0.0)) / steep;
    let left = select(across, columns.cells - across, columns.slope > vec2f(0.0)) / steep;
    let into = min(passed.x, passed.y);
    return select(into, min(into, min(left.x, left.y)), min(left.x, left.y) < 0.0);
}

// The remainder of whole numbers, at least 0: processors divide integers one at a time.
fn repeated(at: vec2f, width: vec2f) -> vec2f {
    let rest = at - width * floor(at / width);
    return select(select(rest, rest + width, rest < vec2f(0.0)), rest - width, rest >= width);
}

@compute @workgroup_size(64)
fn sweep(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let across = vec2i(vec2u(index % columns.size.x, index / columns.size.x));
    if index >= columns.size.x * columns.size.y {
        return;
    }
    let width = vec2i(columns.size.xy);
    var column = vec2i(-0x40000000);
    var depth = 0.0;
    var slices = 0.0;
    var was_inside = 0.0;
    var blockers = vec4f(-1e30);
    for (var slice = 0u; slice < columns.size.z; slice += 1u) {
        let first = vec2i(floor(-columns.slope * f32(slice))) - 3;
        let now = first + vec2i(repeated(vec2f(across - first), vec2f(width)));
        let at = vec2f(now) + 0.5 + columns.slope * f32(slice);
        let is_inside = inside(at);
        var mean: f32;
        let starts = any(now != column);
        // Looked up once for both: software adapters run every branch.
        let added = depth_before(at, f32(slice), starts);
        if !starts {
            depth += added;
            slices += 1.0;
            if is_inside >= 0.0 && was_inside < 0.0 {
                // It came in through a face across the slices: what it met outside does not count.
                slices = min(is_inside, 1.0);
                depth = added * slices;
            }
        } else {
            column = now;
            depth = 0.0;
            slices = 0.0;
            if SHADOWED {
                blockers = blocked(at, f32(slice));
            }
        }
        if slices > 0.0 {
            mean = depth / slices;
        } else {
            mean = added;
        }
        if SHADOWED {
            mean += shade(blockers, place_of(at, f32(slice))) / max(slices, SOONEST);
        }
        was_inside = is_inside;
        textureStore(light_volume, vec3u(vec2u(across), slice), vec4f(mean, 0.0, 0.0, 0.0));
    }
}
