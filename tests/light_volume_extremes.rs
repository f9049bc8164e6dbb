//! Media, shapes, lights and data far from anything that is: every pixel is a number, none is below 0, and no light comes from nowhere.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use glam::DVec3;
use std::collections::HashSet;
use std::f64::consts::PI;
use support::Studio;
use tyndall::optics::peak::Peak;
use tyndall_needs::needs;

/// A scene of one volume in parts, each of which a case can replace.
#[derive(Clone)]
struct Case {
    name: String,
    head: &'static str,
    eye: &'static str,
    lights: String,
    transform: String,
    file: String,
    size: [u32; 3],
    spacing: String,
    function: String,
    lighting: String,
    /// What no pixel may be brighter than.
    bound: f64,
}

const WHITE: &str = "points: [(0.0, (1.0, 1.0, 1.0), 0.3)]";

/// Deep in a white medium its fluence comes to 5 times an irradiance from above; radiance is that over 4 pi, of which the two streams and
/// their blend may be off by a fifth. Light that leans to one side by the mean cosine `g` adds the greatest of the phase function, and
/// what is scattered often may lean with three times its flux.
fn bound(g: f64) -> f64 {
    let peak = (1.0 + g.abs()) / (4.0 * PI * (1.0 - g.abs()).powi(2));
    let direct = if g == 0.0 { 0.0 } else { peak };
    1.2 * 5.0 / (4.0 * PI) * (1.0 + 3.0 * g.abs()) + direct
}

fn sun(direction: &str) -> String {
    format!("\"sun\": ( DirectionalLight: (direction: {direction}) ),")
}

impl Case {
    fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            head: "",
            eye: "",
            lights: sun("(-0.5, -0.6, -0.7)"),
            transform: String::new(),
            file: file_of([8; 3]),
            size: [8, 8, 8],
            spacing: "(1.0, 1.0, 1.0)".into(),
            function: WHITE.into(),
            lighting: "LightVolume()".into(),
            bound: bound(0.0),
        }
    }

    fn scene(&self) -> String {
        let Self { head, eye, lights, transform, file, size: [x, y, z], spacing, function, lighting, .. } =
            self;
        format!(
            "({head} entities: {{ {eye} {lights} \"v\": ( {transform} Volume: Raw(path: \"{file}\", size: ({x}, {y}, {z}), format: F32, spacing: {spacing}),
                TransferFunction: (domain: (0.0, 1.0), {function}), VolumeLighting: {lighting}, RayCast: (early_termination: 1.0) ) }})"
        )
    }
}

/// Both lightings, with a mean cosine and a resolution.
fn lightings(g: f64, resolution: f64) -> [String; 2] {
    [
        format!("SingleScattering(g: {g:?}, resolution: {resolution:?})"),
        format!("LightVolume(g: {g:?}, resolution: {resolution:?})"),
    ]
}

/// The file of an even volume.
fn file_of(size: [u32; 3]) -> String {
    if size == [8; 3] { "even.raw".into() } else { format!("{size:?}.raw") }
}

fn check(cases: &[Case]) {
    let mut studio = Studio::new();
    studio.volume("even.raw", [8; 3], |_| 0.5);
    let checkered = |[x, y, z]: [usize; 3]| if (x + y + z) % 2 == 0 { 0.0 } else { 1.0 };
    studio.volume("checkered.raw", [8; 3], checkered);
    studio.volume("odd.raw", [8; 3], |[x, y, z]| match (x + 2 * y + 3 * z) % 5 {
        0 => f32::NAN,
        1 => f32::INFINITY,
        2 => f32::NEG_INFINITY,
        3 => 1e30,
        _ => 0.5,
    });
    studio.volume("nothing.raw", [8; 3], |_| f32::NAN);
    let sizes: HashSet<_> = cases.iter().map(|case| case.size).filter(|size| *size != [8; 3]).collect();
    for size in sizes {
        studio.volume(&file_of(size), size.map(|side| side as usize), |_| 0.5);
    }
    let mut complaints = Vec::new();
    let mut brightest = (0.0, String::new());
    for case in cases {
        let pixels = studio.radiance(&case.scene(), 9, 7);
        let odd = pixels.iter().flatten().filter(|value| !(value.is_finite() && **value >= 0.0)).count();
        let most = pixels.iter().flatten().fold(0.0, |most: f64, value| most.max(f64::from(*value)));
        if odd > 0 {
            complaints.push(format!("{}: {odd} of {} values are odd", case.name, 3 * pixels.len()));
        } else if most > case.bound {
            complaints.push(format!("{}: {most} is more than {}", case.name, case.bound));
        }
        if most / case.bound > brightest.0 && case.bound.is_finite() {
            brightest = (most / case.bound, case.name.clone());
        }
    }
    eprintln!("brightest pixel: {brightest:?} of its bound");
    assert!(complaints.is_empty(), "{} of {}:\n{}", complaints.len(), cases.len(), complaints.join("\n"));
}

#[needs(gpu)]
#[test]
fn any_medium_gives_numbers() {
    let mut cases = Vec::new();
    for g in [-0.999, -0.5, 0.0, 0.5, 0.999] {
        for opacity in [0.0, 1e-6, 0.3, 1.0] {
            for length in [1e-6, 1.0, 1e6] {
                for lighting in lightings(g, 1.0) {
                    cases.push(Case {
                        function: format!(
                            "points: [(0.0, (1.0, 1.0, 1.0), {opacity:?})], opacity_length: {length:?}"
                        ),
                        bound: bound(g),
                        lighting: lighting.clone(),
                        ..Case::new(format!("{lighting}, opacity {opacity} over {length} mm"))
                    });
                }
            }
        }
    }
    let functions = [
        ("black", "points: [(0.0, (0.0, 0.0, 0.0), 0.5)]"),
        ("brighter than white", "points: [(0.0, (1e6, 3.0, 1.0), 0.5)]"),
        (
            "of great extinction",
            "points: [(0.0, (1.0, 1.0, 1.0), 0.0)], iso: [(value: 0.5, width: 0.1, color: (1.0, 1.0, 1.0), absorption: 1e6)], opacity_length: 1e-6",
        ),
        (
            "from nothing to all",
            "points: [(0.0, (1.0, 1.0, 1.0), 0.0), (0.5, (1.0, 1.0, 1.0), 0.0), (0.5, (1.0, 1.0, 1.0), 1.0)], opacity_length: 1e-6",
        ),
        ("of two entries", "entries: 2, points: [(0.0, (1.0, 1.0, 1.0), 0.0), (1.0, (1.0, 1.0, 1.0), 1.0)]"),
        (
            "voxel by voxel",
            "points: [(0.0, (1.0, 1.0, 1.0), 0.0), (1.0, (1.0, 1.0, 1.0), 1.0)], classification: Pre",
        ),
        (
            "of surfaces",
            "iso: [(value: 0.3, width: 0.0, color: (1.0, 1.0, 1.0), absorption: 1e3)], entries: 64, classification: PreIntegrated",
        ),
    ];
    for (name, function) in functions {
        for file in ["even.raw", "checkered.raw", "odd.raw", "nothing.raw"] {
            // In hollows between white walls light may gather.
            let bound = if file == "even.raw" { bound(0.0) } else { 20.0 };
            for lighting in lightings(0.0, 1.0) {
                let case = Case::new(format!("{lighting}, {file} {name}"));
                cases.push(Case { file: file.into(), lighting, function: function.into(), bound, ..case });
            }
        }
    }
    cases.sort_by_key(|case| [case.function.contains("Pre"), case.lighting.starts_with("Light")]);
    check(&cases);
}

#[needs(gpu)]
#[test]
fn any_shape_gives_numbers() {
    let mut cases = Vec::new();
    let lights = ["(-0.5, -0.6, -0.7)", "(1.0, 0.0, 0.0)", "(0.0, 1e-4, -1.0)"];
    for size in [[1, 1, 1], [1, 1, 8], [8, 1, 1], [1, 8, 8], [2, 3, 5], [8, 8, 8]] {
        for resolution in [1.0, 0.125] {
            for light in lights {
                let name = format!("{size:?} at {resolution} in {light}");
                let lighting = format!("LightVolume(resolution: {resolution:?}, g: 0.5)");
                cases.push(Case {
                    file: file_of(size),
                    size,
                    lights: sun(light),
                    lighting,
                    bound: bound(0.5),
                    ..Case::new(name)
                });
            }
        }
    }
    for light in lights {
        let name = format!("a long one in {light}");
        let file = file_of([2048, 1, 1]);
        cases.push(Case { file, size: [2048, 1, 1], lights: sun(light), ..Case::new(name) });
        for spacing in ["(1.0, 1.0, 1000.0)", "(1.0, 1000.0, 1.0)", "(1000.0, 1.0, 0.1)", "(1e-3, 1.0, 1.0)"]
        {
            let name = format!("spacing {spacing} in {light}");
            let lighting = "LightVolume(g: 0.5)".into();
            cases.push(Case {
                spacing: spacing.into(),
                lighting,
                lights: sun(light),
                bound: bound(0.5),
                ..Case::new(name)
            });
        }
    }
    for head in ["", "millimetres_per_unit: 1e-6,", "millimetres_per_unit: 1e6,"] {
        for scale in ["1e-6", "1.0", "1e6", "(1e-6, 1.0, 1e6)", "(-1.0, 1.0, 1.0)"] {
            for length in ["1e-6", "1.0", "1e6"] {
                cases.push(Case {
                    head,
                    transform: format!("Transform: (scale: {scale}, rotation: (10.0, 20.0, 30.0)),"),
                    function: format!("{WHITE}, opacity_length: {length}"),
                    ..Case::new(format!("{head} scale {scale}, opacity over {length}"))
                });
            }
        }
    }
    check(&cases);
}

#[needs(gpu)]
#[test]
fn light_from_anywhere_gives_numbers() {
    const INSIDE: &str = "\"eye\": ( ViewCamera: (eye: (0.5, 1.0, 1.5), target: (-1.0, 0.0, 0.0)) ),";
    const ON_A_FACE: &str = "\"eye\": ( ViewCamera: (eye: (0.0, 0.0, 4.0), target: (0.5, 0.2, 0.0)) ),";
    let mut cases = Vec::new();
    for eye in ["", INSIDE, ON_A_FACE] {
        for corner in 0..27 {
            let [x, y, z] = [corner % 3 - 1, corner / 3 % 3 - 1, corner / 9 - 1];
            if [x, y, z] == [0; 3] {
                continue;
            }
            for lighting in
                ["SingleScattering()", "LightVolume()", "LightVolume(blend: false, cone_angle: 89.0)"]
            {
                let lights = sun(&format!("({x}.0, {y}.0, {z}.0)"));
                let name = format!("{lighting} along {x} {y} {z}, {eye}");
                cases.push(Case { eye, lights, lighting: lighting.into(), ..Case::new(name) });
            }
        }
        for direction in
            ["(1.0, 1e-7, 0.0)", "(1.0, 1e-20, 1e-30)", "(0.0, -1e30, 1.0)", "(1.0, 1.0000001, 1.0)"]
        {
            let lights = sun(direction);
            cases.push(Case { eye, lights, ..Case::new(format!("along {direction}, {eye}")) });
        }
    }
    for lighting in ["SingleScattering(g: 0.5)", "LightVolume(g: 0.5, gradient_specular: 1.0, emission: 1.0)"]
    {
        for irradiance in ["0.0", "1e-30", "1e6"] {
            let lights = format!(
                "\"sun\": ( DirectionalLight: (direction: (1.0, 2.0, 3.0), irradiance: ({irradiance}, {irradiance}, 0.0)) ),"
            );
            let name = format!("{lighting} of {irradiance}");
            let file = "checkered.raw".into();
            cases.push(Case { file, lights, lighting: lighting.into(), bound: 1e7, ..Case::new(name) });
        }
        for count in [0, 8] {
            let light = |index| {
                format!(
                    "\"{index}\": ( DirectionalLight: (direction: ({index}.0, -3.0, -1.0), irradiance: (0.1, 0.1, 0.1)) ),"
                )
            };
            let lights = (0..count).map(light).collect();
            let name = format!("{lighting} of {count} lights");
            cases.push(Case {
                lights,
                lighting: lighting.into(),
                bound: 1.0 + bound(0.5),
                ..Case::new(name)
            });
        }
    }
    cases.sort_by_key(|case| case.lighting.starts_with("Light"));
    check(&cases);
}

/// A box of one white medium about the origin.
struct Furnace {
    size: [u32; 3],
    sigma: f64,
    /// Direction of travel.
    light: DVec3,
    lighting: String,
}

/// Directions all around, each standing for the same solid angle; and so many where these say that more comes back than was sent.
const VIEWS: u32 = 24;
const MANY_VIEWS: u32 = 240;

/// More than this is more than was sent.
const EXCESS: f64 = 0.003;

impl Furnace {
    fn half(&self) -> DVec3 {
        DVec3::from(self.size.map(f64::from)) / 2.0
    }

    /// What a direction sees of the box.
    fn projected_area(&self, direction: DVec3) -> f64 {
        let size = 2.0 * self.half();
        direction.abs().dot(DVec3::new(size.y * size.z, size.z * size.x, size.x * size.y))
    }

    /// The share of the light that goes straight through.
    fn straight(&self) -> f64 {
        const SIDE: u32 = 100;
        let half = self.half();
        let (mut through, mut all) = (0.0, 0.0);
        for axis in (0..3).filter(|axis| self.light[*axis] != 0.0) {
            let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
            for i in 0..SIDE * SIDE {
                let share = |index: u32| 2.0 * (f64::from(index) + 0.5) / f64::from(SIDE) - 1.0;
                let mut place = DVec3::ZERO;
                place[axis] = -half[axis].copysign(self.light[axis]);
                place[b] = half[b] * share(i % SIDE);
                place[c] = half[c] * share(i / SIDE);
                let walls = (half.copysign(self.light) - place) / self.light;
                let length =
                    DVec3::select(self.light.cmpeq(DVec3::ZERO), DVec3::INFINITY, walls).min_element();
                let weight = self.light[axis].abs() * half[b] * half[c];
                through += weight * (-self.sigma * length).exp();
                all += weight;
            }
        }
        through / all
    }

    /// Scattered flux that leaves the box, as a share of all that it receives.
    fn scattered(&self, studio: &mut Studio, views: u32) -> f64 {
        const PIXELS: u32 = 24;
        let [x, y, z] = self.size;
        studio.volume("furnace.raw", self.size.map(|side| side as usize), |_| 0.5);
        // Over a hundredth of a millimetre: an opacity of 1 within rounding would lose how much it is.
        let opacity = -(-self.sigma / 100.0).exp_m1();
        let DVec3 { x: lx, y: ly, z: lz } = self.light;
        let height = 2.02 * self.half().length();
        let mut flux = 0.0;
        for view in 0..views {
            // Fibonacci's sphere, turned out of symmetry with the box.
            let up = 1.0 - (2.0 * f64::from(view) + 1.0) / f64::from(views);
            let around = 2.399_963_229_728_653 * f64::from(view) + 0.3;
            let across = (1.0 - up * up).sqrt();
            let eye = DVec3::new(across * around.cos(), up, across * around.sin()) * 3.0 * height;
            let DVec3 { x: ex, y: ey, z: ez } = eye;
            let seen = studio.radiance(
                &format!(
                    "(entities: {{ \"eye\": ( ViewCamera: (eye: ({ex:?}, {ey:?}, {ez:?}), up: (0.6, 0.1, 0.8), projection: Orthographic(height: {height:?})) ),
                        \"sun\": ( DirectionalLight: (direction: ({lx:?}, {ly:?}, {lz:?})) ),
                        \"v\": ( Volume: Raw(path: \"furnace.raw\", size: ({x}, {y}, {z}), format: F32),
                            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), {opacity:.17})], opacity_length: 0.01),
                            VolumeLighting: {}, RayCast: (step: {:?}, early_termination: 1.0) ) }})",
                    self.lighting,
                    (0.1 / self.sigma).min(0.25)
                ),
                PIXELS,
                PIXELS,
            );
            let mean = seen.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>() / f64::from(PIXELS * PIXELS);
            flux += mean * height * height * 4.0 * PI / f64::from(views);
        }
        flux / self.projected_area(self.light)
    }
}

/// White cubes and slabs, thin and thick, return what they receive and no more, to 0.3 %. Where light goes on towards the eye, what spreads over the sides
/// of the box is lost.
#[needs(gpu)]
#[test]
fn white_media_never_return_more_than_they_receive() {
    let mut studio = Studio::new();
    let mut all = Vec::new();
    for size in [[24, 24, 4], [12, 12, 12]] {
        for light in [DVec3::NEG_Z, DVec3::new(-0.7, 0.0, -0.7), DVec3::new(-0.5, -0.6, -0.7)] {
            for sigma in [0.05, 0.5, 5.0] {
                for (g, towards_eye) in [(0.0, false), (-0.4, false), (0.4, false), (0.4, true), (0.8, true)]
                {
                    let lighting = format!("LightVolume(g: {g:?}, towards_eye: {towards_eye})");
                    let furnace =
                        Furnace { size, sigma, light: light.normalize(), lighting: lighting.clone() };
                    // What is scattered into a peak goes on with the light.
                    let peak = sigma * Peak::new(g).extinction(1.0);
                    let straight = Furnace { sigma: peak, lighting: String::new(), ..furnace }.straight();
                    let mut scattered = furnace.scattered(&mut studio, VIEWS);
                    if scattered + straight - 1.0 >= EXCESS {
                        // Few views alone are off by half a percent.
                        scattered = furnace.scattered(&mut studio, MANY_VIEWS);
                    }
                    let excess = scattered + straight - 1.0;
                    let name =
                        format!("{size:?} sigma {sigma} {lighting} in {light}: {scattered:.4} scattered");
                    eprintln!("{name}: {:+.1} %", 100.0 * excess);
                    all.push((towards_eye, excess, name));
                }
            }
        }
    }
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    for (towards_eye, floor) in [(false, -0.07), (true, -0.22)] {
        let of_kind: Vec<_> = all.iter().filter(|case| case.0 == towards_eye).collect();
        let [least, .., worst] = of_kind[..] else { panic!("no cases") };
        eprintln!("from {least:?} to {worst:?}");
        assert!(worst.1 < EXCESS, "{worst:?}");
        assert!(least.1 > floor, "{least:?}");
    }
}
