//! Colours of files -> linear colours.

/// Linear value of one that sRGB encodes, both 0 to 1 (IEC 61966-2-1); beyond that range it goes on.
pub(in crate::sources) fn linear(encoded: f32) -> f32 {
    let magnitude = encoded.abs();
    let linear =
        if magnitude <= 0.04045 { magnitude / 12.92 } else { ((magnitude + 0.055) / 1.055).powf(2.4) };
    linear.copysign(encoded)
}

/// Linear colour and opacity of an sRGB-encoded colour with linear opacity.
pub(in crate::sources) fn linear_colour([red, green, blue, opacity]: [f32; 4]) -> [f32; 4] {
    [linear(red), linear(green), linear(blue), opacity]
}

/// Makes colours as a file writes them, 0 to 1 or 0 to 255, linear colours from 0 to 1. Answers whether they went beyond 1.
///
/// Vertex colours come from cameras and painting programs, hence are sRGB-encoded, in numbers as in bytes: what MeshLab, F3D and trimesh
/// show unchanged. Colours with a component that is not finite are NaN afterwards: not given.
pub(in crate::sources) fn decode_vertex_colours(colours: &mut [[f32; 4]]) -> bool {
    let greatest = colours.iter().flatten().copied().filter(|value| value.is_finite()).fold(0.0, f32::max);
    let is_of_bytes = greatest > 1.0;
    let scale = if is_of_bytes { 1.0 / 255.0 } else { 1.0 };
    for colour in colours {
        *colour = if colour.iter().all(|value| value.is_finite()) {
            linear_colour(colour.map(|value| (value * scale).clamp(0.0, 1.0)))
        } else {
            [f32::NAN; 4]
        };
    }
    is_of_bytes
}
