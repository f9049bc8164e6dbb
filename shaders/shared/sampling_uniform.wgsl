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

fn disc_of(x_o: vec3f, index: u32) -> Disc {
    var reach = 1e9;
    // None at a point that is nowhere; see sampling_adaptive.
    let candidates = select(0u, estimator.candidates, abs(x_o.z) < 1e30);
    if !ALL_CANDIDATES {
        // The distance within which as many candidates lie as are wanted, by bisection.
        var low = 0.0;
        reach = 4.0;
        for (var step = 0u; step < 24u; step += 1u) {
            let middle = (low + reach) / 2.0;
            var count = 0u;
            for (var i = 0u; i < candidates; i += 1u) {
                count += select(0u, 1u, candidate_distance(x_o, i) <= middle);
            }
            if count > estimator.samples {
                reach = middle;
            } else {
                low = middle;
            }
        }
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
