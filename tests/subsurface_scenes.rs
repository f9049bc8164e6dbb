//! Translucent meshes in scenes: shadows, what must not change a picture, local shading and highlights.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;
#[path = "support/translucent.rs"]
mod translucent;

use glam::DVec3;
use support::{Studio, difference};
use translucent::{Pixels, from_above, grey, look, mean, sun};
use tyndall_needs::needs;

/// A medium of mean free path 0.1 mm in which light dies out over 0.2 mm.
fn medium() -> String {
    grey(0.9, 9.1, 0.0, 1.3)
}

const MAPS: &str = "ScatteringMaps: (progressive: false)";

#[needs(gpu)]
#[test]
fn a_box_in_the_light_darkens_what_lies_in_its_shadow() {
    const WIDTH: u32 = 65;
    let mut studio = Studio::new();
    // The camera is below the box, which covers the half of x < 0, so close that light on the box would be seen if it counted.
    let mut seen = |more: &str| {
        let scene = format!(
            "(entities: {{ {} {} \"slab\": ( Mesh: Plane(size: (10.0, 10.0)), Subsurface: (material: {}),
                ScatteringMaps: (progressive: false, samples: 512) ), {more} }})",
            from_above(0.04, 5.0),
            sun(0.0),
            medium()
        );
        studio.radiance(&scene, WIDTH, WIDTH)
    };
    let whole = seen("");
    let half =
        seen("\"box\": ( Mesh: Box(size: (10.0, 0.1, 20.0)), Transform: (translation: (-5.0, 0.1, 0.0)) )");
    look("slab-half", &half, WIDTH);
    let columns = |low: u32, high: u32| {
        let inside = |i: &usize| (low..high).contains(&(*i as u32 % WIDTH));
        let share = |i: usize| f64::from(half[i][1]) / f64::from(whole[i][1]);
        let shares: Vec<f64> = (0..whole.len()).filter(inside).map(share).collect();
        shares.iter().sum::<f64>() / shares.len() as f64
    };
    // 13 columns measure 1 mm, the middle of the picture is column 32.
    let (deep, edge, far) = (columns(0, 6), columns(32, 33), columns(58, 65));
    println!("{deep} {edge} {far}");
    assert!(deep < 1e-3, "far inside the shadow: {deep}");
    assert!((edge - 0.5).abs() < 0.03, "at its edge: {edge}");
    assert!((far - 1.0).abs() < 0.01, "far outside: {far}");
    let steps: Vec<f64> = (0..12).map(|i| columns(5 * i, 5 * i + 5)).collect();
    assert!(steps.windows(2).all(|pair| pair[0] <= pair[1] + 0.01), "{steps:?}");
}

/// A scene of one body that a camera of the right size looks at from the front, above.
fn of_body(body: &str, unit: f64, radius: f64, light: &str, maps: &str) -> String {
    let at = DVec3::new(0.5, 0.7, 2.0) * radius;
    format!(
        "(millimetres_per_unit: {unit:?}, entities: {{
            \"eye\": ( ViewCamera: (eye: ({:?}, {:?}, {:?}), projection: Orthographic(height: {:?})) ), {light}
            \"body\": ( {body}, Subsurface: (material: Preset(\"marble\")), ScatteringMaps: (progressive: false, {maps}) ) }})",
        at.x,
        at.y,
        at.z,
        2.4 * radius
    )
}

/// Asserts that means agree within a share.
#[track_caller]
fn agree(found: &Pixels, expected: &Pixels, tolerance: f64, what: &str) {
    let (found, expected) = (mean(found), mean(expected));
    for c in 0..3 {
        let error = found[c] / expected[c] - 1.0;
        println!("{what} {c}: {:+.3} %", 100.0 * error);
        assert!(error.abs() < tolerance, "{what}: {found:?}, expected {expected:?}");
    }
}

/// What must not change the picture of a body of some radius, given how its size is scaled.
fn invariances(name: &str, radius: f64, body: &dyn Fn(f64) -> String) {
    let mut studio = Studio::new();
    let light = sun(40.0);
    let mut draw = |unit: f64, maps: &str, size: u32| {
        let scene = of_body(&body(1.0 / unit), unit, radius / unit, &light, maps);
        studio.radiance(&scene, size, size)
    };
    let first = draw(1.0, "", 40);
    look(&format!("slab-{name}"), &first, 40);
    assert!(mean(&first)[0] > 0.01);
    agree(&draw(1.0, "samples: 96", 40), &first, 0.01, &format!("{name}: twice the samples"));
    agree(&draw(1.0, "", 80), &first, 0.01, &format!("{name}: twice the size"));
    agree(&draw(1.0, "cameras: 4", 40), &first, 0.01, &format!("{name}: fewer cameras"));
    agree(&draw(1.0, "cameras: 32", 40), &first, 0.01, &format!("{name}: more cameras"));
    for unit in [1e-3, 25.4, 1e3] {
        agree(&draw(unit, "", 40), &first, 0.01, &format!("{name}: units of {unit} mm"));
    }
}

#[needs(gpu)]
#[test]
fn a_sphere_is_as_bright_whatever_the_samples_pixels_and_units_are() {
    invariances("sphere", 10.0, &|scale| {
        format!("Mesh: Sphere(radius: {:?}, subdivisions: 4)", 10.0 * scale)
    });
}

#[needs(gpu, data)]
#[test]
fn the_bunny_is_as_bright_whatever_the_samples_pixels_and_units_are() {
    let data = std::env::var("TYNDALL_DATA").unwrap();
    invariances("bunny", 10.0, &|scale| {
        // 0.15 units wide, about (-0.017, 0.11, -0.0015).
        let size = 120.0 * scale;
        let [x, y, z] = [0.017, -0.11, 0.0015].map(|place| place * size);
        format!(
            "Mesh: File(\"{data}/meshes/stanford-bunny.obj\"), Transform: (translation: ({x:?}, {y:?}, {z:?}), scale: {size:?})"
        )
    });
}

#[needs(gpu)]
#[test]
fn lights_add_up_and_their_irradiance_is_a_factor() {
    let mut studio = Studio::new();
    let light = |name: &str, direction: &str, e: [f64; 3]| {
        format!(
            "{name:?}: ( DirectionalLight: (direction: {direction}, irradiance: ({:?}, {:?}, {:?})) ),",
            e[0], e[1], e[2]
        )
    };
    let lights = [
        light("a", "(0.0, -1.0, -1.0)", [1.0, 2.0, 0.5]),
        light("b", "(1.0, -0.2, 0.3)", [0.1, 0.0, 3.0]),
        light("c", "(-1.0, 1.0, 0.0)", [2.0, 0.3, 0.3]),
    ];
    let body = "Mesh: Sphere(radius: 5.0, subdivisions: 3)";
    let mut draw = |lights: &str| studio.radiance(&of_body(body, 1.0, 5.0, lights, ""), 24, 24);
    let singles: Vec<Pixels> = lights.iter().map(|light| draw(light)).collect();
    let together = draw(&lights.concat());
    let sums: Pixels =
        (0..together.len()).map(|i| [0, 1, 2].map(|c| singles.iter().map(|one| one[i][c]).sum())).collect();
    let brightest = sums.iter().flatten().copied().fold(0.0, f32::max);
    assert!(difference(&together, &sums) < 1e-5 * brightest, "{}", difference(&together, &sums));
    let brighter = draw(&light("a", "(0.0, -1.0, -1.0)", [4.0, 8.0, 2.0]));
    let expected: Pixels = singles[0].iter().map(|pixel| pixel.map(|value| 4.0 * value)).collect();
    assert!(difference(&brighter, &expected) < 1e-5 * brightest);
    assert_eq!(mean(&draw(&light("a", "(0.0, -1.0, -1.0)", [0.0; 3]))), [0.0; 3]);
}

const LOCAL: &str =
    "diffuse: (0.8, 0.7, 0.5), specular: (0.1, 0.2, 0.3), shininess: 20.0, ambient: (0.01, 0.0, 0.0)";

#[needs(gpu)]
#[test]
fn local_shading_is_the_phong_beside_the_medium_and_nothing_else_exists() {
    let scene = |head: &str, looks: &str| {
        format!("({head} entities: {{ {} \"ball\": ( Mesh: Sphere(subdivisions: 3), {looks} ) }})", sun(40.0))
    };
    let translucent = format!("Subsurface: (local: ({LOCAL}), specular: Some(()))");
    let mut studio = Studio::new();
    let phong = studio.radiance(&scene("", &format!("Phong: ({LOCAL})")), 32, 32);
    let local = format!("{translucent}, Shading: Local");
    // A `Phong` beside the medium plays no part.
    let beside = format!("{local}, Phong: (diffuse: (1.0, 0.0, 0.0))");
    for (head, looks) in [("", &local), ("shading: Local,", &translucent), ("", &beside)] {
        let mut studio = Studio::new();
        let pixels = studio.radiance(&scene(head, looks), 32, 32);
        assert_eq!(difference(&pixels, &phong), 0.0, "{head} {looks}");
        let report = studio.report();
        assert_eq!(report.passes.keys().copied().collect::<Vec<_>>(), ["surface", "upload_meshes"]);
        assert_eq!(report.pipelines, ["surface"]);
        assert_eq!(report.gpu_bytes.keys().copied().collect::<Vec<_>>(), ["meshes", "surface"]);
    }
    // The entity counts for more than the head.
    let own = format!("{translucent}, Shading: Scattering");
    let scattering = studio.radiance(&scene("", &translucent), 32, 32);
    assert!(difference(&scattering, &phong) > 0.01);
    assert_eq!(difference(&studio.radiance(&scene("shading: Local,", &own), 32, 32), &scattering), 0.0);
    // Back to local shading, nothing of it is held.
    studio.radiance(&scene("", &local), 32, 32);
    let held: Vec<&str> = studio.report().gpu_bytes.keys().copied().collect();
    assert_eq!(held, ["meshes", "surface"]);
}

#[needs(gpu)]
#[test]
fn a_highlight_is_added_as_blinn_and_phong_say() {
    const SIZE: u32 = 33;
    let mut studio = Studio::new();
    let (strength, shininess) = (0.7, 25.0);
    let to_light = DVec3::new(-3.0, 4.0, 0.0) / 5.0;
    let eye = DVec3::new(1.0, 2.0, 0.5);
    let mut draw = |specular: &str| {
        let scene = format!(
            "(entities: {{ \"eye\": ( ViewCamera: (eye: ({:?}, {:?}, {:?}), projection: Perspective(vertical_fov: 50.0)) ),
                \"sun\": ( DirectionalLight: (direction: (3.0, -4.0, 0.0), irradiance: (1.0, 2.0, 0.0)) ),
                \"slab\": ( Mesh: Plane(size: (20.0, 20.0)), Subsurface: (material: {}, specular: {specular}), {MAPS} ) }})",
            eye.x,
            eye.y,
            eye.z,
            medium()
        );
        studio.radiance(&scene, SIZE, SIZE)
    };
    let (without, with) =
        (draw("None"), draw(&format!("Some((strength: {strength:?}, shininess: {shininess:?}))")));
    look("slab-specular", &with, SIZE);
    let forward = -eye.normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let half = 25f64.to_radians().tan();
    let mut brightest = 0.0f64;
    for i in 0..SIZE * SIZE {
        let place = |i: u32| (2.0 * f64::from(i) + 1.0) / f64::from(SIZE) - 1.0;
        let ray = forward + half * (place(i % SIZE) * right - place(i / SIZE) * up);
        if ray.y > -0.2 {
            continue;
        }
        let half_way = (to_light - ray.normalize()).normalize();
        let expected = strength * (shininess + 8.0) / (8.0 * std::f64::consts::PI)
            * half_way.y.powf(shininess)
            * to_light.y;
        brightest = brightest.max(expected);
        let [r, g, b] = [0, 1, 2].map(|c| f64::from(with[i as usize][c] - without[i as usize][c]));
        assert!(
            (r - expected).abs() < 2e-5 && (g - 2.0 * expected).abs() < 4e-5 && b == 0.0,
            "{r} {g} {b}, expected {expected}"
        );
    }
    assert!(brightest > 0.5, "{brightest}");
}

/// So many lights that what each sends out cannot be kept apart: they share one layer, with the same result.
#[needs(gpu)]
#[test]
fn very_many_lights_share_a_layer_and_add_up_all_the_same() {
    let mut studio = Studio::new();
    // As few as so many lights get.
    studio.app.insert_resource(tyndall::LightTexels(64));
    let scene = |lights: &str| {
        format!(
            "(entities: {{ {lights} \"ball\": ( Mesh: Sphere(subdivisions: 5),
                Subsurface: (material: Custom(sigma_a: (0.1, 0.1, 0.1), sigma_s: (5.0, 5.0, 5.0))), ScatteringMaps: (samples: 8, progressive: false) ) }})"
        )
    };
    let light = |name: usize, irradiance: f32| {
        format!(
            "\"light {name}\": ( DirectionalLight: (direction: (0.3, -1.0, -1.0), irradiance: ({irradiance:?}, {irradiance:?}, 0.0)) ),"
        )
    };
    let one = studio.radiance(&scene(&light(0, 4.0)), 32, 32);
    let points = studio.report().gpu_bytes["scattered_radiosity"] / 16;
    let count = (64 << 20) / (16 * points as usize) + 1;
    let lights: String = (0..count).map(|index| light(index, 4.0 / count as f32)).collect();
    let many = studio.radiance(&scene(&lights), 32, 32);
    assert_eq!(studio.report().gpu_bytes["scattered_radiosity"] / 16, points, "one layer");
    let off = difference(&one, &many);
    assert!(off < 1e-3, "{count} lights are off by {off}");
}
