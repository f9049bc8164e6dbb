// The ray caster, where rays take more work than one invocation may do: each draw goes on where the one before it stopped.
//
// reads  what `raycast` does, and how far rays are
// writes rgba32float: radiance so far, number of samples taken, or what `raycast` writes in its place; how far rays are

#import raycast

struct Part {
    // The rectangle of pixels whose rays are kept.
    corner: vec2u,
    size: vec2u,
    // Whether rays begin.
    is_first: u32,
}

@group(0) @binding(PART_BINDING) var<uniform> part: Part;
// Of the rays of all pixels: three numbers of the radiance, transmittance (less than 0 at the end of a ray), that of light in a forward peak, samples, and
// the segments done of each volume; one number of all of them after the other.
@group(0) @binding(PART_BINDING + 1) var<storage, read_write> kept: array<f32>;

const NUMBERS = 6u;

fn kept_at(number: u32, pixel: u32) -> u32 {
    return number * part.size.x * part.size.y + pixel;
}

fn load(pixel: u32, marches: ptr<function, array<March, VOLUMES>>) -> Gathered {
    for (var i = 0u; i < VOLUMES; i += 1u) {
        (*marches)[i].done = kept[kept_at(NUMBERS + i, pixel)];
    }
    return Gathered(
        vec3f(kept[kept_at(0u, pixel)], kept[kept_at(1u, pixel)], kept[kept_at(2u, pixel)]),
        kept[kept_at(3u, pixel)],
        kept[kept_at(4u, pixel)],
        kept[kept_at(5u, pixel)],
    );
}

fn store(pixel: u32, marches: array<March, VOLUMES>, gathered: Gathered) {
    for (var i = 0u; i < VOLUMES; i += 1u) {
        kept[kept_at(NUMBERS + i, pixel)] = marches[i].done;
    }
    kept[kept_at(0u, pixel)] = gathered.radiance.r;
    kept[kept_at(1u, pixel)] = gathered.radiance.g;
    kept[kept_at(2u, pixel)] = gathered.radiance.b;
    kept[kept_at(3u, pixel)] = gathered.transmittance;
    kept[kept_at(4u, pixel)] = gathered.thin_transmittance;
    kept[kept_at(5u, pixel)] = gathered.samples;
}

@fragment
fn march_on(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let at = vec2u(position.xy) - part.corner;
    let pixel = at.y * part.size.x + at.x;
    let ray = ray_through(position.xy, frame);
    let behind = surface_behind(position.xy);
    var marches = all_marches(ray, behind.a);
    var gathered = Gathered(vec3f(0.0), 1.0, 1.0, 0.0);
    if part.is_first == 0u {
        gathered = load(pixel, &marches);
    }
    if gathered.transmittance >= 0.0 {
        if advance(ray, &marches, &gathered) {
            let shown = shown_of(gathered, behind);
            gathered = Gathered(shown.rgb, -1.0, gathered.thin_transmittance, shown.a);
        }
        store(pixel, marches, gathered);
    }
    return vec4f(gathered.radiance, gathered.samples);
}
