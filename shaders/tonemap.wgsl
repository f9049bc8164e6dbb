// Radiance to what a screen shows: exposure, then the encoding of the display.
//
// reads  radiance
// writes rgba8unorm: encoded colour, opaque

#import fullscreen

struct Display {
    // 2 to the power of the exposure value.
    gain: f32,
    // One over gamma.
    exponent: f32,
}

@group(0) @binding(0) var<uniform> display: Display;
@group(0) @binding(1) var radiance: texture_2d<f32>;

@fragment
fn encode(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let linear = textureLoad(radiance, vec2u(position.xy), 0).rgb * display.gain;
    return vec4f(pow(clamp(linear, vec3f(0.0), vec3f(1.0)), vec3f(display.exponent)), 1.0);
}
