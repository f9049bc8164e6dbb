//! Speed against accuracy of light in volumes: `cargo bench --bench volumes`.
//!
//! A ball and a cloud are drawn as the reference pictures of the truth show them and compared with those: `TYNDALL_DATA` names a folder
//! beside which `truth/images` lies. Errors are over the pixels that show the volume, relative to the mean of the reference there:
//! as the picture is, after the best factor for each channel (all that can be asked of a local model, which knows no irradiance), and the
//! error of the mean. Times are those of the wall: what a light that turned adds to a frame, and a frame of 512 x 512 in which nothing changed.
//!
//! `-- --quick` leaves most resolutions out; `-- --lighting 'LightVolume(cone_angle: 80.0)'` draws just that, with the truth's `g` put in;
//! `-- --pictures FOLDER` writes each picture beside its reference and the difference, times 3.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench may panic")]

use bevy_app::App;
use bevy_ecs::prelude::*;
use glam::{DVec3, UVec2, Vec3};
use std::path::{Path, PathBuf};
use std::time::Instant;
use tyndall::components::DirectionalLight;
use tyndall::gpu::{Gpu, GpuOptions};
use tyndall::render::{self, Pixels};
use tyndall::report::Report;
use tyndall::{Picture, TyndallPlugins};

/// Pixels of a reference along each side, and rays through each of them along each axis.
const SIDE: usize = 128;
const RAYS: usize = 4;

/// The reference adds up to more where it shows the volume.
const SHOWN: f64 = 2e-4;

/// Repetitions of each time; the least counts.
const REPETITIONS: usize = 3;

/// The passes that make the light of a volume.
const LIGHT_PASSES: [&str; 6] =
    ["light_volume", "light_cells", "light_network", "scattered_light", "summed_light", "eye_light"];

/// A picture of the truth and what it shows.
struct Subject {
    name: &'static str,
    file: &'static str,
    voxels: usize,
    /// Length of the sides of the volume.
    extent: f64,
    sigma_t: f64,
    albedo: [f64; 3],
    g: f64,
    /// In which light travels.
    direction: Vec3,
    /// Share of `sigma_t` around a place, in a cube of the given side.
    density: fn(DVec3, f64) -> f64,
}

fn subjects() -> [Subject; 2] {
    [
        Subject {
            name: "ball",
            file: "sphere_g00",
            voxels: 128,
            extent: 2.1,
            sigma_t: 8.0,
            albedo: [0.99, 0.9, 0.6],
            g: 0.0,
            direction: Vec3::NEG_X,
            density: |place, side| ((1.0 - place.length()) / side + 0.5).clamp(0.0, 1.0),
        },
        Subject {
            name: "cloud",
            file: "grid",
            voxels: 64,
            extent: 2.0,
            sigma_t: 12.0,
            albedo: [0.95, 0.85, 0.6],
            g: 0.3,
            direction: Vec3::new(-2.0, -1.0, -1.0),
            density: |place, _| cloud(place),
        },
    ]
}

/// The recipe of the truth's README.
fn cloud(place: DVec3) -> f64 {
    let DVec3 { x, y, z } = place;
    let bell = |t: f64| (-t * t).exp();
    let shell = bell((place.length() - 0.62) / 0.10);
    let core = (-place.distance_squared(DVec3::new(0.20, -0.10, 0.15)) / (2.0 * 0.16 * 0.16)).exp();
    let wave = 0.5 + 0.5 * (9.0 * x + 2.0 * (5.0 * y).sin()).sin() * (7.0 * z - 1.0).cos();
    let border = ((0.98 - place.abs().max_element()) / 0.1).clamp(0.0, 1.0);
    (0.75 * shell * wave + core) * border
}

fn lightings(g: f64, quick: bool, only: Option<&String>) -> Vec<String> {
    if let Some(only) = only {
        return vec![only.replace("(", &format!("(g: {g:?}, "))];
    }
    let mut all = vec!["EmissionAbsorption".to_owned(), "Gradient()".to_owned()];
    let resolutions: &[f64] = if quick { &[1.0] } else { &[1.0, 0.5, 0.25, 0.125] };
    for name in ["SingleScattering", "LightVolume"] {
        all.extend(
            resolutions.iter().map(|resolution| format!("{name}(g: {g:?}, resolution: {resolution:?})")),
        );
    }
    if g > 0.0 {
        all.push(format!("LightVolume(g: {g:?}, towards_eye: true)"));
    }
    all
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let quick = arguments.iter().any(|argument| argument == "--quick");
    let after = |name: &str| arguments.iter().skip_while(|argument| *argument != name).nth(1);
    let only = after("--lighting");
    let pictures = after("--pictures").map(PathBuf::from);
    let Some(data) = std::env::var_os("TYNDALL_DATA").map(PathBuf::from) else {
        println!("TYNDALL_DATA is not set: without the truth's pictures there is nothing to compare with");
        return;
    };
    let truth = data.parent().unwrap_or(&data).join("truth").join("images");
    let folder = tempfile::tempdir().unwrap();
    for subject in subjects() {
        let path = truth.join(format!("{}_mean.npy", subject.file));
        let Ok(bytes) = std::fs::read(&path) else {
            println!("{}: there is no {}", subject.name, path.display());
            continue;
        };
        let bench = Bench::new(folder.path(), &subject);
        let lightings = lightings(subject.g, quick, only);
        measure(bench, &subject, &lightings, &reference(&bytes), pictures.as_deref());
    }
}

fn measure(
    mut bench: Bench,
    subject: &Subject,
    lightings: &[String],
    reference: &[DVec3],
    pictures: Option<&Path>,
) {
    println!("\n{}, {} voxels along each side\n", subject.name, subject.voxels);
    println!(
        "| lighting | error | of red | green | blue | after the best factors | mean | light turned | static frame | bytes a voxel |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for lighting in lightings {
        let seen = bench.show(lighting);
        let error = compare(&seen, reference);
        let (still, turned) = bench.times();
        let bytes = bench.light_bytes() as f64 / subject.voxels.pow(3) as f64;
        let percent = |value: f64| format!("{:.1} %", 100.0 * value);
        let [r, g, b] = error.channels.to_array().map(percent);
        println!(
            "| `{lighting}` | {} | {r} | {g} | {b} | {} | {:+.1} % | {turned:.1} ms | {still:.1} ms | {bytes:.2} |",
            percent(error.whole),
            percent(error.fitted),
            100.0 * error.mean,
        );
        if let Some(folder) = pictures {
            let name = lighting.split([':', '(', ')', ',', ' ']).collect::<Vec<_>>().join("");
            write(&folder.join(format!("{}_{name}.png", subject.file)), &seen, reference);
        }
    }
}

/// How far a picture is from its reference.
struct Error {
    whole: f64,
    channels: DVec3,
    /// With each channel multiplied by what makes it best.
    fitted: f64,
    /// Of the mean.
    mean: f64,
}

fn compare(seen: &[DVec3], reference: &[DVec3]) -> Error {
    let shown = seen.iter().zip(reference).filter(|(_, reference)| reference.element_sum() > SHOWN);
    let pairs: Vec<(DVec3, DVec3)> = shown.map(|(seen, reference)| (*seen, *reference)).collect();
    let mean = |value: &dyn Fn(&(DVec3, DVec3)) -> DVec3| {
        pairs.iter().map(value).sum::<DVec3>() / pairs.len() as f64
    };
    let (ours, theirs) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
    let wrong = |factors: DVec3| mean(&|(seen, reference)| (factors * seen - reference).powf(2.0));
    let factors = mean(&|(seen, reference)| seen * reference) / mean(&|(seen, _)| seen * seen);
    let whole = |squares: DVec3| (squares.element_sum() / 3.0).sqrt() / (theirs.element_sum() / 3.0);
    Error {
        whole: whole(wrong(DVec3::ONE)),
        channels: wrong(DVec3::ONE).powf(0.5) / theirs,
        fitted: whole(wrong(factors)),
        mean: ours.element_sum() / theirs.element_sum() - 1.0,
    }
}

/// The pixels of a numpy array of 32-bit floats, [row, column, channel].
fn reference(bytes: &[u8]) -> Vec<DVec3> {
    let head = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let pixels: Vec<DVec3> = bytes[head..]
        .chunks_exact(12)
        .map(bytemuck::pod_read_unaligned::<[f32; 3]>)
        .map(|pixel| Vec3::from(pixel).as_dvec3())
        .collect();
    assert_eq!(pixels.len(), SIDE * SIDE);
    pixels
}

/// A picture, its reference and their difference times 3, brightened alike.
fn write(path: &Path, seen: &[DVec3], reference: &[DVec3]) {
    let brightest = reference.iter().map(|pixel| pixel.max_element()).fold(0.0, f64::max);
    let shown = |value: DVec3| {
        let encoded = (value / brightest).clamp(DVec3::ZERO, DVec3::ONE).powf(1.0 / 2.2);
        image::Rgb((255.0 * encoded).round().as_u8vec3().to_array())
    };
    let picture = image::RgbImage::from_fn(3 * SIDE as u32, SIDE as u32, |x, y| {
        let (panel, at) = (x as usize / SIDE, y as usize * SIDE + x as usize % SIDE);
        match panel {
            0 => shown(seen[at]),
            1 => shown(reference[at]),
            _ => shown(3.0 * (seen[at] - reference[at]).abs()),
        }
    });
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    picture.save(path).unwrap();
}

struct Bench {
    app: App,
    folder: PathBuf,
    scene: String,
    direction: Vec3,
}

impl Bench {
    fn new(folder: &Path, subject: &Subject) -> Self {
        let Subject { file, voxels, extent, sigma_t, albedo, direction, .. } = subject;
        let side = extent / *voxels as f64;
        let centre = |index: usize| (index as f64 + 0.5) * side - extent / 2.0;
        let mut bytes = Vec::new();
        for (z, y, x) in
            (0..*voxels).flat_map(|z| (0..*voxels).flat_map(move |y| (0..*voxels).map(move |x| (z, y, x))))
        {
            let place = DVec3::new(centre(x), centre(y), centre(z));
            bytes.extend(((subject.density)(place, side) as f32).to_le_bytes());
        }
        std::fs::write(folder.join(format!("{file}.raw")), bytes).unwrap();
        // Opacity is linear between points, extinction is to be: over a millionth of the mean free path the two agree.
        let length = 1e-6 / sigma_t;
        let opacity = -(-1e-6_f64).exp_m1();
        let [r, g, b] = albedo;
        let Vec3 { x, y, z } = direction;
        let scene = format!(
            "(entities: {{
                \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 10.0), projection: Orthographic(height: 2.4)) ),
                \"light\": ( DirectionalLight: (direction: ({x:?}, {y:?}, {z:?})) ),
                \"volume\": (
                    Volume: Raw(path: \"{file}.raw\", size: ({voxels}, {voxels}, {voxels}), format: F32, spacing: ({side:.12}, {side:.12}, {side:.12})),
                    TransferFunction: (
                        domain: (0.0, 1.0),
                        points: [(0.0, ({r:?}, {g:?}, {b:?}), 0.0), (1.0, ({r:?}, {g:?}, {b:?}), {opacity:.17})],
                        opacity_length: {length:.17},
                    ),
                    VolumeLighting: LIGHTING,
                    RayCast: (step: 0.5, early_termination: 0.9999),
                ) }})"
        );
        let mut app = App::new();
        app.add_plugins(TyndallPlugins)
            .insert_resource(pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap());
        let size = UVec2::splat((SIDE * RAYS) as u32);
        app.insert_resource(Picture { size, encoded: false, ..Default::default() });
        Self { app, folder: folder.to_owned(), scene, direction: *direction }
    }

    /// The pixels with a lighting, each the mean of its rays.
    fn show(&mut self, lighting: &str) -> Vec<DVec3> {
        let path = self.folder.join("scene.ron");
        std::fs::write(&path, self.scene.replace("LIGHTING", lighting)).unwrap();
        let document = render::load_scene(&mut self.app, &path, &[]);
        assert!(!document.has_errors(), "{:#?}", document.problems);
        let Pixels::Radiance(rays) = render::render(&mut self.app).unwrap().pixels else {
            unreachable!("radiance was asked for")
        };
        let mut pixels = vec![DVec3::ZERO; SIDE * SIDE];
        for (index, ray) in rays.into_iter().enumerate() {
            let (x, y) = (index % (SIDE * RAYS) / RAYS, index / (SIDE * RAYS) / RAYS);
            pixels[y * SIDE + x] += Vec3::from(ray).as_dvec3() / (RAYS * RAYS) as f64;
        }
        pixels
    }

    /// The least milliseconds of a frame in which nothing changed, and of the light after it turned.
    fn times(&mut self) -> (f64, f64) {
        let least = |times: Vec<f64>| times.into_iter().fold(f64::INFINITY, f64::min);
        let still = least((1..REPETITIONS).map(|_| self.frame(self.direction)).collect());
        // In a small picture the light is most of it, and what else there is goes off again.
        let size =
            std::mem::replace(&mut self.app.world_mut().resource_mut::<Picture>().size, UVec2::splat(8));
        let small = least((0..REPETITIONS).map(|_| self.frame(self.direction)).collect());
        let turned = |index: usize| self.direction + Vec3::new(0.0, 0.01 * index as f32, 0.0);
        let directions: Vec<Vec3> = (1..=REPETITIONS).map(turned).collect();
        let turned = least(directions.into_iter().map(|direction| self.frame(direction)).collect());
        self.frame(self.direction);
        self.app.world_mut().resource_mut::<Picture>().size = size;
        (still, (turned - small).max(0.0))
    }

    /// Milliseconds of a frame with light of some direction.
    fn frame(&mut self, direction: Vec3) -> f64 {
        let world = self.app.world_mut();
        let mut light = world.query::<&mut DirectionalLight>().single_mut(world).unwrap();
        light.set_if_neq(DirectionalLight { direction, ..Default::default() });
        let started = Instant::now();
        self.app.update();
        self.app.world().resource::<Gpu>().wait("drawing").unwrap();
        started.elapsed().as_secs_f64() * 1e3
    }

    fn light_bytes(&self) -> u64 {
        let held = &self.app.world().resource::<Report>().gpu_bytes;
        LIGHT_PASSES.iter().filter_map(|name| held.get(name)).sum()
    }
}
