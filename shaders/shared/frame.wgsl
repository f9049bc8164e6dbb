// The camera and the lights of a frame. Eye space: the camera at the origin, x right, y up, looking along -z, and what
// it looks at one unit away, so that numbers stay about 1 whatever the scale of the scene is.

struct Frame {
    // Reversed depth: 1 at the near plane, 0 at the far end.
    clip_from_eye: mat4x4f,
    // Half the width and height of the picture: tangents for a perspective camera, eye space for an orthographic one.
    half_extent: vec2f,
    picture: vec2f,
    perspective: u32,
    light_count: u32,
    // Whether pictures tell how much of the background they hide.
    cut_out: u32,
}

struct Light {
    // Unit vector from the surface to the light, in eye space.
    to_light: vec3f,
    // Irradiance on a surface that faces the light.
    irradiance: vec3f,
}

struct Ray {
    origin: vec3f,
    // Unit length, so a distance along the ray is one in eye space.
    direction: vec3f,
}

const PI = 3.14159265358979;

// Distance along a ray that meets nothing.
const FAR = 3.0e38;

// The ray through a point of the picture, given in pixels from the top left corner.
fn ray_through(pixel: vec2f, frame: Frame) -> Ray {
    let device = vec2f(2.0, -2.0) * (pixel / frame.picture) + vec2f(-1.0, 1.0);
    let across = device * frame.half_extent;
    if frame.perspective == 1u {
        return Ray(vec3f(0.0), normalize(vec3f(across, -1.0)));
    }
    return Ray(vec3f(across, 0.0), vec3f(0.0, 0.0, -1.0));
}
