// Volumes by ray casting, several marched together in order of depth, in front of what the surface pass left.
//
// Each volume is cut along the ray into segments of its own step. A segment of length d at the middle of which the field has the
// value v absorbs alpha = 1 - exp(-sigma_t(v) d) and emits colour(v) alpha (Max 1995); segments are put together front to back. The
// error is of second order in the step. So it is with `Post`; what `Pre` and `PreIntegrated` make of a segment is in shared/classify.wgsl.
//
// reads  volume textures, lookup tables (colour, sigma_t per scene unit), brick distances, surface; classified voxels, pre-integrated pairs
//        (all as textures and uniforms: software adapters read storage buffers one lane at a time)
// writes rgba32float: radiance, number of samples taken

#import frame
#import fullscreen
#import lights
#import phase
#import peak
#import parts
#import volumes
#import lighting
#import light_volumes
#import first_sweeps
#import scattered
#import shadows
#import classify

struct VolumeInstance {
    texture_from_eye: mat4x4f,
    // Voxels along each axis.
    size: vec3f,
    // Length of a segment, eye space.
    step: f32,
    // Place in the lookup table = texel * scale + offset.
    lookup_scale: f32,
    lookup_offset: f32,
    // Entries of the table, its first row, and whether each is a value of its own.
    table_entries: u32,
    table_row: u32,
    is_exact: u32,
    // The first of the volume's bricks.
    bricks_start: u32,
    // Bricks along each axis.
    bricks: vec3u,
    // The ray ends when less than this is left of what lies behind.
    least_transmittance: f32,
    skip_empty: u32,
    // 0 emission-absorption, 1 gradient, 2 scattered once, 3 scattered without any light, 4 scattered however often,
    // 5 the same with light that goes on towards the eye.
    lighting: u32,
    ambient: f32,
    diffuse: f32,
    specular: f32,
    shininess: f32,
    // Where samples are missing: how far below 0 what is missing counts as, for gradients, in texels.
    edge: f32,
    // Scene units to a unit of eye space.
    reach: f32,
    // Mean cosine of scattering.
    g: f32,
    // Share of the colour that is emitted by a volume that scatters.
    emission: f32,
    // Fluence = texel * this.
    fluence_scale: f32,
    // The greatest of the phase function beside its peak.
    peak_cap: f32,
    // What classified voxels are shares of.
    greatest_colour: f32,
    greatest_extinction: f32,
}

// Where a ray is within one volume.
struct March {
    // The stretch inside the volume, eye space.
    enter: f32,
    leave: f32,
    // Segments done, and all there are.
    done: f32,
    count: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lights: array<Light, LIGHT_CAPACITY>;
@group(0) @binding(2) var<uniform> volumes: array<VolumeInstance, VOLUMES>;
// Rows of entries: colour and extinction.
@group(0) @binding(3) var tables: texture_2d<f32>;
// Rows of BRICK_ROW bricks: distance to the nearest brick that holds something, in bricks; 0 is such a brick.
@group(0) @binding(4) var brick_distances: texture_2d<u32>;
@group(0) @binding(5) var surface: texture_2d<f32>;
@group(0) @binding(6) var linear_sampler: sampler;

// Samples that are lit together where light is scattered often, at most, and the optical depth that is enough for them: light varies by
// less over them than the model is off. More, to four times that, the less of the light from there reaches the eye.
const TOGETHER = 2.0;
const DEPTH_TOGETHER = 0.3;
const LEAST_SEEN = 0.25;

fn start_march(index: u32, ray: Ray, surface_distance: f32) -> March {
    let origin = (volumes[index].texture_from_eye * vec4f(ray.origin, 1.0)).xyz;
    let safe = away_from_zero((volumes[index].texture_from_eye * vec4f(ray.direction, 0.0)).xyz);
    let a = -origin / safe;
    let b = (1.0 - origin) / safe;
    let near = min(a, b);
    let far = max(a, b);
    let enter = max(max(near.x, near.y), max(near.z, 0.0));
    let leave = min(min(far.x, far.y), min(far.z, surface_distance));
    let count = select(0.0, ceil((leave - enter) / volumes[index].step - 1e-3), leave > enter);
    return March(enter, leave, 0.0, count);
}

// A direction along a face would divide by zero.
fn away_from_zero(v: vec3f) -> vec3f {
    return select(v, vec3f(1e-30), abs(v) < vec3f(1e-30));
}

// What the inner loops read of a volume, kept at hand.
struct Lookup {
    last: f32,
    scale: f32,
    offset: f32,
    row: u32,
    is_exact: bool,
}

fn brick_distance(bricks: vec3u, first: u32, at: vec3u) -> f32 {
    let brick = first + (at.z * bricks.y + at.y) * bricks.x + at.x;
    return f32(textureLoad(brick_distances, vec2u(brick % BRICK_ROW, brick / BRICK_ROW), 0).r);
}

fn lookup_of(volume: VolumeInstance) -> Lookup {
    let last = f32(volume.table_entries - 1u);
    return Lookup(last, volume.lookup_scale, volume.lookup_offset, volume.table_row, volume.is_exact == 1u);
}

// Colour and extinction of a texel.
fn look_up(lookup: Lookup, texel: f32) -> vec4f {
    let place = clamp(texel * lookup.scale + lookup.offset, 0.0, 1.0) * lookup.last;
    if ANY_EXACT && lookup.is_exact {
        let entry = u32(round(place));
        return textureLoad(tables, vec2u(entry % TABLE_ROW, lookup.row + entry / TABLE_ROW), 0);
    }
    let below = min(floor(place), lookup.last - 1.0);
    let entry = vec2u(u32(below), lookup.row);
    return mix(textureLoad(tables, entry, 0), textureLoad(tables, entry + vec2u(1u, 0u), 0), place - below);
}

// 1 - exp(-depth), without the cancellation that many thin segments would add up.
fn absorbed(depth: f32) -> f32 {
    let series = depth * (1.0 - depth * (0.5 - depth * (1.0 / 6.0 - depth / 24.0)));
    return select(1.0 - exp(-depth), series, depth < 0.05);
}

// The gradient of the field as a normal that leans towards the eye.
struct Normal {
    direction: vec3f,
    // Whether the field does not vary.
    flat: bool,
    // How much the value varies over a voxel, as a share of the domain.
    steepness: f32,
}

// What gradients are taken of where values are interpolated. What is missing counts as less than any value, so that the medium's end is a surface.
fn field_at(index: u32, volume: VolumeInstance, place: vec3f) -> f32 {
    let voxel = voxel_at(index, place);
    if ANY_PARTIAL {
        return (voxel.texel + volume.edge) * voxel.share;
    }
    return voxel.texel;
}

// How much more of the field there is ahead along each axis than behind, two voxels apart.
fn rise_at(index: u32, volume: VolumeInstance, place: vec3f) -> vec3f {
    let voxel = 1.0 / volume.size;
    if ANY_SURFACES && has_surfaces(index) {
        return rise_of_extinction(index, place, voxel);
    }
    let x = vec3f(voxel.x, 0.0, 0.0);
    let y = vec3f(0.0, voxel.y, 0.0);
    let z = vec3f(0.0, 0.0, voxel.z);
    let ahead = vec3f(
        field_at(index, volume, place + x),
        field_at(index, volume, place + y),
        field_at(index, volume, place + z),
    );
    let behind = vec3f(
        field_at(index, volume, place - x),
        field_at(index, volume, place - y),
        field_at(index, volume, place - z),
    );
    return ahead - behind;
}

// The same of extinction, as a share of its greatest, over the 4 x 4 x 4 voxels around: of values that are not interpolated there is no gradient.
fn rise_of_extinction(index: u32, place: vec3f, voxel: vec3f) -> vec3f {
    var rise = vec3f(0.0);
    for (var corner = 0u; corner < 8u; corner += 1u) {
        let side = 2.0 * vec3f(vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u)) - 1.0;
        rise += side * voxels_at(index, place + side * voxel).a;
    }
    return 0.25 * rise;
}

fn normal_at(index: u32, volume: VolumeInstance, place: vec3f, ray: Ray) -> Normal {
    let rise = rise_at(index, volume, place);
    var scale = volume.lookup_scale;
    if ANY_SURFACES && has_surfaces(index) {
        scale = 1.0;
    }
    // The gradient is a covector: it goes through the transpose.
    let gradient = (vec4f(rise * volume.size, 0.0) * volume.texture_from_eye).xyz;
    let steepest = max(abs(gradient.x), max(abs(gradient.y), abs(gradient.z)));
    let flat = steepest * scale * volume.step < 1e-6;
    let scaled = gradient / max(steepest, 1e-30);
    let along = scaled * inverseSqrt(max(dot(scaled, scaled), 1e-30));
    let steepness = 0.5 * length(rise) * scale;
    return Normal(select(along, -along, dot(along, ray.direction) > 0.0), flat, steepness);
}

// Blinn's highlight (n.h)^s.
fn highlight(normal: Normal, to_light: vec3f, shininess: f32, ray: Ray) -> f32 {
    let sum = to_light - ray.direction;
    let half_way = sum * inverseSqrt(max(dot(sum, sum), 1e-12));
    let bright = pow(max(dot(normal.direction, half_way), 1e-6), shininess);
    return select(bright, 0.0, normal.flat || dot(normal.direction, to_light) <= 0.0);
}

// Blinn-Phong with the gradient of the field for a normal.
fn shade(index: u32, volume: VolumeInstance, colour: vec3f, place: vec3f, ray: Ray) -> vec3f {
    let normal = normal_at(index, volume, place, ray);
    var diffuse = vec3f(0.0);
    var specular = vec3f(0.0);
    for (var i = 0u; i < frame.light_count; i += 1u) {
        let irradiance = lights[i].irradiance / PI;
        let cosine = max(dot(normal.direction, lights[i].to_light), 0.0);
        diffuse += irradiance * select(cosine, 1.0, normal.flat);
        specular += irradiance * highlight(normal, lights[i].to_light, volume.shininess, ray);
    }
    return colour * (volume.ambient + volume.diffuse * diffuse) + volume.specular * specular;
}

// What is lit at once: a sample, or several that are close.
struct Sample {
    colour: vec3f,
    // Where it is: as a share of the volume, and along the ray from where it enters.
    place: vec3f,
    along: f32,
    // Optical depth of a step of the ray there.
    each: f32,
    // 1 - albedo f.
    thinned: f32,
}

// Optical depth from a sample to a light. Where a cell of the light volume takes much of the light, what is interpolated in it is far from what is there:
// then the ray looks through the slices next to the sample for itself, and finds in the light volume what had come through until there.
fn depth_to_light(way: Way, volume: VolumeInstance, light: u32, on_way: LightWay, sample: Sample) -> f32 {
    let index = first_sweep(way.index) + light;
    let interpolated = light_depth_on(index, on_way, sample.along);
    let slices = near_slices(way.index);
    if !ANY_NEAR || slices == 0u {
        return interpolated;
    }
    let step = light_step(index);
    // Of so little that it does not matter what light it gets, up to twice that.
    let needed = clamp(sample.each * step.w / (volume.reach * volume.step * LEAST_LOOKED) - 1.0, 0.0, 1.0);
    if needed == 0.0 {
        return interpolated;
    }
    let samples = slices * NEAR_SAMPLES;
    // No further than to where the light comes in.
    let near = min(f32(slices), reach_on(on_way, sample.along));
    let part = near / f32(samples);
    var extinction = 0.0;
    for (var i = 0u; i < samples; i += 1u) {
        let place = sample.place - step.xyz * (part * (f32(i) + 0.5));
        extinction += found_at(way.index, volume, way.lookup, way.classification, place).extinction;
    }
    return mix(interpolated, light_depth(index, sample.place - step.xyz * near) + part * step.w * extinction, needed);
}

// Light that is scattered towards the eye: the source function where the albedo is `colour`. Where light is scattered often, what a forward
// peak scatters counts as light that was not (`src/optics/peak.rs`).
fn scatter(way: Way, volume: VolumeInstance, sample: Sample, ray: Ray, ways: array<LightWay, LIGHT_WAYS>) -> vec3f {
    let index = way.index;
    let place = sample.place;
    let albedo = min(sample.colour, vec3f(1.0));
    let is_often = ANY_OFTEN && volume.lighting >= 4u;
    let towards_eye = ANY_TOWARDS_EYE && volume.lighting == 5u;
    let cap = select(3e38, volume.peak_cap, is_often);
    var arriving = vec3f(0.0);
    var specular = vec3f(0.0);
    var normal: Normal;
    if ANY_HIGHLIGHT {
        normal = normal_at(index, volume, place, ray);
    }
    for (var i = 0u; i < LIGHTS; i += 1u) {
        let depth = depth_to_light(way, volume, i, ways[i], sample);
        let light = lights[i].irradiance * light_seen(first_sweep(index) + i, place);
        if ANY_LEANING {
            let phase = min(henyey_greenstein(-lights[i].to_light, -ray.direction, volume.g), cap);
            let extinction = select(vec3f(1.0), beam_extinction(albedo, volume.g), is_often);
            arriving += light * exp(-depth * extinction) * phase;
        } else {
            arriving += light * (exp(-depth) / (4.0 * PI));
        }
        if ANY_HIGHLIGHT {
            specular += light * exp(-depth) / PI * highlight(normal, lights[i].to_light, volume.shininess, ray);
        }
    }
    if is_often {
        let even = volume.fluence_scale / (4.0 * PI) * fluence_at(index, place);
        if ANY_TOWARDS_EYE && towards_eye {
            arriving += (1.0 - volume.g) * even + volume.g * volume.fluence_scale * eye_light_at(index, place);
        } else {
            arriving += beside_peak(volume.g) * even;
        }
    } else if ANY_SHARED {
        // Of lights that have no light volume of their own.
        arriving += volume.fluence_scale / (4.0 * PI) * fluence_at(index, place);
    }
    let sent = albedo * arriving / sample.thinned + volume.emission * sample.colour;
    if ANY_HIGHLIGHT {
        return sent + volume.specular * min(4.0 * normal.steepness, 1.0) * specular;
    }
    return sent;
}

// 1 - albedo f of a piece of the medium; 1 for lightings that know of no peak.
fn thinning(volume: VolumeInstance, colour: vec3f) -> f32 {
    if ANY_PEAK && volume.lighting == 4u {
        return max(mean_beam_extinction(min(colour, vec3f(1.0)), volume.g), 1e-6);
    }
    return 1.0;
}

// What a piece of the medium sends to the eye, per share that it absorbs.
fn source(way: Way, volume: VolumeInstance, sample: Sample, ray: Ray, ways: array<LightWay, LIGHT_WAYS>) -> vec3f {
    if ANY_GRADIENT && volume.lighting == 1u {
        return shade(way.index, volume, sample.colour, sample.place, ray);
    }
    if ANY_SCATTERING && (volume.lighting == 2u || volume.lighting >= 4u) {
        return scatter(way, volume, sample, ray, ways);
    }
    return select(sample.colour, volume.emission * sample.colour, volume.lighting == 3u);
}

// What is found at a place.
struct Found {
    colour: vec3f,
    extinction: f32,
}

fn found_at(index: u32, volume: VolumeInstance, lookup: Lookup, classification: u32, at: vec3f) -> Found {
    if ANY_PRE && classification == PRE {
        let found = pre_classified(index, at, volume.greatest_colour, volume.greatest_extinction);
        return Found(found.rgb, found.a);
    }
    let voxel = voxel_at(index, at);
    let found = look_up(lookup, voxel.texel);
    var colour = found.rgb;
    if ANY_TINTED {
        colour *= voxel.tint;
    }
    return Found(colour, found.a * voxel.shown);
}

// The colour of a segment that goes through colours.
fn tinted(colour: vec3f, front: Voxel, back: Voxel) -> vec3f {
    if ANY_TINTED {
        // What is clear has none.
        let ends = front.tint * front.shown + back.tint * back.shown;
        return colour * ends / max(front.shown + back.shown, 1e-30);
    }
    return colour;
}

// Samples that are lit together: what they absorb, and sums of what they are by what each shows.
struct Together {
    colour: vec3f,
    along: f32,
    // Optical depth of one of them, and of all.
    each: f32,
    depth: f32,
    alpha: f32,
}

// The same with one more.
fn joined(all: Together, colour: vec3f, depth: f32, along: f32) -> Together {
    let shown = (1.0 - all.alpha) * absorbed(depth);
    return Together(
        all.colour + shown * colour,
        all.along + shown * along,
        all.each + shown * depth,
        all.depth + depth,
        all.alpha + shown,
    );
}

// What a ray has gathered, and what it still sees.
struct Gathered {
    radiance: vec3f,
    transmittance: f32,
    // Of light in a forward peak, too.
    thin_transmittance: f32,
    samples: f32,
}

// The share of what lies behind that is still seen.
fn left_of(gathered: Gathered) -> f32 {
    return select(gathered.transmittance, gathered.thin_transmittance, ANY_PEAK);
}

// Whose segments come next.
struct Turn {
    index: u32,
    // Where the next of them begins; FAR where there is none.
    nearest: f32,
    // Where the next of the others begins.
    until: f32,
}

fn next_turn(marches: array<March, VOLUMES>) -> Turn {
    var turn = Turn(0u, FAR, FAR);
    for (var i = 0u; i < VOLUMES; i += 1u) {
        let start = marches[i].enter + marches[i].done * volumes[i].step;
        if marches[i].done < marches[i].count {
            turn.until = min(turn.until, max(start, turn.nearest));
            turn.index = select(turn.index, i, start < turn.nearest);
            turn.nearest = min(turn.nearest, start);
        }
    }
    return turn;
}

// The way of a ray through one volume, kept at hand during its turn.
struct Way {
    index: u32,
    classification: u32,
    // Whether segments are looked up by both of their ends.
    integrated: bool,
    // Whether each sample is lit for itself.
    alone: bool,
    lookup: Lookup,
    // The texture of the volume = start + direction * distance from where the ray enters.
    start: vec3f,
    direction: vec3f,
    // How much of the ray is inside.
    length: f32,
    // The same in bricks, and from segment to segment.
    bricks: vec3f,
    pace: vec3f,
    top: vec3f,
}

fn way_of(index: u32, volume: VolumeInstance, ray: Ray, enter: f32, leave: f32) -> Way {
    var way: Way;
    way.index = index;
    way.classification = classification_of(index);
    way.integrated = ANY_PRE_INTEGRATED && way.classification == PRE_INTEGRATED;
    way.alone = !ANY_OFTEN || way.integrated || volume.lighting < 4u;
    way.lookup = lookup_of(volume);
    way.direction = (volume.texture_from_eye * vec4f(ray.direction, 0.0)).xyz;
    way.start = (volume.texture_from_eye * vec4f(ray.origin, 1.0)).xyz + way.direction * enter;
    way.length = leave - enter;
    way.bricks = volume.size / BRICK;
    way.pace = away_from_zero(way.direction * way.bricks * volume.step);
    way.top = vec3f(volume.bricks) - 0.5;
    return way;
}

// From a segment on to the next in a brick that holds something, but not beyond `turn`.
fn leap(way: Way, volume: VolumeInstance, first: f32, turn: f32, work: ptr<function, u32>) -> f32 {
    var done = first;
    loop {
        if volume.skip_empty == 0u || done >= turn || (IN_PARTS && *work > MOST_WORK) {
            break;
        }
        *work += WORK_OF_LEAP;
        // A segment is looked at in its middle, or at both ends: then all of it is to be in empty bricks.
        let at = clamp(way.start * way.bricks + way.pace * (done + select(0.5, 0.0, way.integrated)), vec3f(0.0), way.top);
        let brick = floor(at);
        let reach = brick_distance(volume.bricks, volume.bricks_start, vec3u(brick));
        if reach == 0.0 {
            break;
        }
        let wall = select(brick - (reach - 1.0), brick + reach, way.pace > vec3f(0.0));
        let walls = (wall - at) / way.pace;
        let wall_distance = min(walls.x, min(walls.y, walls.z)) - 1e-3;
        if way.integrated && wall_distance < 1.0 {
            break;
        }
        done += select(max(1.0, ceil(wall_distance)), floor(wall_distance), way.integrated);
    }
    return done;
}

// A segment, with what was found at the end of the one before, where both ends are looked up.
fn segment(way: Way, volume: VolumeInstance, done: f32, all: Together, back: ptr<function, Voxel>) -> Together {
    let length = min(volume.step, way.length - done * volume.step);
    if way.integrated {
        let front = *back;
        *back = voxel_at(way.index, way.start + way.direction * (done * volume.step + length));
        let found = pre_integrated(way.index, way.lookup, front, *back, length / volume.step);
        var at = 0.5;
        if ANY_LIT {
            at = surface_in(way.index, way.lookup, front, *back);
        }
        let along = done * volume.step + at * length;
        return joined(all, tinted(found.rgb, front, *back), found.a, along);
    }
    let along = done * volume.step + 0.5 * length;
    let found = found_at(way.index, volume, way.lookup, way.classification, way.start + way.direction * along);
    return joined(all, found.colour, found.extinction * volume.reach * length, along);
}

// What is left behind a piece that absorbs the share `alpha`. Of hundreds of thousands that are as thin as each other, the digits that 1 - alpha
// loses would add up.
fn dimmed(transmittance: f32, alpha: f32) -> f32 {
    if IN_PARTS {
        return transmittance - transmittance * alpha;
    }
    return transmittance * (1.0 - alpha);
}

// What samples that are lit together show, in front of all that comes after.
fn show(
    way: Way,
    volume: VolumeInstance,
    together: Together,
    ray: Ray,
    ways: array<LightWay, LIGHT_WAYS>,
    before: Gathered,
) -> Gathered {
    let part = 1.0 / max(together.alpha, 1e-30);
    var sample = Sample(together.colour * part, vec3f(0.0), together.along * part, together.each * part, 1.0);
    sample.thinned = thinning(volume, sample.colour);
    var colour = sample.colour;
    if ANY_LIT {
        sample.place = way.start + way.direction * sample.along;
        colour = source(way, volume, sample, ray, ways);
    }
    var gathered = before;
    if ANY_PEAK {
        let thin_alpha = absorbed(together.depth * sample.thinned);
        gathered.radiance += before.thin_transmittance * thin_alpha * colour;
        gathered.thin_transmittance = dimmed(before.thin_transmittance, thin_alpha);
    } else {
        gathered.radiance += before.transmittance * together.alpha * colour;
    }
    gathered.transmittance = dimmed(before.transmittance, together.alpha);
    return gathered;
}

// The segments from `first` to `end`, or as far as anything is seen; answers where that is.
fn run(
    way: Way,
    volume: VolumeInstance,
    first: f32,
    end: f32,
    ray: Ray,
    ways: array<LightWay, LIGHT_WAYS>,
    gathered: ptr<function, Gathered>,
) -> f32 {
    var done = first;
    var back: Voxel;
    if way.integrated {
        back = voxel_at(way.index, way.start + way.direction * (done * volume.step));
    }
    loop {
        if done >= end {
            break;
        }
        var together = Together();
        var until_together = end;
        let seen = max(left_of(*gathered), LEAST_SEEN);
        // On to a sample that absorbs, and a few more where light is scattered often: to look it up costs most, and all lanes are
        // to have something to look up.
        loop {
            until_together = select(until_together, min(end, done + floor(TOGETHER / seen)), together.depth == 0.0);
            together = segment(way, volume, done, together, &back);
            done += 1.0;
            let is_enough = way.alone || together.depth * seen > DEPTH_TOGETHER || done >= until_together;
            if !ANY_LIT || done >= end || (together.depth > 0.0 && is_enough) {
                break;
            }
        }
        *gathered = show(way, volume, together, ray, ways, *gathered);
        if left_of(*gathered) <= volume.least_transmittance {
            break;
        }
    }
    return done;
}

// The turn of a volume; answers how many of its segments are done then. `work` counts what loops go through, which is bounded where a ray
// is cast in parts.
fn take_turn(
    turn: Turn,
    march: March,
    volume: VolumeInstance,
    ray: Ray,
    work: ptr<function, u32>,
    gathered: ptr<function, Gathered>,
) -> f32 {
    let way = way_of(turn.index, volume, ray, march.enter, march.leave);
    var ways: array<LightWay, LIGHT_WAYS>;
    for (var i = 0u; i < LIGHTS; i += 1u) {
        ways[i] = light_way(first_sweep(turn.index) + i, way.start, way.direction);
    }
    // Segments before the next volume's turn comes: no more than there are, and at least one, whatever rounding says.
    var done = march.done;
    let last = min(march.count, max(done, floor((turn.until - march.enter) / volume.step)) + 1.0);
    *work += WORK_OF_TURN;
    loop {
        done = leap(way, volume, done, last, work);
        if IN_PARTS && *work > MOST_WORK {
            break;
        }
        let end = min(done + RUN, last);
        (*gathered).samples -= done;
        *work += u32(max(end - done, 0.0)) * WORK_OF_SEGMENT + WORK_OF_RUN;
        done = run(way, volume, done, end, ray, ways, gathered);
        (*gathered).samples += done;
        if done >= last || left_of(*gathered) <= volume.least_transmittance {
            break;
        }
    }
    return done;
}

// Goes on along a ray, to its end or until there is work enough for one part of it. Answers whether it is at its end.
fn advance(ray: Ray, marches: ptr<function, array<March, VOLUMES>>, gathered: ptr<function, Gathered>) -> bool {
    var work = 0u;
    var is_ended = false;
    loop {
        let turn = next_turn(*marches);
        is_ended = turn.nearest == FAR;
        if is_ended || (IN_PARTS && work > MOST_WORK) {
            break;
        }
        var volume = volumes[min(turn.index, VOLUMES - 1u)];
        volume.lighting = lighting_of(turn.index, volume.lighting);
        (*marches)[turn.index].done = take_turn(turn, (*marches)[turn.index], volume, ray, &work, gathered);
        is_ended = left_of(*gathered) <= volume.least_transmittance;
        if is_ended {
            (*gathered).transmittance = 0.0;
            break;
        }
    }
    return is_ended;
}

fn all_marches(ray: Ray, surface_distance: f32) -> array<March, VOLUMES> {
    var marches: array<March, VOLUMES>;
    for (var i = 0u; i < VOLUMES; i += 1u) {
        marches[i] = start_march(i, ray, surface_distance);
    }
    return marches;
}

fn surface_behind(position: vec2f) -> vec4f {
    return textureLoad(surface, min(vec2u(position), textureDimensions(surface) - 1u), 0);
}

// What is in the picture at the end of a ray. The last number says what is hidden of what is far away where the picture is cut out.
fn shown_of(gathered: Gathered, behind: vec4f) -> vec4f {
    let hidden = 1.0 - select(0.0, gathered.transmittance, behind.a >= FAR);
    return vec4f(gathered.radiance + gathered.transmittance * behind.rgb, select(gathered.samples, hidden, frame.cut_out == 1u));
}

@fragment
fn march(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let ray = ray_through(position.xy, frame);
    let behind = surface_behind(position.xy);
    var marches = all_marches(ray, behind.a);
    var gathered = Gathered(vec3f(0.0), 1.0, 1.0, 0.0);
    _ = advance(ray, &marches, &gathered);
    return shown_of(gathered, behind);
}
