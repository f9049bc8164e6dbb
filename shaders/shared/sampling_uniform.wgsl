// The published sampling (Dal Corso, Frisvad, Mosegaard, Baerentzen 2016): one disc for all points, its points thinning out from the
// middle as e^(-sigma* r); of the candidates only those are used that are nearest to the point in space.

const PI = 3.14159265358979;

struct Disc {
    samples: u32,
    // Candidates further away than this are left out.
    reach: f32,
    x_o: vec3f,
}

// How far away a candidate is; far beyond everything where no light arrives.
fn candidate_distance(x_o: vec3f, i: u32) -> f32 {
    let offset = discs[i].xy;
    let lit = lit_at(x_o.xy + offset);
    return select(1e9, length(vec3f(offset, lit.w - x_o.z)), any(lit.xyz != vec3f(0.0)));
}

// The least distance, in 24 bits, within which more candidates lie than are wanted. Four bits are found at a time, by counting at fifteen distances
// at once: drivers end an invocation that goes through all candidates for each bit.
fn reach_of(x_o: vec3f, candidates: u32) -> f32 {
    const EDGES = vec4f(1.0, 2.0, 3.0, 4.0);
    var low = 0.0;
    var width = 4.0;
    for (var digit = 0u; digit < 6u; digit += 1u) {
        width /= 16.0;
        let a = low + width * EDGES;
        let b = low + width * (EDGES + 4.0);
        let c = low + width * (EDGES + 8.0);
        let d = low + width * (EDGES + 12.0);
        var counts = array<vec4u, 4>();
        for (var i = 0u; i < candidates; i += 1u) {
            let distance = vec4f(candidate_distance(x_o, i));
            counts[0] += vec4u(distance <= a);
            counts[1] += vec4u(distance <= b);
            counts[2] += vec4u(distance <= c);
            counts[3] += vec4u(distance <= d);
        }
        // The last edge is known from the digit before.
        let few = vec4u(counts[0] <= vec4u(estimator.samples)) + vec4u(counts[1] <= vec4u(estimator.samples))
            + vec4u(counts[2] <= vec4u(estimator.samples)) + vec4u(counts[3] <= vec4u(estimator.samples));
        low += width * f32(min(few.x + few.y + few.z + few.w, 15u));
    }
    return low + width;
}

fn disc_of(x_o: vec3f, index: u32) -> Disc {
    var reach = 1e9;
    // None at a point that is nowhere; see sampling_adaptive.
    let candidates = select(0u, estimator.candidates, abs(x_o.z) < 1e30);
    if !ALL_CANDIDATES {
        reach = reach_of(x_o, candidates);
    }
    return Disc(candidates, reach, x_o);
}

// A place on the disc, and its weight: the area that it stands for.
fn disc_sample(disc: Disc, i: u32) -> vec3f {
    let sample = discs[i].xyz;
    if ALL_CANDIDATES {
        return sample;
    }
    return vec3f(sample.xy, select(0.0, sample.z, candidate_distance(disc.x_o, i) <= disc.reach));
}
