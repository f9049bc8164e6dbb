// What volumes leave of the light that a translucent mesh gets: its light G-buffer with normals as long as the share that arrives.
//
// reads  light G-buffer (normal, height), light volumes
// writes rgba32float: normal times the share of light that arrives, height

#import fullscreen
#import veils

struct LightView {
    // From texels, counted from the top left, and height to the view.
    view_from_texel: mat4x4f,
}

@group(0) @binding(0) var<uniform> light_view: LightView;
@group(0) @binding(1) var gbuffer: texture_2d<f32>;

@fragment
fn dim(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = textureLoad(gbuffer, vec2u(position.xy), 0);
    let place = (light_view.view_from_texel * vec4f(position.xy, texel.w, 1.0)).xyz;
    return vec4f(texel.xyz * through_volumes(place, 0u), texel.w);
}
