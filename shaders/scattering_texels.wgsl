// Which texels of the scattering cameras' maps are worth evaluating, and which points no camera sees.
//
// reads  points (vertices of the refined mesh), the cameras and their G-buffers
// writes per point the camera that sees it best, lists of texels and of points, and how many of each

#import maps

const NONE = 0xffffffffu;

struct Counts {
    texels: atomic<u32>,
    unseen: atomic<u32>,
}

@group(0) @binding(0) var<uniform> maps: Maps;
@group(0) @binding(1) var<storage, read> cameras: array<MapCamera>;
@group(0) @binding(2) var map_gbuffer: texture_2d_array<f32>;
@group(0) @binding(3) var<storage, read> vertices: array<f32>;
// The best camera of each point, NONE where no camera sees it.
@group(0) @binding(4) var<storage, read_write> best: array<u32>;
// One bit a texel: whether a point wants it.
@group(0) @binding(5) var<storage, read_write> wanted: array<atomic<u32>>;
@group(0) @binding(6) var<storage, read_write> counts: Counts;
// Texels, layer << 24 | row << 12 | column.
@group(0) @binding(7) var<storage, read_write> texels: array<u32>;
@group(0) @binding(8) var<storage, read_write> unseen: array<u32>;

// Workgroups across, down and deep that the lists of texels and of points need.
@group(0) @binding(9) var<storage, read_write> dispatches: array<u32>;

@compute @workgroup_size(64)
fn choose(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= maps.points {
        return;
    }
    let point = point_at(index);
    var camera = NONE;
    var greatest = 0.0;
    for (var layer = 0u; layer < maps.cameras; layer += 1u) {
        let weight = visibility(seen_by(cameras[layer], point), layer);
        if weight > greatest {
            greatest = weight;
            camera = layer;
        }
    }
    best[index] = camera;
    if camera == NONE {
        unseen[atomicAdd(&counts.unseen, 1u)] = index;
        return;
    }
    if maps.best_only == 0u {
        return;
    }
    // The four texels that the point will interpolate.
    let size = vec2i(textureDimensions(map_gbuffer));
    let first = vec2i(floor(seen_by(cameras[camera], point).place - 0.5));
    for (var i = 0; i < 4; i += 1) {
        let texel = clamp(first + vec2i(i & 1, i >> 1u), vec2i(0), size - 1);
        let bit = (camera * u32(size.y) + u32(size.y - 1 - texel.y)) * u32(size.x) + u32(texel.x);
        atomicOr(&wanted[bit >> 5u], 1u << (bit & 31u));
    }
}

@compute @workgroup_size(64)
fn list(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let bit = id.x + id.y * groups.x * 64u;
    let size = textureDimensions(map_gbuffer);
    let layer = bit / (size.x * size.y);
    if layer >= maps.cameras {
        return;
    }
    let row = bit / size.x % size.y;
    let column = bit % size.x;
    let is_wanted = maps.best_only == 0u || (atomicLoad(&wanted[bit >> 5u]) >> (bit & 31u) & 1u) == 1u;
    if is_wanted && any(textureLoad(map_gbuffer, vec2u(column, row), layer, 0).xyz != vec3f(0.0)) {
        texels[atomicAdd(&counts.texels, 1u)] = layer << 24u | row << 12u | column;
    }
}

fn workgroups(invocations: u32, at: u32) {
    let groups = (invocations + 63u) / 64u;
    let across = clamp(groups, 1u, 32768u);
    dispatches[at] = across;
    dispatches[at + 1u] = (groups + across - 1u) / across;
    dispatches[at + 2u] = 1u;
}

@compute @workgroup_size(64)
fn plan(@builtin(global_invocation_id) id: vec3u) {
    if id.x == 0u {
        workgroups(atomicLoad(&counts.texels), 0u);
        workgroups(atomicLoad(&counts.unseen), 3u);
    }
}
