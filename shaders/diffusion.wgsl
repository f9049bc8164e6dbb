// Light that diffuses through a network of cells: -div D grad phi + sink phi = power, by multigrid.
//
// From the coarsest level down: what is found there, interpolated, is where the next one starts; each then takes one V-cycle (Brandt 1977,
// "Multi-level adaptive solutions to boundary-value problems"). What a coarser level corrects is the same for all cells of one of its own,
// so that what cells exchange stays with them: all power ends in sinks.
//
// reads  sinks, links and power of a level
// writes rgba32float: fluence, and what is left of the power of cells that a coarser level sees as one

#import level

@group(0) @binding(1) var sinks: texture_3d<f32>;
@group(0) @binding(2) var x_links: texture_3d<f32>;
@group(0) @binding(3) var y_links: texture_3d<f32>;
@group(0) @binding(4) var z_links: texture_3d<f32>;
@group(0) @binding(5) var power: texture_3d<f32>;
@group(0) @binding(6) var fluence: texture_3d<f32>;
@group(0) @binding(7) var out: texture_storage_3d<rgba32float, write>;

// How far a step goes on the way to where a cell would be in balance with its neighbours.
const DAMPING = 0.8;

// Power that a cell has too much, and what it gives away per fluence.
struct Balance {
    surplus: vec3f,
    gives: vec3f,
}

fn exchange(own: vec3f, links: texture_3d<f32>, cell: vec3u, axis: u32, balance: ptr<function, Balance>) {
    var next = cell;
    next[axis] = min(cell[axis] + 1u, level.cells[axis] - 1u);
    var before = cell;
    before[axis] = max(cell[axis], 1u) - 1u;
    let ahead = textureLoad(links, cell, 0).rgb;
    let behind = select(vec3f(0.0), textureLoad(links, before, 0).rgb, cell[axis] > 0u);
    (*balance).surplus += ahead * (textureLoad(fluence, next, 0).rgb - own);
    (*balance).surplus += behind * (textureLoad(fluence, before, 0).rgb - own);
    (*balance).gives += ahead + behind;
}

fn balance_of(cell: vec3u, own: vec3f) -> Balance {
    let sink = textureLoad(sinks, cell, 0).rgb;
    var balance = Balance(textureLoad(power, cell, 0).rgb - sink * own, sink);
    exchange(own, x_links, cell, 0u, &balance);
    exchange(own, y_links, cell, 1u, &balance);
    exchange(own, z_links, cell, 2u, &balance);
    return balance;
}

// The first step, from nothing.
@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let cell = cell_of(index, level.cells);
    var gives = textureLoad(sinks, cell, 0).rgb;
    gives += textureLoad(x_links, cell, 0).rgb + textureLoad(y_links, cell, 0).rgb + textureLoad(z_links, cell, 0).rgb;
    // The last cells of an axis have no link, and so have those before the first.
    let x = vec3u(max(cell.x, 1u) - 1u, cell.yz);
    let y = vec3u(cell.x, max(cell.y, 1u) - 1u, cell.z);
    let z = vec3u(cell.xy, max(cell.z, 1u) - 1u);
    gives += select(vec3f(0.0), textureLoad(x_links, x, 0).rgb, cell.x > 0u);
    gives += select(vec3f(0.0), textureLoad(y_links, y, 0).rgb, cell.y > 0u);
    gives += select(vec3f(0.0), textureLoad(z_links, z, 0).rgb, cell.z > 0u);
    let step = select(DAMPING, 1.0, count_of(level.cells) == 1u);
    textureStore(out, cell, vec4f(step * textureLoad(power, cell, 0).rgb / max(gives, vec3f(1e-30)), 0.0));
}

// A step towards balance.
@compute @workgroup_size(64)
fn relax(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let cell = cell_of(index, level.cells);
    let own = textureLoad(fluence, cell, 0).rgb;
    let balance = balance_of(cell, own);
    textureStore(out, cell, vec4f(own + DAMPING * balance.surplus / max(balance.gives, vec3f(1e-30)), 0.0));
}

// What is left of the power of the cells in one of the coarser level.
@compute @workgroup_size(64)
fn gather_surplus(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.coarser) {
        return;
    }
    let cell = cell_of(index, level.coarser);
    let children = children_of(cell);
    var sum = vec3f(0.0);
    for (var i = 0u; i < count_of(children.size); i += 1u) {
        let child = child_of(children, i);
        sum += balance_of(child, textureLoad(fluence, child, 0).rgb).surplus;
    }
    textureStore(out, cell, vec4f(sum, 0.0));
}

// All of it.
@compute @workgroup_size(64)
fn gather_power(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.coarser) {
        return;
    }
    let cell = cell_of(index, level.coarser);
    let children = children_of(cell);
    var sum = vec3f(0.0);
    for (var i = 0u; i < count_of(children.size); i += 1u) {
        sum += textureLoad(power, child_of(children, i), 0).rgb;
    }
    textureStore(out, cell, vec4f(sum, 0.0));
}

// From the coarser level.
@group(0) @binding(5) var coarse: texture_3d<f32>;

// Where a level starts: between what is known of the coarser one.
@compute @workgroup_size(64)
fn interpolate(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let cell = cell_of(index, level.cells);
    let at = between_coarser(cell);
    var sum = vec3f(0.0);
    for (var corner = 0; corner < 8; corner += 1) {
        let which = vec3i(corner & 1, (corner >> 1u) & 1, corner >> 2u);
        let weight = mix(1.0 - at.part, at.part, vec3f(which));
        let there = min(at.low + which, vec3i(level.coarser) - 1);
        sum += weight.x * weight.y * weight.z * textureLoad(coarse, there, 0).rgb;
    }
    textureStore(out, cell, vec4f(sum, 0.0));
}

// What the coarser level corrects.
@compute @workgroup_size(64)
fn correct(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let cell = cell_of(index, level.cells);
    let more = textureLoad(coarse, cell / level.factor, 0).rgb;
    textureStore(out, cell, vec4f(textureLoad(fluence, cell, 0).rgb + more, 0.0));
}

// All power and all that is left of it, in one cell.
@group(0) @binding(1) var whole_power: texture_3d<f32>;
@group(0) @binding(2) var whole_surplus: texture_3d<f32>;
@group(0) @binding(3) var<storage, read_write> scattered: array<vec4f>;

// What was found, with all power in sinks.
@compute @workgroup_size(64)
fn finish(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let all = textureLoad(whole_power, vec3u(0u), 0).rgb;
    let sunk = all - textureLoad(whole_surplus, vec3u(0u), 0).rgb;
    let share = clamp(all / max(sunk, vec3f(1e-30)), vec3f(0.5), vec3f(2.0));
    let found = textureLoad(fluence, cell_of(index, level.cells), 0).rgb;
    scattered[index] = vec4f(max(share * found, vec3f(0.0)), 0.0);
}
