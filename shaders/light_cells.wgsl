// The medium of a volume in cells as coarse as scattered light is: mean extinction, and the albedo of all that scatters.
//
// reads  volume texture, lookup table, brick distances
// writes rgba32float: albedo, sigma_t per scene unit

#import classified

// Colour and sigma_t per scene unit.
fn classified_at(place: vec3f) -> vec4f {
    if brick_distance(place) > 0.0 {
        return vec4f(0.0);
    }
    let voxel = voxel_in(place);
    let at = entry_of(voxel);
    let below = clamp(floor(at), 0.0, classified.last - 1.0);
    let found = mix(entry(u32(below)), entry(u32(below) + 1u), at - below);
    return vec4f(found.rgb * voxel.tint, found.a * voxel.shown);
}

struct Cells {
    // Cells along each axis.
    count: vec3u,
    // Samples in a cell along each axis.
    samples: vec3u,
}

@group(0) @binding(4) var<uniform> cells: Cells;
@group(0) @binding(5) var light_cells: texture_storage_3d<rgba32float, write>;

@compute @workgroup_size(64)
fn average(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let count = cells.count;
    if index >= count.x * count.y * count.z {
        return;
    }
    let cell = vec3u(index % count.x, (index / count.x) % count.y, index / (count.x * count.y));
    let samples = cells.samples.x * cells.samples.y * cells.samples.z;
    var scattered = vec3f(0.0);
    var sigma_t = 0.0;
    for (var i = 0u; i < samples; i += 1u) {
        let which = vec3u(i % cells.samples.x, (i / cells.samples.x) % cells.samples.y, i / (cells.samples.x * cells.samples.y));
        let at = (vec3f(cell) + (vec3f(which) + 0.5) / vec3f(cells.samples)) / vec3f(count);
        let found = classified_at(at);
        // Each divided at once, so that the sum of large extinctions stays within 32 bits.
        let share = found.a / f32(samples);
        scattered += clamp(found.rgb, vec3f(0.0), vec3f(1.0)) * share;
        sigma_t += share;
    }
    let albedo = select(vec3f(0.0), scattered / sigma_t, sigma_t > 0.0);
    textureStore(light_cells, cell, vec4f(min(albedo, vec3f(1.0)), sigma_t));
}
