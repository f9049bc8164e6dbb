// The share of the light scattered in a cell that leaves the volume without being scattered again, and which way: what can be seen of it.
//
// Four directions at a time, which differ in the signs of what they have across an axis, are followed backwards from where they leave the
// volume, slice by slice along it. Between slices light moves across by a part of a cell and is interpolated; beside the volume is nothing.
//
// reads  light cells
// writes for each cell the mean over all directions of (direction, 1) times the transmittance from the cell to the outside

#import level
#import peak

struct Fan {
    // Amounts of the directions across the axis (its next two in turn) and along it; of unit length.
    cosines: vec3f,
    // The axis that they follow most closely, counted in cells, and whether they go up it.
    axis: u32,
    upwards: u32,
    // Slices from where they leave the volume.
    slice: u32,
    // Cells across from slice to slice.
    slope: vec2f,
    // Way through a slice, in the unit of the network.
    way: f32,
    // Of all directions.
    share: f32,
    // Share of scattered light that leaves its way.
    aside: f32,
}

@group(0) @binding(1) var<uniform> fan: Fan;
@group(0) @binding(2) var light_cells: texture_3d<f32>;
@group(0) @binding(3) var<storage, read_write> escape: array<vec4f>;
// What gets from a slice to the outside, of two slices in turn, one number for each direction: ++, -+, +-, -- across.
@group(0) @binding(4) var<storage, read_write> planes: array<vec4f>;

// From (across, across, along) to the axes of the volume.
fn unrolled(v: vec3f) -> vec3f {
    switch fan.axis {
        case 0u: { return v.zxy; }
        case 1u: { return v.yzx; }
        default: { return v; }
    }
}

fn extent() -> vec3i {
    let n = vec3i(level.cells);
    switch fan.axis {
        case 0u: { return n.yzx; }
        case 1u: { return n.zxy; }
        default: { return n; }
    }
}

// Optical depth of a cell on the way of the fan.
fn depth_at(at: vec2i, along: i32) -> f32 {
    let cell = vec3u(unrolled(vec3f(vec2f(at), f32(along))));
    let medium = textureLoad(light_cells, cell, 0);
    return min(medium.a * level.unit * mean_extinction(medium.rgb, fan.aside) * fan.way, 1e9);
}

// By how much the cell beside is thinner.
fn thinner(at: vec2i, along: i32, n: vec2i, depth: f32) -> f32 {
    let inside = clamp(at, vec2i(0), n - 1);
    let other = select(depth_at(inside, along), 0.0, any(at != inside));
    return max(1.0 - other / max(depth, 1e-20), 0.0);
}

fn plane_at(at: vec2i, n: vec2i) -> vec4f {
    let inside = clamp(at, vec2i(0), n - 1);
    let former = i32((fan.slice & 1u) ^ 1u);
    let found = planes[former * n.x * n.y + inside.y * n.x + inside.x];
    return select(found, vec4f(1.0), any(at != inside) || fan.slice == 0u);
}

@compute @workgroup_size(64)
fn follow(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let n = extent();
    if index >= u32(n.x * n.y) || fan.slice >= u32(n.z) {
        return;
    }
    let at = vec2i(i32(index) % n.x, i32(index) / n.x);
    let s = fan.slope.x;
    let t = fan.slope.y;
    let own = plane_at(at, n.xy);
    let right = plane_at(at + vec2i(1, 0), n.xy);
    let left = plane_at(at - vec2i(1, 0), n.xy);
    let up = plane_at(at + vec2i(0, 1), n.xy);
    let down = plane_at(at - vec2i(0, 1), n.xy);
    let beside = vec4f(right.x, left.y, right.z, left.w);
    let above = vec4f(up.x, up.y, down.z, down.w);
    let corner = vec4f(
        plane_at(at + vec2i(1, 1), n.xy).x,
        plane_at(at + vec2i(-1, 1), n.xy).y,
        plane_at(at + vec2i(1, -1), n.xy).z,
        plane_at(at + vec2i(-1, -1), n.xy).w,
    );
    let arrived = mix(mix(own, beside, s), mix(above, corner, s), t);

    let along = select(i32(fan.slice), n.z - 1 - i32(fan.slice), fan.upwards == 1u);
    let depth = depth_at(at, along);
    // Light gets out of a thick cell at an edge through both of its faces, of which the slice before knows one.
    let sides = vec4f(
        thinner(at + vec2i(1, 0), along, n.xy, depth),
        thinner(at - vec2i(1, 0), along, n.xy, depth),
        thinner(at + vec2i(0, 1), along, n.xy, depth),
        thinner(at - vec2i(0, 1), along, n.xy, depth),
    );
    let inflow = max(own + s * beside * sides.xyxy + t * above * sides.zzww, arrived);
    let thick = 1.0 - exp(-depth);
    let mean = mix(arrived, inflow, thick * thick) * lessening(depth);
    let sum = mean.x + mean.y + mean.z + mean.w;
    let across = vec2f(mean.x - mean.y + mean.z - mean.w, mean.x + mean.y - mean.z - mean.w);
    let towards = unrolled(fan.cosines * vec3f(across, select(-sum, sum, fan.upwards == 1u)));
    let cell = vec3u(unrolled(vec3f(vec2f(at), f32(along))));
    escape[(cell.z * level.cells.y + cell.y) * level.cells.x + cell.x] += fan.share * vec4f(towards, sum);
    planes[i32(fan.slice & 1u) * n.x * n.y + i32(index)] = arrived * exp(-depth);
}
