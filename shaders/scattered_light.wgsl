// Light that a volume scatters for the first time and does not let out, cell by cell: what then diffuses.
//
// What comes into a cell through three of its faces and does not leave through the others is lost there. What of it is not absorbed is scattered;
// the share of that which escapes is seen as light that was scattered once, and the rest goes on to be scattered again. Two cells see the same
// light at the face between them. So nothing is counted twice, and all that is lost of the light is absorbed, seen, or diffuses.
//
// reads  light cells, what escapes, the light volume, the shadow of meshes
// writes rgba32float: power, for a light of irradiance 1, in squares of the unit of the network

#import level
#import peak
#import leaning
#import light_volumes
#import shadows

struct Source {
    // In which light travels: along the axes of the volume, of unit length.
    travels: vec3f,
    // Mean cosine of scattering.
    g: f32,
    // What each axis counts: 1, or 0 for those left out.
    axes: vec3f,
    // Beside the peak: the share that goes straight on or back, and the mean cosine of the rest.
    lobe: f32,
    g_even: f32,
    // Share of scattered light that leaves its way to the eye.
    aside: f32,
}

@group(0) @binding(1) var<uniform> source: Source;
@group(0) @binding(2) var light_cells: texture_3d<f32>;
@group(0) @binding(3) var<storage, read> escape: array<vec4f>;
@group(0) @binding(4) var power_out: texture_storage_3d<rgba32float, write>;

// By how much what escapes falls along a beam, per optical depth: twice the cosine with a plane surface, near it.
const FALL = 3.0;

// The optical depth of a beam through a cell, as a multiple of what it would be if the medium filled the cell evenly, is at most this.
const MOST_OF_MEAN = 4.0;

// The share that escapes of what a beam scatters in a cell, where `lost` is the optical depth of T' and `falls` that of what escapes: light and
// what escapes of it are strong at the same end of a thick cell, or at opposite ones.
fn escaping(mean: f32, lost: f32, falls: f32) -> f32 {
    let x = clamp(lost, 0.0, 80.0);
    let y = clamp(falls, -20.0, 80.0);
    return clamp(mean * lessening(x + y) / (lessening(x) * lessening(y)), 0.0, 1.0);
}

// Of light that is scattered straight on or back, the share that escapes. `depth` is the optical depth of all light as far as the cell, `raw`
// that of the cell, of which the beam counts the share `beam` and what escapes the share `eye`.
fn escaping_straight(centre: vec3f, depth: f32, raw: f32, beam: f32, eye: f32) -> f32 {
    let lost = clamp(raw * beam, 0.0, 80.0);
    if source.g < 0.0 {
        return exp(-depth * eye) * lessening(2.0 * lost) / lessening(lost);
    }
    let pace = source.travels / (level.edges * vec3f(level.cells));
    let safe = select(pace, vec3f(1e-30), abs(pace) < vec3f(1e-30));
    let walls = max((select(vec3f(0.0), vec3f(1.0), pace > vec3f(0.0)) - centre) / safe, vec3f(0.0));
    let ends = select(vec3f(1e30), walls, abs(pace) > vec3f(1e-30));
    let out = centre + pace * min(ends.x, min(ends.y, ends.z));
    let whole = max(light_depth(0u, out) - depth, 0.0) * eye;
    // The deeper in the cell, the less of the beam is left, and the less of the cell is before what it scatters.
    let opposed = clamp(raw * (beam - eye), 0.0, 80.0);
    return min(exp(-whole) * lessening(opposed) / lessening(lost), 1.0);
}

// T' at a face of a cell: side 0 is that with the lower coordinate along the axis, 1 the other. The mean of four places: fewer show as dots
// where light grazes a surface.
fn arriving(cell: vec3u, axis: u32, side: u32, albedo: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var which = 0u; which < 4u; which += 1u) {
        let flat = vec3f(0.25 + 0.5 * f32(which & 1u), 0.25 + 0.5 * f32(which >> 1u), f32(side));
        let at = select(select(flat, flat.yzx, axis == 1u), flat.zxy, axis == 0u);
        let place = (vec3f(cell) + at) / vec3f(level.cells);
        let light = light_seen(0u, place) * exp(-light_depth(0u, place));
        if LEANS {
            sum += 0.25 * beam_of(light, albedo, source.g);
        } else {
            sum += vec3f(0.25 * light);
        }
    }
    return sum;
}

@compute @workgroup_size(64)
fn light_up(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= count_of(level.cells) {
        return;
    }
    let cell = cell_of(index, level.cells);
    let medium = textureLoad(light_cells, cell, 0);
    // What light sees of each face.
    let areas = volume_of() / level.edges * abs(source.travels) * source.axes;
    var coming = vec3f(0.0);
    // The mean of what comes, by what comes.
    var brightness = 0.0;
    var leaving = vec3f(0.0);
    for (var axis = 0u; axis < 3u; axis += 1u) {
        // (A loop of one turn, since software adapters run both sides of every `if`: most cells are empty, and light along an axis comes
        // in at one face.)
        var is_lit = medium.a > 0.0 && areas[axis] > 1e-6 * volume_of();
        loop {
            if !is_lit {
                break;
            }
            let enters = select(1u, 0u, source.travels[axis] > 0.0);
            let enters_here = arriving(cell, axis, enters, medium.rgb);
            coming += areas[axis] * enters_here;
            brightness += areas[axis] * dot(enters_here, enters_here);
            leaving += areas[axis] * arriving(cell, axis, 1u - enters, medium.rgb);
            is_lit = false;
        }
    }
    let area = areas.x + areas.y + areas.z;
    let extinction = beam_extinction(medium.rgb, source.g);
    let thickness = min(medium.a * level.unit * volume_of() / max(area, 1e-30), 1e9);
    // No more than the cell can take, wherever in it the medium is: between columns of light its depth is interpolated.
    let most = coming * (1.0 - exp(-MOST_OF_MEAN * thickness * extinction));
    let lost = clamp(coming - leaving, vec3f(0.0), most);

    // Through the cell from the face that light comes in at.
    let ways = level.edges / max(abs(source.travels) * source.axes, vec3f(1e-12));
    let raw = min(medium.a * level.unit * min(ways.x, min(ways.y, ways.z)), 1e9);
    let beam = mean_beam_extinction(medium.rgb, source.g);
    let eye = mean_extinction(medium.rgb, source.aside);
    let found = escape[index];
    let escapes = vec4f(found.xyz, min(found.w, 1.0));
    let towards = clamp(dot(source.travels, escapes.xyz) / max(escapes.w, 1e-20), -1.0, 1.0);
    let leaning = escapes.w + 3.0 * source.g_even * dot(source.travels, escapes.xyz);
    var out = escaping(leaning, raw * beam, -FALL * towards * raw * eye);
    if LEANS {
        let centre = (vec3f(cell) + 0.5) / vec3f(level.cells);
        let before = -log(clamp(brightness / max(dot(coming, vec3f(1.0)), 1e-30), 1e-30, 1.0)) / max(beam, 1e-6);
        out = mix(out, escaping_straight(centre, before, raw, beam, eye), source.lobe);
    }
    let scattered = medium.rgb * beside_peak(source.g) / max(extinction, vec3f(1e-6));
    textureStore(power_out, cell, vec4f((1.0 - out) * scattered * lost, 0.0));
}
