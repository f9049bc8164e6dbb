// Volumes by ray casting, several marched together in order of depth, in front of what the surface pass left.
//
// Each volume is cut along the ray into segments of its own step. A segment of length d at the middle of which the field has the
// value v absorbs alpha = 1 - exp(-sigma_t(v) d) and emits colour(v) alpha (Max 1995); segments are put together front to back. The
// error is of second order in the step.
//
// reads  volume textures, lookup tables (colour, sigma_t per scene unit), brick distances, surface
// writes rgba32float: radiance, number of samples taken

#import frame
#import fullscreen
#import volumes

struct VolumeInstance {
    texture_from_eye: mat4x4f,
    // Voxels along each axis.
    size: vec3f,
    // Length of a segment, scene units.
    step: f32,
    // Place in the lookup table = texel * scale + offset.
    lookup_scale: f32,
    lookup_offset: f32,
    // The table: first entry and number of entries.
    table_start: u32,
    table_entries: u32,
    // Bricks along each axis, and the first of them.
    bricks: vec3u,
    bricks_start: u32,
    // The ray ends when less than this is left of what lies behind.
    least_transmittance: f32,
    skip_empty: u32,
    // 0 emission-absorption, 1 gradient.
    lighting: u32,
    ambient: f32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    // Texels beyond this touch a sample that is not finite.
    sentinel: f32,
}

// Where a ray is within one volume.
struct March {
    // The ray in the volume's texture space.
    origin: vec3f,
    direction: vec3f,
    // The stretch inside the volume, scene units.
    enter: f32,
    leave: f32,
    // Segments done.
    done: f32,
    count: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var<storage, read> volumes: array<VolumeInstance>;
@group(0) @binding(3) var<storage, read> table: array<vec4f>;
// Four to a word: distance to the nearest brick that holds something, in bricks; 0 is such a brick.
@group(0) @binding(4) var<storage, read> brick_distances: array<u32>;
@group(0) @binding(5) var surface: texture_2d<f32>;
@group(0) @binding(6) var linear_sampler: sampler;

const BRICK = 8.0;

fn start_march(volume: VolumeInstance, ray: Ray, surface_distance: f32) -> March {
    let origin = (volume.texture_from_eye * vec4f(ray.origin, 1.0)).xyz;
    let direction = (volume.texture_from_eye * vec4f(ray.direction, 0.0)).xyz;
    // A direction along a face would divide by zero.
    let safe = select(direction, vec3f(1e-30), abs(direction) < vec3f(1e-30));
    let a = -origin / safe;
    let b = (1.0 - origin) / safe;
    let near = min(a, b);
    let far = max(a, b);
    let enter = max(max(near.x, near.y), max(near.z, 0.0));
    let leave = min(min(far.x, far.y), min(far.z, surface_distance));
    let count = select(0.0, ceil((leave - enter) / volume.step - 1e-3), leave > enter);
    return March(origin, direction, enter, leave, 0.0, count);
}

// How many segments from the one at `place` lie in bricks that hold nothing.
fn empty_segments(volume: VolumeInstance, march: March, place: vec3f) -> f32 {
    let at = clamp(place * volume.size / BRICK, vec3f(0.0), vec3f(volume.bricks) - 0.5);
    let brick = vec3u(at);
    let index = volume.bricks_start + (brick.z * volume.bricks.y + brick.y) * volume.bricks.x + brick.x;
    let reach = f32((brick_distances[index >> 2u] >> ((index & 3u) * 8u)) & 255u);
    if reach == 0.0 {
        return 0.0;
    }
    let pace = march.direction * volume.size / BRICK * volume.step;
    let wall = select(vec3f(brick) - (reach - 1.0), vec3f(brick) + reach, pace > vec3f(0.0));
    let safe = select(pace, vec3f(1e-30), abs(pace) < vec3f(1e-30));
    let until = (wall - at) / safe;
    return max(1.0, ceil(min(until.x, min(until.y, until.z)) - 1e-3));
}

fn look_up(volume: VolumeInstance, texel: f32) -> vec4f {
    let last = f32(volume.table_entries - 1u);
    let place = clamp(texel * volume.lookup_scale + volume.lookup_offset, 0.0, 1.0) * last;
    let below = min(floor(place), last - 1.0);
    let index = volume.table_start + u32(below);
    return mix(table[index], table[index + 1u], place - below);
}

// Blinn-Phong with the gradient of the field for a normal.
fn shade(volume: VolumeInstance, index: u32, colour: vec3f, place: vec3f, centre: f32, ray: Ray) -> vec3f {
    let voxel = 1.0 / volume.size;
    let x = vec3f(voxel.x, 0.0, 0.0);
    let y = vec3f(0.0, voxel.y, 0.0);
    let z = vec3f(0.0, 0.0, voxel.z);
    var ahead = vec3f(texel_at(index, place + x), texel_at(index, place + y), texel_at(index, place + z));
    var behind = vec3f(texel_at(index, place - x), texel_at(index, place - y), texel_at(index, place - z));
    ahead = select(ahead, vec3f(centre), ahead > vec3f(volume.sentinel));
    behind = select(behind, vec3f(centre), behind > vec3f(volume.sentinel));
    // The gradient is a covector: it goes through the transpose.
    let gradient = (vec4f((ahead - behind) * volume.size, 0.0) * volume.texture_from_eye).xyz;
    let steepest = max(abs(gradient.x), max(abs(gradient.y), abs(gradient.z)));
    let flat = steepest * volume.lookup_scale * volume.step < 1e-6;
    let along = normalize(gradient / max(steepest, 1e-30));
    let normal = select(along, -along, dot(along, ray.direction) > 0.0);
    var diffuse = vec3f(0.0);
    var specular = vec3f(0.0);
    for (var i = 0u; i < frame.light_count; i += 1u) {
        let light = lights[i];
        let half_way = normalize(light.to_light - ray.direction);
        let cosine = max(dot(normal, light.to_light), 0.0);
        let highlight = pow(max(dot(normal, half_way), 0.0), volume.shininess);
        diffuse += light.irradiance / PI * select(cosine, 1.0, flat);
        specular += light.irradiance / PI * select(highlight, 0.0, flat || cosine == 0.0);
    }
    return colour * (volume.ambient + volume.diffuse * diffuse) + volume.specular * specular;
}

@fragment
fn march(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let ray = ray_through(position.xy, frame);
    let behind = textureLoad(surface, min(vec2u(position.xy), textureDimensions(surface) - 1u), 0);
    var marches: array<March, VOLUMES>;
    for (var i = 0u; i < VOLUMES; i += 1u) {
        marches[i] = start_march(volumes[i], ray, behind.a);
    }
    var radiance = vec3f(0.0);
    var transmittance = 1.0;
    var samples = 0.0;
    loop {
        // The volume whose next segment is the nearest.
        var index = 0u;
        var distance = FAR;
        for (var i = 0u; i < VOLUMES; i += 1u) {
            let start = marches[i].enter + marches[i].done * volumes[i].step;
            if marches[i].done < marches[i].count && start < distance {
                index = i;
                distance = start;
            }
        }
        if distance == FAR {
            break;
        }
        let volume = volumes[index];
        let progress = marches[index];
        let length = min(volume.step, progress.leave - distance);
        let place = progress.origin + progress.direction * (distance + 0.5 * length);
        if volume.skip_empty == 1u {
            let empty = empty_segments(volume, progress, place);
            if empty > 0.0 {
                marches[index].done += empty;
                continue;
            }
        }
        marches[index].done += 1.0;
        samples += 1.0;
        let texel = texel_at(index, place);
        let entry = look_up(volume, texel);
        if entry.a <= 0.0 || texel > volume.sentinel {
            continue;
        }
        let alpha = 1.0 - exp(-entry.a * length);
        var colour = entry.rgb;
        if volume.lighting == 1u {
            colour = shade(volume, index, colour, place, texel, ray);
        }
        radiance += transmittance * alpha * colour;
        transmittance *= 1.0 - alpha;
        if transmittance <= volume.least_transmittance {
            transmittance = 0.0;
            break;
        }
    }
    return vec4f(radiance + transmittance * behind.rgb, samples);
}
