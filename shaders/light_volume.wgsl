// The light volume: how much of a directional light each place of a volume gets, column by column along the light.
//
// A texel holds the mean of sigma_t along the light from where it enters the volume, times the length of a slice; times the slices
// passed it is tau, and exp(-tau) of the light is left. The mean varies slowly even where tau does not, and where the medium is the same
// everywhere it is exact at whatever resolution. tau is the sum over segments of at most a voxel along which the value changes evenly,
// by the integral of the transfer function: exact for whatever function, of second order for a field that is not linear.
//
// Meshes in the way add an optical depth behind which nothing is left.
//
// reads  volume texture, extinction table, brick distances, shadow map
// writes r32float: mean sigma_t times the length of a slice

#import classified

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
    is_there: u32,
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

// The transfer function up to a place in the table: `Cumulative` in `src/optics/transfer.rs`.
struct Passed {
    // Less than 0 where a sample is missing.
    entry: f32,
    depth: vec2f,
    layers: f32,
    sigma_t: f32,
}

fn passed_at(place: vec3f) -> Passed {
    let at = entry_at(place);
    let below = clamp(floor(at), 0.0, classified.last - 1.0);
    let entry = vec2u(u32(below), 0u);
    let low = textureLoad(table, entry, 0);
    let high = textureLoad(table, entry + vec2u(1u, 0u), 0);
    let part = max(at - below, 0.0);
    let rise = high.w - low.w;
    let more = part * (low.w + 0.5 * part * rise);
    return Passed(at, vec2f(low.x, low.y + more), mix(low.z, high.z, part), low.w + part * rise);
}

// Optical depth of a segment between two places.
fn depth_between(front: Passed, back: Passed) -> f32 {
    if front.entry < 0.0 || back.entry < 0.0 {
        return 0.0;
    }
    let across = back.entry - front.entry;
    let integral = (back.depth.x - front.depth.x) + (back.depth.y - front.depth.y);
    // Next to each other the integral has no digits left, and the function no room to bend.
    let even = 0.5 * (front.sigma_t + back.sigma_t);
    let mean = select(integral / select(across, 1.0, across == 0.0), even, abs(across) < 0.01);
    return segments.length * max(mean, 0.0) + abs(back.layers - front.layers);
}

// Optical depth of the stretch of a column that ends at `across` in a slice. Where bricks hold nothing nothing is looked up.
fn depth_before(across: vec2f, slice: f32) -> f32 {
    let part = 1.0 / f32(segments.count);
    var sum = 0.0;
    var from_place = place_of(across - columns.slope, slice - 1.0);
    var from_nothing = holds_nothing(clamp(from_place, vec3f(0.0), vec3f(1.0)));
    var is_known = false;
    var front: Passed;
    for (var i = 0u; i < segments.count; i += 1u) {
        let back_by = 1.0 - f32(i + 1u) * part;
        let to_place = place_of(across - columns.slope * back_by, slice - back_by);
        let to_nothing = holds_nothing(clamp(to_place, vec3f(0.0), vec3f(1.0)));
        if from_nothing && to_nothing {
            is_known = false;
        } else {
            if !is_known {
                front = passed_at(from_place);
            }
            let end = passed_at(to_place);
            sum += depth_between(front, end);
            front = end;
            is_known = true;
        }
        from_place = to_place;
        from_nothing = to_nothing;
    }
    return sum;
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
        let now = first + (((across - first) % width) + width) % width;
        let at = vec2f(now) + 0.5 + columns.slope * f32(slice);
        let is_inside = inside(at);
        var mean: f32;
        if all(now == column) {
            let added = depth_before(at, f32(slice));
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
            if shadow.is_there != 0u {
                blockers = blocked(at, f32(slice));
            }
        }
        if slices > 0.0 {
            mean = depth / slices;
        } else {
            mean = passed_at(place_of(at, f32(slice))).sigma_t * segments.length * f32(segments.count);
        }
        if shadow.is_there != 0u {
            mean += shade(blockers, place_of(at, f32(slice))) / max(slices, SOONEST);
        }
        was_inside = is_inside;
        textureStore(light_volume, vec3u(vec2u(across), slice), vec4f(mean, 0.0, 0.0, 0.0));
    }
}
