// The network in which light diffuses through the cells of a volume: what each cell lets go of, and how well light passes between two.
//
// An entry point for each step. Lengths are in the unit of the network, the shortest edge of its finest cells.
//
//   sink  (sigma_a + sigma_s* e) V: absorbed, or scattered and out of the volume without being scattered again
//   link  2 D D' / (D + D') A / h: the diffusivity between two neighbours, D = 1 / (3 sigma_t (1 - albedo g))
//
// D is that of the surroundings, as far as they take half a mean free path: light that has come from far is not scattered more often for a
// thin place on its way, nor does a wisp conduct light past what it surrounds.
//
// reads  light cells, the share e of light that escapes
// writes rgba32float: sinks, and links to the next cell along each axis, for three colours

#import level

@group(0) @binding(1) var fine: texture_3d<f32>;

// --- Mean extinction of coarser cells.

@group(0) @binding(2) var mean_out: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(64)
fn average(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.coarser) {
        return;
    }
    let cell = cell_of(index, level.coarser);
    let children = children_of(cell);
    var sum = 0.0;
    for (var i = 0u; i < count_of(children.size); i += 1u) {
        sum += textureLoad(fine, child_of(children, i), 0).a;
    }
    textureStore(mean_out, cell, vec4f(0.0, 0.0, 0.0, sum / f32(count_of(children.size))));
}

// --- Extinction of the surroundings, from the coarsest level to the finest.

@group(0) @binding(2) var coarse_around: texture_3d<f32>;
@group(0) @binding(3) var around_out: texture_storage_3d<r32float, write>;

// Optical thickness of surroundings.
const SURROUNDINGS = 0.5;

@compute @workgroup_size(64)
fn surround(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let cell = cell_of(index, level.cells);
    let own = textureLoad(fine, cell, 0).a;
    let at = between_coarser(cell);
    var wider = 0.0;
    for (var corner = 0; corner < 8; corner += 1) {
        let which = vec3i(corner & 1, (corner >> 1u) & 1, corner >> 2u);
        let weight = mix(1.0 - at.part, at.part, vec3f(which));
        let there = min(at.low + which, vec3i(level.coarser) - 1);
        wider += weight.x * weight.y * weight.z * textureLoad(coarse_around, there, 0).r;
    }
    let is_enough = own * level.unit * pow(volume_of(), 1.0 / 3.0) >= SURROUNDINGS || level.is_top == 1u;
    textureStore(around_out, cell, vec4f(select(wider, own, is_enough), 0.0, 0.0, 0.0));
}

// --- Sinks and links of the finest level.

struct Diffusion {
    // Mean cosine of scattering.
    g: f32,
    // Share of scattered light that leaves its way.
    aside: f32,
    // Diffusivity, as a multiple of that of light.
    spread: f32,
}

@group(0) @binding(2) var around: texture_3d<f32>;
// What escapes, in which direction, and how much.
@group(0) @binding(3) var<storage, read> escape: array<vec4f>;
@group(0) @binding(4) var sink_out: texture_storage_3d<rgba32float, write>;
@group(0) @binding(5) var x_out: texture_storage_3d<rgba32float, write>;
@group(0) @binding(6) var y_out: texture_storage_3d<rgba32float, write>;
@group(0) @binding(7) var z_out: texture_storage_3d<rgba32float, write>;
@group(0) @binding(8) var<uniform> diffusion: Diffusion;

// Least optical thickness of a cell that is told from a thinner one, and least diffusivity: that of what is empty, which takes on what is beside it.
const THINNEST = 1e-4;
const LEAST_DIFFUSIVITY = 1e-12;

fn diffusivity(cell: vec3u) -> vec3f {
    let medium = textureLoad(fine, cell, 0);
    let own = medium.a * level.unit;
    let surroundings = max(textureLoad(around, cell, 0).r * level.unit, THINNEST);
    let part = min(own / surroundings, 1.0);
    let free = 1.0 / (3.0 * max(own, surroundings) * (1.0 - medium.rgb * diffusion.g));
    return max(diffusion.spread * part * part * free, vec3f(LEAST_DIFFUSIVITY));
}

fn link(own: vec3f, cell: vec3u, axis: u32) -> vec4f {
    var next = cell;
    next[axis] += 1u;
    let is_last = next[axis] >= level.cells[axis];
    let other = diffusivity(min(next, level.cells - 1u));
    let between = 2.0 * own * other / (own + other) * (volume_of() / (level.edges[axis] * level.edges[axis]));
    return vec4f(select(between, vec3f(0.0), is_last), 0.0);
}

@compute @workgroup_size(64)
fn connect(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let cell = cell_of(index, level.cells);
    let medium = textureLoad(fine, cell, 0);
    let out = (1.0 - medium.rgb) + medium.rgb * (diffusion.aside * min(escape[index].w, 1.0));
    textureStore(sink_out, cell, vec4f(medium.a * level.unit * volume_of() * out, 0.0));
    let own = diffusivity(cell);
    textureStore(x_out, cell, link(own, cell, 0u));
    textureStore(y_out, cell, link(own, cell, 1u));
    textureStore(z_out, cell, link(own, cell, 2u));
}

// --- Sinks and links of a coarser level.

@group(0) @binding(1) var sinks: texture_3d<f32>;
@group(0) @binding(2) var x_links: texture_3d<f32>;
@group(0) @binding(3) var y_links: texture_3d<f32>;
@group(0) @binding(8) var z_links: texture_3d<f32>;

@compute @workgroup_size(64)
fn coarsen(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.coarser) {
        return;
    }
    let cell = cell_of(index, level.coarser);
    let children = children_of(cell);
    var sink = vec3f(0.0);
    var x_link = vec3f(0.0);
    var y_link = vec3f(0.0);
    var z_link = vec3f(0.0);
    for (var i = 0u; i < count_of(children.size); i += 1u) {
        let child = child_of(children, i);
        let is_last = child + 1u == children.first + children.size;
        sink += textureLoad(sinks, child, 0).rgb;
        // Only what leads out of the coarser cell.
        x_link += select(vec3f(0.0), textureLoad(x_links, child, 0).rgb, is_last.x);
        y_link += select(vec3f(0.0), textureLoad(y_links, child, 0).rgb, is_last.y);
        z_link += select(vec3f(0.0), textureLoad(z_links, child, 0).rgb, is_last.z);
    }
    // The middles of coarser cells are farther apart.
    let farther = vec3f(level.factor);
    textureStore(sink_out, cell, vec4f(sink, 0.0));
    textureStore(x_out, cell, vec4f(x_link / farther.x, 0.0));
    textureStore(y_out, cell, vec4f(y_link / farther.y, 0.0));
    textureStore(z_out, cell, vec4f(z_link / farther.z, 0.0));
}
