// Each texel becomes the mean of the four that it covers.
//
// reads  a level of a texture
// writes the next one, of half the size

#import fullscreen

@group(0) @binding(0) var finer: texture_2d<f32>;

@fragment
fn coarsen(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let first = 2u * vec2u(pixel.xy);
    var sum = vec4f(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        sum += textureLoad(finer, first + vec2u(i & 1u, i >> 1u), 0);
    }
    return sum / 4.0;
}
