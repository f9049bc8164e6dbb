// The light that leaves each point, taken from the maps of the scattering cameras that see it.
//
// reads  points, the cameras, their G-buffers and maps
// writes one vec4f a point: mean over all sets of samples so far; points that no camera sees are left alone

#import maps

const NONE = 0xffffffffu;

struct Gathering {
    // Where the light's results begin.
    first: u32,
    // What is there already counts so much, and what is found so much.
    keep: f32,
    gain: vec3f,
}

@group(0) @binding(0) var<uniform> maps: Maps;
@group(0) @binding(1) var<storage, read> cameras: array<MapCamera>;
@group(0) @binding(2) var map_gbuffer: texture_2d_array<f32>;
@group(0) @binding(3) var<storage, read> vertices: array<f32>;
@group(0) @binding(4) var<storage, read> best: array<u32>;
@group(0) @binding(5) var map_radiosity: texture_2d_array<f32>;
@group(0) @binding(6) var<uniform> gathering: Gathering;
@group(0) @binding(7) var<storage, read_write> radiosity: array<vec4f>;

// What a map holds for a point, interpolated among those of the four nearest texels that show its surface; in w the share that does.
fn held_by(seen: Seen, layer: u32) -> vec4f {
    let size = vec2i(textureDimensions(map_gbuffer));
    let first = floor(seen.place - 0.5);
    let part = seen.place - 0.5 - first;
    var sum = vec4f(0.0);
    for (var i = 0; i < 4; i += 1) {
        let corner = vec2i(i & 1, i >> 1u);
        let texel = vec2i(first) + corner;
        let near = mix(1.0 - part, part, vec2f(corner));
        if abs(above(seen, layer, texel)) <= seen.bias {
            let value = textureLoad(map_radiosity, vec2i(texel.x, size.y - 1 - texel.y), layer, 0);
            sum += near.x * near.y * vec4f(value.xyz, 1.0);
        }
    }
    return sum;
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= maps.points {
        return;
    }
    let chosen = best[index];
    if chosen == NONE {
        return;
    }
    let point = point_at(index);
    var sum = vec4f(0.0);
    let first_layer = select(0u, chosen, maps.best_only == 1u);
    let end_layer = select(maps.cameras, chosen + 1u, maps.best_only == 1u);
    for (var layer = first_layer; layer < end_layer; layer += 1u) {
        let seen = seen_by(cameras[layer], point);
        let weight = visibility(seen, layer);
        if weight > 0.0 {
            sum += weight * held_by(seen, layer);
        }
    }
    let now = sum.xyz / max(sum.w, 1e-20);
    let place = gathering.first + index;
    let before = select(radiosity[place].xyz, vec3f(0.0), gathering.keep == 0.0);
    radiosity[place] = vec4f(gathering.keep * before + gathering.gain * now, 1.0);
}
