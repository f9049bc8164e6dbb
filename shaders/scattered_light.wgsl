// Light that was scattered before, by a sweep along an axis and back: two streams in each column of cells, exact but for two directions
// standing for all, and light that spreads across the axis from slice to slice.
//
// reads  light cells, the light volume, the shadow of meshes
// writes fluence and flux, summed over the axes, of a light of irradiance 1

#import cells
#import two_stream
#import light_volumes
#import shadows

// For each cell: what comes down to it, 1 less the reflectance of all before it, what it sends back of the light itself.
@group(0) @binding(4) var<storage, read_write> stacks: array<vec4f>;
// For each cell: fluence, and flux along the axes of the volume.
@group(0) @binding(5) var<storage, read_write> scattered: array<vec4f>;

// T' over the width of a cell.
fn beam_at(across: vec2u, along: u32, beam: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        let at = vec2f(across) + 0.25 + 0.5 * vec2f(f32(i & 1u), f32(i >> 1u));
        let place = place_of(at, f32(along));
        sum += 0.25 * light_seen(0u, place) * exp(-light_depth(0u, place) * beam);
    }
    return sum;
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
    if here > 0u {
        let before = (here - 1u) & 1u;
        stack = TwoStreamStack(faces[2u * (before * columns + index) + 1u].rgb, spread_out(across, before));
    }
    let beam = two_stream_beam(cell.rgb, sweep_of.g);
    let first = beam_at(across, here, beam);
    let second = beam_at(across, here + 1u, beam);
    let layer = two_stream_layer(cell.a * sweep_of.along, cell.rgb, sweep_of.g, sweep_of.mu0, first, second);
    let after = two_stream_add(stack, layer);
    let at = 3u * (here * columns + index);
    stacks[at] = vec4f(stack.down, 0.0);
    stacks[at + 1u] = vec4f(stack.kept, 0.0);
    stacks[at + 2u] = vec4f(layer.s_backward, 0.0);
    let face = 2u * ((here & 1u) * columns + index);
    faces[face] = vec4f(after.down, spread_in(cell));
    faces[face + 1u] = vec4f(after.kept, 0.0);
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
    let near = two_stream_resolve(TwoStreamStack(stacks[at + 1u].rgb, stacks[at].rgb), layer, far.backward);
    let face = 2u * (((here + 1u) & 1u) * columns + index);
    faces[face] = vec4f(near.backward, spread_in(cell));
    faces[face + 1u] = vec4f(near.forward, 0.0);

    let fluence = 0.5 * (near.forward + near.backward + far.forward + far.backward) / TWO_STREAM_MU1;
    let flux = 0.5 * (near.forward - near.backward + far.forward - far.backward);
    let along = select(-1.0, 1.0, sweep_of.forwards == 1u) * dot(flux, vec3f(1.0 / 3.0));
    let place = cell_of(across, here);
    let out = 2u * ((place.z * sweep_of.cells.y + place.y) * sweep_of.cells.x + place.x);
    scattered[out] += vec4f(sweep_of.weight * fluence, 0.0);
    scattered[out + 1u] += vec4f(sweep_of.flux_weight * along * unrolled(vec3f(0.0, 0.0, 1.0)), 0.0);
}
