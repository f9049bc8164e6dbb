// One level of the network of cells in which light diffuses: `src/passes/light_network/levels.rs`.

struct Level {
    // Cells along each axis, here and on the coarser level.
    cells: vec3u,
    coarser: vec3u,
    // How many cells along each axis make one of the coarser level: 1 or 2.
    factor: vec3u,
    // Edges of a cell, in the unit of the network.
    edges: vec3f,
    // The unit of the network, scene units.
    unit: f32,
    // Whether there is no coarser level.
    is_top: u32,
}

@group(0) @binding(0) var<uniform> level: Level;

fn count_of(cells: vec3u) -> u32 {
    return cells.x * cells.y * cells.z;
}

fn cell_of(index: u32, cells: vec3u) -> vec3u {
    return vec3u(index % cells.x, (index / cells.x) % cells.y, index / (cells.x * cells.y));
}

// The cells that make one of the coarser level.
struct Children {
    first: vec3u,
    size: vec3u,
}

fn children_of(coarser: vec3u) -> Children {
    let first = coarser * level.factor;
    return Children(first, min(level.factor, level.cells - first));
}

fn child_of(children: Children, index: u32) -> vec3u {
    return children.first + cell_of(index, children.size);
}

fn volume_of() -> f32 {
    return level.edges.x * level.edges.y * level.edges.z;
}

// The middle of a cell among those of the coarser level: the one below it on each axis, and how far it is on the way to the next.
struct Between {
    low: vec3i,
    part: vec3f,
}

fn between_coarser(cell: vec3u) -> Between {
    let at = clamp((vec3f(cell) + 0.5) / vec3f(level.factor) - 0.5, vec3f(0.0), vec3f(level.coarser) - 1.0);
    let low = min(floor(at), max(vec3f(level.coarser) - 2.0, vec3f(0.0)));
    return Between(vec3i(low), at - low);
}
