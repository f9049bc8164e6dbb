// Sweeps through the cells of a volume, slice by slice along one of its axes.
//
// What goes on from a slice spreads across the axis: in a medium light gains 2 D of variance for each unit of its way, D = 1 / (3 sigma_t
// (1 - albedo g)). What a cell gives its neighbours it does not keep, and over the sides of the volume it is lost.

struct ScatterSweep {
    // Cells along each axis of the volume.
    cells: vec3u,
    // The axis of the sweep, and whether light goes up it.
    axis: u32,
    // How much the light leans to each axis; 0 for those that are not swept.
    shares: vec3f,
    // Length of a cell along and across, scene units.
    along: f32,
    across: vec2f,
    // Cosine between light and axis.
    mu0: f32,
    g: f32,
    forwards: u32,
    // Variance across for a slice of the mean free path 1, in its unit times the slice's.
    spread: f32,
}

struct Slice {
    index: u32,
}

@group(0) @binding(0) var<uniform> sweep_of: ScatterSweep;
@group(0) @binding(1) var<uniform> slice: Slice;
// Albedo, sigma_t per scene unit.
@group(0) @binding(2) var light_cells: texture_3d<f32>;
// For each cell of a slice, of two slices in turn: what goes on and how it spreads, and what else is known at that face.
@group(0) @binding(3) var<storage, read_write> faces: array<vec4f>;

// Light goes over to cells beside in steps of 1, 3 and 9 cells, as far as it spreads; the greatest share that goes over one step.
const STEPS = 3u;
const LONGER = 3;
const MOST = 0.2;

// Cells across, and slices.
fn extent() -> vec3u {
    let n = sweep_of.cells;
    switch sweep_of.axis {
        case 0u: { return n.yzx; }
        case 1u: { return n.zxy; }
        default: { return n; }
    }
}

// From (across, across, along) to the axes of the volume.
fn unrolled(v: vec3f) -> vec3f {
    switch sweep_of.axis {
        case 0u: { return v.zxy; }
        case 1u: { return v.yzx; }
        default: { return v; }
    }
}

// The texture of the volume at a place in cells, counted along from where light enters.
fn place_of(across: vec2f, along: f32) -> vec3f {
    let at = vec3f(across, along) / vec3f(extent());
    return unrolled(vec3f(at.xy, select(1.0 - at.z, at.z, sweep_of.forwards == 1u)));
}

fn cell_of(across: vec2u, along: u32) -> vec3u {
    let n = extent();
    return vec3u(unrolled(vec3f(vec2f(across), f32(select(n.z - 1u - along, along, sweep_of.forwards == 1u)))));
}

// Variance across that light gains in a slice, in squares of a cell.
fn spread_in(cell: vec4f) -> f32 {
    let albedo = (cell.r + cell.g + cell.b) / 3.0;
    let free = 1.0 / max(cell.a * (1.0 - albedo * sweep_of.g), 1e-30);
    // Without a medium light would go on for ever, but here no further than the steps reach.
    return min(sweep_of.spread * sweep_of.along * free, 1e6 * dot(sweep_of.across, sweep_of.across));
}

// The shares of light that go over steps of each length, for a variance in squares of a cell.
fn shares(variance: f32) -> vec3f {
    let longer = f32(LONGER * LONGER);
    let near = 2.0 * MOST;
    let far = near * longer;
    let farther = far * longer;
    let more = clamp((variance - near) / (far - near), 0.0, 1.0);
    let most = clamp((variance - far) / (farther - far), 0.0, 1.0);
    return vec3f(min(0.5 * variance, MOST * (1.0 - more)), MOST * (more - most), MOST * most);
}

// What is exchanged with a cell beside.
fn exchanged(own: vec4f, across: vec2i, step: vec2i, face: u32, which: u32) -> vec3f {
    let n = vec2i(extent().xy);
    let there = across + step;
    let is_outside = any(there < vec2i(0)) || any(there >= n);
    let inside = clamp(there, vec2i(0), n - 1);
    var other = faces[2u * (face * u32(n.x * n.y) + u32(inside.y * n.x + inside.x))];
    other = select(other, vec4f(0.0, 0.0, 0.0, own.a), is_outside);
    // Harmonic: light cannot leave a cell faster than it moves in it. The same for both, so that none is made or lost.
    let spread = 2.0 * own.a / (1.0 + own.a / max(other.a, 1e-30));
    // In a far thinner medium nothing turns light back: it would be lost there, while what is seen goes straight on.
    let ratio = min(own.a, other.a) / max(max(own.a, other.a), 1e-30);
    let length = select(sweep_of.across.y, sweep_of.across.x, step.x != 0);
    return shares(ratio * spread / (length * length))[which] * (other.rgb - own.rgb);
}

// What has gone on from a slice, spread.
fn spread_out(across: vec2u, face: u32) -> vec3f {
    let n = extent();
    let own = faces[2u * (face * n.x * n.y + across.y * n.x + across.x)];
    let at = vec2i(across);
    var sum = own.rgb;
    var length = 1;
    for (var which = 0u; which < STEPS; which += 1u) {
        sum += exchanged(own, at, vec2i(length, 0), face, which) + exchanged(own, at, vec2i(-length, 0), face, which);
        sum += exchanged(own, at, vec2i(0, length), face, which) + exchanged(own, at, vec2i(0, -length), face, which);
        length *= LONGER;
    }
    return max(sum, vec3f(0.0));
}
