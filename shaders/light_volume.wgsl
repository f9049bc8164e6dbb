// The light volume: how much of a directional light each place of a volume gets, column by column along the light.
//
// A texel holds the mean of sigma_t along the light from where it enters the volume, times the length of a slice; times the slices
// passed it is tau, and exp(-tau) of the light is left. The mean varies slowly even where tau does not, and where the medium is the same
// everywhere it is exact at whatever resolution. tau is the sum over segments of at most a voxel along which the value changes evenly,
// by the integral of the transfer function: exact for whatever function, and of second order in the voxel for a field that is not linear.
//
// reads  volume texture, the integral of the extinction, brick distances
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

@group(0) @binding(4) var<uniform> columns: Columns;
@group(0) @binding(5) var light_volume: texture_storage_3d<r32float, write>;
@group(0) @binding(6) var<uniform> segments: Segments;

// The transfer function up to a place in the table: `Cumulative` in `src/optics/transfer.rs`.
struct Passed {
    entry: f32,
    depth: vec2f,
    layers: f32,
    sigma_t: f32,
    // How much of the medium is there.
    shown: f32,
}

fn passed_at(place: vec3f) -> Passed {
    let voxel = voxel_in(place);
    return passed_to(entry_of(voxel), voxel.shown);
}

fn passed_to(at: f32, shown: f32) -> Passed {
    let below = clamp(floor(at), 0.0, classified.last - 1.0);
    let low = entry(u32(below));
    let high = entry(u32(below) + 1u);
    let part = at - below;
    let rise = high.w - low.w;
    let more = part * (low.w + 0.5 * part * rise);
    return Passed(at, vec2f(low.x, low.y + more), mix(low.z, high.z, part), low.w + part * rise, shown);
}

// Optical depth of a segment between two places.
fn depth_between(one: Passed, other: Passed) -> f32 {
    var front = one;
    var back = other;
    if ANY_PARTIAL {
        // What is missing has no value: then the other's goes on.
        if front.shown == 0.0 {
            front = back;
            front.shown = 0.0;
        }
        if back.shown == 0.0 {
            back = front;
            back.shown = 0.0;
        }
    }
    let across = back.entry - front.entry;
    let integral = (back.depth.x - front.depth.x) + (back.depth.y - front.depth.y);
    // Next to each other the integral has no digits left, and the function no room to bend.
    let even = 0.5 * (front.sigma_t + back.sigma_t);
    let mean = select(integral / select(across, 1.0, across == 0.0), even, abs(across) < 0.01);
    let shown = 0.5 * (front.shown + back.shown);
    return shown * (segments.length * max(mean, 0.0) + abs(back.layers - front.layers));
}

// A column on its way.
struct March {
    // Texture of the volume where the column would cross slice 0, and from slice to slice.
    start: vec3f,
    step: vec3f,
    // Optical depth since it came in, and over how many slices.
    depth: f32,
    slices: f32,
    // The slice at which it has come in through a face across the slices, and how much of the way to it was inside.
    entry: f32,
    part: f32,
}

// What `added` more on the way to a slice makes of a column, and its texel.
fn reach_slice(march: ptr<function, March>, added: f32, slice: f32, texel: vec2u) {
    let comes_in = slice == (*march).entry;
    // What it met outside does not count.
    (*march).depth = select((*march).depth + added, added * (*march).part, comes_in);
    (*march).slices = select((*march).slices + 1.0, (*march).part, comes_in);
    let mean = (*march).depth / (*march).slices;
    textureStore(light_volume, vec3u(texel, u32(slice)), vec4f(mean, 0.0, 0.0, 0.0));
}

// Slices between two looks at the bricks.
const RUN = 16.0;

// Slices from a place on in which there is nothing for certain.
fn empty_slices(place: vec3f, step: vec3f) -> f32 {
    let pace = abs(step) * classified.size / BRICK;
    return floor(max(brick_distance(place) - 1.0, 0.0) / max(pace.x, max(pace.y, pace.z)));
}

// The slices from `first` to `end` of a column.
fn follow(march: ptr<function, March>, first: f32, end: f32, texel: vec2u) {
    let start = (*march).start;
    let step = (*march).step;
    let part = step / f32(segments.count);
    var slice = first;
    while slice < end {
        let leap = min(slice + empty_slices(start + step * slice, step), end);
        while slice < leap {
            slice += 1.0;
            reach_slice(march, 0.0, slice, texel);
        }
        let turn = min(slice + RUN, end);
        var front = passed_at(start + step * slice);
        while slice < turn {
            var added = 0.0;
            for (var i = 1u; i <= segments.count; i += 1u) {
                if ANY_NEAREST {
                    // Nothing lies between the values of two voxels.
                    let within = passed_at(start + step * slice + part * (f32(i) - 0.5));
                    added += segments.length * within.shown * within.sigma_t;
                    continue;
                }
                let back = passed_at(start + step * slice + part * f32(i));
                added += depth_between(front, back);
                front = back;
            }
            slice += 1.0;
            reach_slice(march, added, slice, texel);
        }
    }
}

@compute @workgroup_size(64)
fn sweep(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let texel = vec2u(index % columns.size.x, index / columns.size.x);
    if index >= columns.size.x * columns.size.y {
        return;
    }
    let width = vec2f(columns.size.xy);
    let slope = columns.slope;
    let last = f32(columns.size.z - 1u);
    let steep = select(slope, vec2f(1e-12), abs(slope) < vec2f(1e-12));
    var march: March;
    march.step = (columns.texture_from_cells * vec4f(slope, 1.0, 0.0)).xyz;
    var slice = 0.0;
    while slice <= last {
        // The column that crosses this slice here. Of each slice's columns the first is the third before the volume.
        let first = floor(-slope * slice) - 3.0;
        let column = vec2f(texel) - width * floor((vec2f(texel) - first + 0.5) / width);
        // It does until it is no more one of them.
        let stays = select((column + 4.0 - width) / -steep, (column + 4.0) / -steep, slope < vec2f(0.0));
        let end = clamp(ceil(min(stays.x, stays.y)) - 1.0, slice, last);
        let across = column + 0.5;
        let enters = select(-across, columns.cells - across, slope < vec2f(0.0)) / steep;
        let entry = max(enters.x, enters.y);
        march.start = (columns.texture_from_cells * vec4f(across, 0.0, 1.0)).xyz;
        march.depth = 0.0;
        march.slices = 0.0;
        march.entry = select(-1.0, ceil(entry), entry > slice);
        march.part = max(ceil(entry) - entry, 1e-6);
        // Where nothing is passed yet the mean is what is here.
        let place = march.start + march.step * slice;
        let here = passed_at(place);
        let mean = here.shown * here.sigma_t * segments.length * f32(segments.count);
        textureStore(light_volume, vec3u(texel, u32(slice)), vec4f(mean, 0.0, 0.0, 0.0));
        follow(&march, slice, end, texel);
        slice = end + 1.0;
    }
}
