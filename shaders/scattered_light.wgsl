// Light that was scattered before, by a sweep along an axis and back: two streams in each column of cells, exact but for two directions
// standing for all, and light that spreads across the axis from slice to slice.
//
// reads  light cells, the light volume, the shadow of meshes
// writes fluence and flux, summed over the axes, of a light of irradiance 1

#import cells
#import two_stream
#import light_volumes
#import shadows

// For each cell: what comes down to it; 1 less the reflectance of all before it, and that of all behind; what it sends back of the light
// itself.
@group(0) @binding(4) var<storage, read_write> stacks: array<vec4f>;
// For each cell: fluence, and what the first axis counts; flux along the axes of the volume, and what the second counts.
@group(0) @binding(5) var<storage, read_write> scattered: array<vec4f>;

// Optical depths are told apart up to this, and in a cell from this on.
const DEEPEST = 1e9;
const LEAST_RISE = 0.1;

// The weight of an axis from which on its flux counts by half: the axes share the fluence, but each has all of the flux along it.
const HALF_FLUX = 0.02;

// The share of the light that arrives at a face, over the width of a cell.
fn light_at(across: vec2u, along: u32) -> f32 {
    var sum = 0.0;
    for (var i = 0u; i < 4u; i += 1u) {
        let at = vec2f(across) + 0.25 + 0.5 * vec2f(f32(i & 1u), f32(i >> 1u));
        let place = place_of(at, f32(along));
        sum += 0.25 * light_seen(0u, place) * exp(-light_depth(0u, place));
    }
    return sum;
}

// T' of it.
fn beam_of(light: f32, beam: vec3f) -> vec3f {
    return select(vec3f(0.0), exp(log(max(light, 1e-37)) * beam), light > 0.0);
}

// How much each axis counts in a cell: the more the light leans to it, and the faster it fades along it. Along a surface that it does not
// enter through light would be shut in, as nothing leaves a sweep aside but what spreads.
fn weights_in(across: vec2u, along: u32) -> vec3f {
    let place = place_of(vec2f(across) + 0.5, f32(along) + 0.5);
    var weights = vec3f(0.0);
    for (var axis = 0u; axis < 3u; axis += 1u) {
        var half = vec3f(0.0);
        half[axis] = 0.5 / f32(sweep_of.cells[axis]);
        let rise = min(light_depth(0u, place + half), DEEPEST) - min(light_depth(0u, place - half), DEEPEST);
        weights[axis] = sweep_of.shares[axis] * (rise * rise + LEAST_RISE * LEAST_RISE);
    }
    return weights / (weights.x + weights.y + weights.z);
}

// Where a cell's results begin.
fn result_of(across: vec2u, along: u32) -> u32 {
    let place = cell_of(across, along);
    return 2u * ((place.z * sweep_of.cells.y + place.y) * sweep_of.cells.x + place.x);
}

// Where in 0..1 between the ends of a cell of the optical depth `tau` the mean is of what is seen of it from one end.
fn seen_depth(tau: f32) -> f32 {
    let thick = clamp(tau, 0.1, 80.0);
    return select(1.0 / max(tau, 0.1) - 1.0 / (exp(thick) - 1.0), 0.5 - tau / 12.0, tau < 0.2);
}

// The mean over the thickness of a cell as it is seen from where there is less.
fn seen_mean(a: vec3f, b: vec3f, tau: f32) -> vec3f {
    return mix(min(a, b), max(a, b), seen_depth(tau));
}

// Both streams at a face behind a slice, of a cell that has something behind.
fn both_at(across: vec2i, face: u32) -> vec4f {
    let n = vec2i(extent().xy);
    let index = 2u * (face * u32(n.x * n.y) + u32(across.y * n.x + across.x));
    return faces[index] + vec4f(faces[index + 1u].rgb, 0.0);
}

// The share of the light in a cell that is seen of it from aside. On its sides there is what diffuses there from both, and on those of the
// volume what Marshak's condition leaves.
fn seen_beside(across: vec2u, cell: vec4f, face: u32) -> vec3f {
    let n = vec2i(extent().xy);
    let own = both_at(vec2i(across), face);
    let turned = cell.a * (1.0 - dot(cell.rgb, vec3f(1.0 / 3.0)) * sweep_of.g);
    var share = vec3f(1.0);
    for (var side = 0; side < 4; side += 1) {
        let is_first = side < 2;
        let there = vec2i(across) + select(vec2i(0, 1), vec2i(1, 0), is_first) * (2 * (side & 1) - 1);
        let length = select(sweep_of.across.y, sweep_of.across.x, is_first);
        var edge = vec3f(1.0 / (1.0 + 0.75 * turned * length));
        if all(there >= vec2i(0)) && all(there < n) {
            let other = both_at(there, face);
            let most = max(own.rgb, vec3f(1e-30));
            edge = mix(min(other.rgb, most) / most, vec3f(1.0), own.a / max(own.a + other.a, 1e-30));
        }
        share *= mix(edge, vec3f(1.0), 2.0 * seen_depth(cell.a * length));
    }
    return share;
}

// How often light goes through a slice that lies between what turns round `above` and `below` of it: as often it spreads.
fn crossings(above: vec3f, below: f32) -> f32 {
    return 1.0 / max(1.0 - dot(above, vec3f(1.0 / 3.0)) * below, 0.02);
}

// Before anything else, from the far end: what all behind each slice turns round.
@compute @workgroup_size(64)
fn look_ahead(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = extent();
    let columns = n.x * n.y;
    if index >= columns {
        return;
    }
    let here = slice.index;
    let across = vec2u(index % n.x, index / n.x);
    // The first axis finds what each of them counts. (A loop of one turn: software adapters run both sides of every `if`.)
    var finds = sweep_of.is_first == 1u;
    while finds {
        let weights = weights_in(across, here);
        let out = result_of(across, here);
        scattered[out] = vec4f(0.0, 0.0, 0.0, weights.x);
        scattered[out + 1u] = vec4f(0.0, 0.0, 0.0, weights.y);
        finds = false;
    }
    let cell = textureLoad(light_cells, cell_of(across, here), 0);
    var behind = vec3f(1.0);
    if here < n.z - 1u {
        behind = faces[2u * ((here & 1u) * columns + index)].rgb;
    }
    stacks[3u * (here * columns + index) + 1u] = vec4f(vec3f(0.0), 1.0 - dot(behind, vec3f(1.0 / 3.0)));
    let layer = two_stream_layer(cell.a * sweep_of.along, cell.rgb, sweep_of.g, sweep_of.mu0, vec3f(0.0), vec3f(0.0));
    let after = two_stream_add(TwoStreamStack(behind, vec3f(0.0)), layer);
    faces[2u * (((here + 1u) & 1u) * columns + index)] = vec4f(after.kept, 0.0);
}

@compute @workgroup_size(64)
fn forward(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = extent();
    let columns = n.x * n.y;
    if index >= columns {
        return;
    }
    let across = vec2u(index % n.x, index / n.x);
    let here = slice.index;
    let cell = textureLoad(light_cells, cell_of(across, here), 0);
    var stack = TwoStreamStack(vec3f(1.0), vec3f(0.0));
    var arriving: f32;
    if here > 0u {
        let before = (here - 1u) & 1u;
        let known = faces[2u * (before * columns + index) + 1u];
        stack = TwoStreamStack(known.rgb, spread_out(across, before));
        arriving = known.a;
    }
    var is_first = here == 0u;
    while is_first {
        arriving = light_at(across, 0u);
        is_first = false;
    }
    let leaving = light_at(across, here + 1u);
    let beam = two_stream_beam(cell.rgb, sweep_of.g);
    let first = beam_of(arriving, beam);
    let second = beam_of(leaving, beam);
    let layer = two_stream_layer(cell.a * sweep_of.along, cell.rgb, sweep_of.g, sweep_of.mu0, first, second);
    let after = two_stream_add(stack, layer);
    let at = 3u * (here * columns + index);
    stacks[at] = vec4f(stack.down, 0.0);
    let below = stacks[at + 1u].a;
    stacks[at + 1u] = vec4f(stack.kept, below);
    stacks[at + 2u] = vec4f(layer.s_backward, 0.0);
    let face = 2u * ((here & 1u) * columns + index);
    faces[face] = vec4f(after.down, spread_in(cell) * crossings(1.0 - after.kept, below));
    faces[face + 1u] = vec4f(after.kept, leaving);
}

@compute @workgroup_size(64)
fn back(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = extent();
    let columns = n.x * n.y;
    if index >= columns {
        return;
    }
    let across = vec2u(index % n.x, index / n.x);
    let here = slice.index;
    let cell = textureLoad(light_cells, cell_of(across, here), 0);
    let behind = here & 1u;
    // Behind the last slice is what the sweep forward left there, and nothing comes back.
    let is_last = here == n.z - 1u;
    let found = faces[2u * (behind * columns + index)].rgb;
    var far: TwoStreams;
    if is_last {
        far = TwoStreams(found, vec3f(0.0));
    } else {
        far = TwoStreams(faces[2u * (behind * columns + index) + 1u].rgb, spread_out(across, behind));
    }
    var layer = two_stream_layer(cell.a * sweep_of.along, cell.rgb, sweep_of.g, sweep_of.mu0, vec3f(0.0), vec3f(0.0));
    let at = 3u * (here * columns + index);
    layer.s_backward = stacks[at + 2u].rgb;
    let kept = stacks[at + 1u];
    let near = two_stream_resolve(TwoStreamStack(kept.rgb, stacks[at].rgb), layer, far.backward);
    let face = 2u * (((here + 1u) & 1u) * columns + index);
    faces[face] = vec4f(near.backward, spread_in(cell) * crossings(1.0 - kept.rgb, kept.a));
    faces[face + 1u] = vec4f(near.forward, 0.0);

    var fluence = seen_mean(near.forward + near.backward, far.forward + far.backward, cell.a * sweep_of.along) / TWO_STREAM_MU1;
    if !is_last {
        fluence *= seen_beside(across, cell, behind);
    }
    let flux = 0.5 * (near.forward - near.backward + far.forward - far.backward);
    let along = select(-1.0, 1.0, sweep_of.forwards == 1u) * dot(flux, vec3f(1.0 / 3.0));
    let out = result_of(across, here);
    let weights = vec2f(scattered[out].a, scattered[out + 1u].a);
    let weight = vec3f(weights, 1.0 - weights.x - weights.y)[sweep_of.axis];
    scattered[out] += vec4f(weight * fluence, 0.0);
    scattered[out + 1u] += vec4f(weight / (weight + HALF_FLUX) * along * unrolled(vec3f(0.0, 0.0, 1.0)), 0.0);
}
