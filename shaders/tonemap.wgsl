// Radiance to what a screen shows: exposure, then the encoding of the display.
//
// reads  radiance
// writes rgba8unorm: encoded colour, and how much of the background it hides; where that is in the picture, all

#import fullscreen

struct Display {
    // 2 to the power of the exposure value.
    gain: f32,
    // One over gamma; 0 for the curve of sRGB.
    exponent: f32,
    // What the last number of the radiance is: 0 nothing that matters, 1 how much is hidden, 2 how far away it is.
    last: u32,
}

const FAR = 3.0e38;

@group(0) @binding(0) var<uniform> display: Display;
@group(0) @binding(1) var radiance: texture_2d<f32>;

@fragment
fn encode(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let found = textureLoad(radiance, vec2u(position.xy), 0);
    var hidden = 1.0;
    if display.last == 1u {
        hidden = found.a;
    } else if display.last == 2u {
        hidden = select(1.0, 0.0, found.a >= FAR);
    }
    // The colour of what is there, however much of the pixel it hides.
    let colour = found.rgb * display.gain / max(hidden, 1e-6);
    return vec4f(encoded(clamp(colour, vec3f(0.0), vec3f(1.0))), hidden);
}

fn encoded(linear: vec3f) -> vec3f {
    if display.exponent > 0.0 {
        return pow(linear, vec3f(display.exponent));
    }
    // IEC 61966-2-1.
    let bright = 1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055;
    return select(bright, 12.92 * linear, linear <= vec3f(0.0031308));
}
