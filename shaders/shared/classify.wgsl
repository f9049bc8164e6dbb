// What becomes of a segment of a ray through a volume whose classification is not `Post`. Imported by the ray caster, which has the
// struct Lookup.

#import classifications

// What `classification_of` says of a volume; 0 is `Post`.
const PRE = 1u;
const PRE_INTEGRATED = 2u;

// Colour and extinction from classified voxels; they are kept as shares of their greatest.
fn pre_classified(index: u32, place: vec3f, greatest_colour: f32, greatest_extinction: f32) -> vec4f {
    let found = voxels_at(index, place);
    let colour = found.rgb * (greatest_colour / max(found.a, 1e-30));
    return vec4f(colour, found.a * greatest_extinction);
}

// The values at both ends of a segment. What is missing has none: then the other's goes on.
fn values_of(front: Voxel, back: Voxel) -> vec2f {
    if ANY_PARTIAL {
        return vec2f(
            select(front.texel, back.texel, front.shown == 0.0),
            select(back.texel, front.texel, back.shown == 0.0),
        );
    }
    return vec2f(front.texel, back.texel);
}

// Places of two texels in the table, in entries.
fn places_of(lookup: Lookup, texels: vec2f) -> vec2f {
    return clamp(texels * lookup.scale + lookup.offset, vec2f(0.0), vec2f(1.0)) * lookup.last;
}

// Depth of the layers that lie below a place; what else the row behind all pairs holds of an entry: the layer at or above it, that at or
// below it.
fn layers_below(index: u32, lookup: Lookup, place: f32) -> f32 {
    let below = min(floor(place), lookup.last - 1.0);
    let at = vec2u(u32(below), u32(lookup.last) + 1u);
    return mix(pair_at(index, at).x, pair_at(index, at + vec2u(1u, 0u)).x, place - below);
}

// Mean colour and optical depth of a segment that is `share` of a whole one, from what is at its ends. Colour times depth and depth are
// interpolated between entries; on the diagonal, where they have an edge, within each triangle for itself.
fn pre_integrated(index: u32, lookup: Lookup, front: Voxel, back: Voxel, share: f32) -> vec4f {
    let places = places_of(lookup, values_of(front, back));
    let below = min(floor(places), vec2f(lookup.last - 1.0));
    let part = places - below;
    let at = vec2u(below);
    let ahead = max(part - part.yx, vec2f(0.0));
    let both = select(part.x * part.y, min(part.x, part.y), at.x == at.y);
    let one = select(part * (1.0 - part.yx), ahead, at.x == at.y);
    let sum = (1.0 - both - one.x - one.y) * pair_at(index, at)
        + one.x * pair_at(index, at + vec2u(1u, 0u))
        + one.y * pair_at(index, at + vec2u(0u, 1u))
        + both * pair_at(index, at + vec2u(1u, 1u));
    var depth = sum.a;
    if share < 0.999 {
        // Layers are crossed whole in a shorter segment too.
        let layers = abs(layers_below(index, lookup, places.y) - layers_below(index, lookup, places.x));
        depth = mix(min(layers, depth), depth, share);
    }
    return vec4f(sum.rgb / max(sum.a, 1e-30), depth * (0.5 * (front.shown + back.shown)));
}

// Where in a segment its surface is, as a share of its length: at the first layer that it crosses, else in the middle.
fn surface_in(index: u32, lookup: Lookup, front: Voxel, back: Voxel) -> f32 {
    let places = places_of(lookup, values_of(front, back));
    let rising = places.y > places.x;
    let entry = select(ceil(places.x) - 1.0, floor(places.x), rising);
    let known = pair_at(index, vec2u(u32(clamp(entry, 0.0, lookup.last - 1.0)), u32(lookup.last) + 1u));
    let layer = select(known.z, known.y, rising);
    let across = places.y - places.x;
    let cell = floor(min(layer, lookup.last - 1.0));
    let is_one = layer >= 0.0 && layer <= lookup.last && across != 0.0;
    let crossed = is_one && select(cell + 1.0 > places.y, cell < places.y, rising);
    return select(0.5, clamp((layer - places.x) / across, 0.0, 1.0), crossed);
}
