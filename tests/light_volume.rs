//! The light that arrives in volumes and is scattered there, against values that are known exactly.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;

use support::{Studio, middle};
use tyndall::optics::diffusion::Slab;
use tyndall::optics::peak::Peak;
use tyndall::optics::phase::henyey_greenstein;
use tyndall_needs::needs;

/// A slab 1 mm thick and so wide that its sides do not count, across z, lit from above.
fn slab(studio: &Studio, voxels: usize, tau: f64, albedo: f64, lighting: &str) -> String {
    studio.volume("slab.raw", [4, 4, voxels], |_| 0.5);
    // Over a hundredth of the thickness: an opacity of 1 within rounding would lose how thick the slab is.
    let opacity = -(-tau / 100.0).exp_m1();
    format!(
        "\"slab\": (
            Volume: Raw(path: \"slab.raw\", size: (4, 4, {voxels}), format: F32, spacing: (500.0, 500.0, {:?})),
            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, ({albedo:?}, {albedo:?}, {albedo:?}), {opacity:.17})], opacity_length: 0.01),
            VolumeLighting: {lighting},
            RayCast: (step: 0.25, early_termination: 1.0),
        ),",
        1.0 / voxels as f64
    )
}

/// A camera that looks against a direction of travel, onto the middle of the slab.
fn eye(direction: [f64; 3]) -> String {
    let [x, y, z] = direction.map(|part| part * 50.0);
    format!(
        "\"eye\": ( ViewCamera: (eye: ({x:?}, {y:?}, {z:?}), up: (0.6, 0.8, 0.0), projection: Orthographic(height: 0.01)) ),"
    )
}

#[needs(gpu)]
#[test]
fn light_scattered_once_leaves_slabs_as_the_closed_form_says() {
    let cases: serde_json::Value =
        serde_json::from_str(include_str!("truth/single_scatter_radiance.json")).unwrap();
    let mut studio = Studio::new();
    let mut worst = (0.0, String::new());
    for case in cases["cases"].as_array().unwrap() {
        let number = |name: &str| case[name].as_f64().unwrap();
        let (mu0, mu, phi) = (number("mu0"), number("mu"), number("dphi"));
        let (sine0, sine) = ((1.0 - mu0 * mu0).sqrt(), (1.0 - mu * mu).sqrt());
        let slab = slab(
            &studio,
            128,
            number("tau"),
            number("albedo"),
            &format!("SingleScattering(g: {:?})", number("g").clamp(-0.999, 0.999)),
        );
        for (name, side) in [("L_reflected", 1.0), ("L_transmitted", -1.0)] {
            let scene = format!(
                "(entities: {{ {} {slab} \"light\": ( DirectionalLight: (direction: ({sine0:?}, 0.0, {:?})) ) }})",
                eye([sine * phi.cos(), sine * phi.sin(), side * mu]),
                -mu0
            );
            let seen = f64::from(middle(&studio.radiance(&scene, 1, 1))[0]);
            // Less than 1e-30 is next to nothing for 32 bits.
            let error = (seen - number(name)).abs() / number(name).max(1e-30);
            if error > worst.0 {
                worst = (error, format!("{} {name}: {seen}, expected {}", case["id"], number(name)));
            }
        }
    }
    eprintln!("worst relative error: {worst:?}");
    assert!(worst.0 < 0.01, "{worst:?}");
}

/// A box of one medium, turned and stretched, with light from an edge: what arrives at each place is known.
struct Block {
    size: [f64; 3],
    sigma: f64,
    to_light: [f64; 3],
    to_eye: [f64; 3],
}

impl Block {
    /// The way from a place inside to the surface.
    fn way_out(&self, place: [f64; 3], direction: [f64; 3]) -> f64 {
        let along = |axis: usize| {
            let half = self.size[axis] / 2.0;
            if direction[axis] == 0.0 {
                f64::INFINITY
            } else {
                (half.copysign(direction[axis]) - place[axis]) / direction[axis]
            }
        };
        (0..3).map(along).fold(f64::INFINITY, f64::min).max(0.0)
    }

    /// Radiance of the ray through a point that lies in front of the block.
    fn radiance(&self, through: [f64; 3]) -> f64 {
        const STEPS: usize = 20_000;
        let at = |t: f64| [0, 1, 2].map(|axis| through[axis] - self.to_eye[axis] * t);
        let inside = |place: [f64; 3]| (0..3).all(|axis| place[axis].abs() <= self.size[axis] / 2.0);
        let length: f64 = 4.0 * self.size.iter().sum::<f64>();
        let step = length / STEPS as f64;
        let places = (0..STEPS).map(|index| at((index as f64 + 0.5) * step)).filter(|place| inside(*place));
        let here = |place| {
            (-self.sigma * (self.way_out(place, self.to_light) + self.way_out(place, self.to_eye))).exp()
        };
        places.map(here).sum::<f64>() * step * self.sigma / (4.0 * std::f64::consts::PI)
    }
}

#[needs(gpu)]
#[test]
fn light_in_a_block_is_exact_to_its_edges_at_every_resolution() {
    let mut studio = Studio::new();
    let unit = |v: [f64; 3]| v.map(|part| part / v.iter().map(|part| part * part).sum::<f64>().sqrt());
    let directions = [
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 0.0],
        [1.0, -1.0, 0.0],
        [-0.3, 0.2, -0.9],
        [0.02, 0.03, 1.0],
        [-1.0, 0.9, 0.89],
    ];
    studio.volume("block.raw", [16, 12, 5], |_| 0.5);
    let mut worst = (0.0, String::new());
    for to_light in directions.map(unit) {
        let block = Block { size: [4.0, 3.0, 5.0], sigma: 0.6, to_light, to_eye: unit([0.5, 0.3, 1.0]) };
        for resolution in [1.0, 0.3, 0.125] {
            let [x, y, z] = to_light.map(|part| -part);
            let [ex, ey, ez] = block.to_eye.map(|part| part * 20.0);
            let scene = format!(
                "(entities: {{ \"eye\": ( ViewCamera: (eye: ({ex:?}, {ey:?}, {ez:?}), projection: Orthographic(height: 7.0)) ),
                    \"light\": ( DirectionalLight: (direction: ({x:?}, {y:?}, {z:?})) ),
                    \"block\": (
                        Volume: Raw(path: \"block.raw\", size: (16, 12, 5), format: F32, spacing: (0.25, 0.25, 1.0)),
                        TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), {:?})], opacity_length: 1.0),
                        VolumeLighting: SingleScattering(resolution: {resolution:?}), RayCast: (step: 0.2, early_termination: 1.0) ) }})",
                -(-block.sigma).exp_m1()
            );
            let (width, height) = (33, 33);
            let seen = studio.radiance(&scene, width, height);
            let right = unit([block.to_eye[2], 0.0, -block.to_eye[0]]);
            let [a, b] = [block.to_eye, right];
            let up = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            let brightest = seen.iter().map(|pixel| pixel[0]).fold(0.0, f32::max);
            for (index, pixel) in seen.iter().enumerate() {
                let across = 7.0 * ((index % 33) as f64 + 0.5 - 16.5) / 33.0;
                let above = 7.0 * (16.5 - (index / 33) as f64 - 0.5) / 33.0;
                let through =
                    [0, 1, 2].map(|axis| right[axis] * across + up[axis] * above + block.to_eye[axis] * 12.0);
                let error = (f64::from(pixel[0]) - block.radiance(through)).abs() / f64::from(brightest);
                if error > worst.0 {
                    worst = (
                        error,
                        format!(
                            "{to_light:?}, resolution {resolution}, pixel {index}: {pixel:?}, {}",
                            block.radiance(through)
                        ),
                    );
                }
            }
        }
    }
    eprintln!("worst error, as a share of the brightest pixel: {worst:?}");
    assert!(worst.0 < 4e-3, "{worst:?}");
}

/// Nodes and weights of Gauss and Legendre on 0..1.
const GAUSS: [(f64, f64); 6] = [
    (0.033_765_242_898_423_99, 0.085_662_246_189_585_18),
    (0.169_395_306_766_867_75, 0.180_380_786_524_069_3),
    (0.380_690_406_958_401_56, 0.233_956_967_286_345_5),
    (0.619_309_593_041_598_4, 0.233_956_967_286_345_5),
    (0.830_604_693_233_132_2, 0.180_380_786_524_069_3),
    (0.966_234_757_101_576, 0.085_662_246_189_585_18),
];

#[needs(gpu)]
#[test]
fn slabs_reflect_and_transmit_what_they_should() {
    let cases: serde_json::Value = serde_json::from_str(include_str!("truth/slab.json")).unwrap();
    let mut studio = Studio::new();
    let mut rows = Vec::new();
    let both = cases["cases"].as_array().unwrap().iter().flat_map(|case| [(case, false), (case, true)]);
    for (case, towards_eye) in both {
        let number = |name: &str| case[name].as_f64().unwrap();
        let (tau, albedo, mu0) = (number("tau"), number("albedo"), number("mu0"));
        // A peak forwards wants more directions than these; `optics::diffusion` is tested with it.
        let can_go_on = number("g") > 0.0 && mu0 == 1.0;
        if ![0.5, 2.0, 10.0].contains(&tau)
            || albedo < 0.5
            || number("g") > 0.5
            || (towards_eye && !can_go_on)
        {
            continue;
        }
        let sine0 = (1.0 - mu0 * mu0).sqrt();
        let lighting = format!("LightVolume(g: {:?}, towards_eye: {towards_eye})", number("g"));
        let slab = slab(&studio, 64, tau, albedo, &lighting);
        let mut fluxes = [0.0; 2];
        for (flux, side) in fluxes.iter_mut().zip([1.0, -1.0]) {
            for (mu, weight) in GAUSS {
                let sine = (1.0 - mu * mu).sqrt();
                let turns = if mu0 == 1.0 { 1 } else { 4 };
                for turn in 0..turns {
                    let phi = std::f64::consts::PI * (f64::from(turn) + 0.5) / f64::from(turns);
                    let scene = format!(
                        "(entities: {{ {} {slab} \"light\": ( DirectionalLight: (direction: ({sine0:?}, 0.0, {:?})) ) }})",
                        eye([sine * phi.cos(), sine * phi.sin(), side * mu]),
                        -mu0
                    );
                    let seen = f64::from(middle(&studio.radiance(&scene, 1, 1))[0]);
                    *flux += std::f64::consts::TAU * weight * mu * seen / f64::from(turns) / mu0;
                }
            }
        }
        // What is scattered into the peak goes on with the beam, which no eye beside it sees.
        let thinned = Peak::new(number("g")).extinction(albedo);
        fluxes[1] += (-thinned * tau / mu0).exp() - (-tau / mu0).exp();
        rows.push((
            number("R"),
            number("T_scattered"),
            fluxes,
            format!("tau {tau} albedo {albedo} g {} mu0 {mu0} towards the eye {towards_eye}", number("g")),
        ));
    }
    let mean = |error: &dyn Fn(&(f64, f64, [f64; 2], String)) -> f64| {
        rows.iter().map(error).sum::<f64>() / rows.len() as f64
    };
    for (r, t, [seen_r, seen_t], name) in &rows {
        eprintln!(
            "{name}: R {seen_r:.4} of {r:.4} ({:+.1} %), T {seen_t:.4} of {t:.4} ({:+.1} %)",
            100.0 * (seen_r / r - 1.0),
            100.0 * (seen_t / t - 1.0)
        );
    }
    let errors = [mean(&|row| (row.2[0] / row.0 - 1.0).abs()), mean(&|row| (row.2[1] / row.1 - 1.0).abs())];
    eprintln!("mean relative errors of reflectance and scattered transmittance: {errors:?}");
    assert!(errors[0] < 0.06 && errors[1] < 0.1, "{errors:?}");
}

/// A ray into a slab whose layers are as thick as the cells of its scattered light.
#[needs(gpu)]
#[test]
fn light_in_a_column_is_what_its_twin_in_64_bits_says() {
    const CELLS: usize = 32;
    let mut studio = Studio::new();
    let mut worst = (0.0, String::new());
    // What stands for all directions in `light_escape`, and that little more is taken to escape.
    let cosines = [(0.295_875_854_768_068, 1.015 * 2.0 / 3.0), (0.908_248_290_463_863, 1.015 / 3.0)];
    for (tau, albedo, g, mu0) in [
        (0.5, 1.0, 0.0, 1.0),
        (3.0, 1.0, 0.0, 0.5),
        (3.0, 0.9, 0.5, 1.0),
        (3.0, 0.5, -0.5, 0.8),
        (10.0, 1.0, 0.5, 0.5),
        (40.0, 0.99, 0.0, 1.0),
    ] {
        let slab = Slab { tau, albedo, g, mu0 };
        let fluence = slab.fluence(CELLS, &cosines);
        let text = self::slab(&studio, 4 * CELLS, tau, albedo, &format!("LightVolume(g: {g:?})"));
        let peak = Peak::new(g);
        let thinned = peak.extinction(albedo);
        for (mu, side) in [(1.0, 1.0), (0.5, 1.0), (1.0, -1.0), (0.5, -1.0)] {
            let (sine0, sine) = (f64::sqrt(1.0 - mu0 * mu0), f64::sqrt(1.0 - mu * mu));
            let scene = format!(
                "(entities: {{ {} {text} \"light\": ( DirectionalLight: (direction: ({sine0:?}, 0.0, {:?})) ) }})",
                eye([0.0, sine, side * mu]),
                -mu0
            );
            let seen = f64::from(middle(&studio.radiance(&scene, 1, 1))[0]);
            // Light goes down: the cosine between it and the way to the eye.
            let phase = henyey_greenstein(-side * mu * mu0, g).min(peak.cap);
            const STEPS: usize = 6400;
            let expected: f64 = (0..STEPS)
                .map(|step| {
                    let depth = (step as f64 + 0.5) / STEPS as f64;
                    // What a cell holds is that in its middle, and linear between.
                    let at = (depth * CELLS as f64 - 0.5).clamp(0.0, CELLS as f64 - 1.0);
                    let low = (at as usize).min(CELLS - 2);
                    let found = fluence[low] + (at - low as f64) * (fluence[low + 1] - fluence[low]);
                    let beam = (-thinned * tau * depth / mu0).exp();
                    let way = if side > 0.0 { depth } else { 1.0 - depth };
                    let source = phase * beam + (1.0 - peak.share) * found / (4.0 * std::f64::consts::PI);
                    albedo * source * (-thinned * tau * way / mu).exp()
                })
                .sum::<f64>()
                * tau
                / (mu * STEPS as f64);
            let error = (seen / expected - 1.0).abs();
            // One cycle of multigrid leaves some of what is less than a thousandth of the light.
            if error > worst.0 && expected > 1e-3 {
                worst = (error, format!("{slab:?} seen at {mu} from {side}: {seen}, expected {expected}"));
            }
        }
    }
    eprintln!("worst relative error: {worst:?}");
    assert!(worst.0 < 0.005, "{worst:?}");
}

/// Optical depths of light that falls aslant through a medium whose extinction is a wave across it, as a floor behind it shows them.
fn depths_on_a_floor(studio: &mut Studio, voxels: usize) -> Vec<f64> {
    const SIGMA: f64 = 1.5;
    studio.volume("wave.raw", [voxels; 3], |[x, ..]| {
        let at = (x as f32 + 0.5) / voxels as f32;
        0.5 + 0.4 * (std::f32::consts::TAU * at).cos()
    });
    // Over a millionth of the mean free path opacity is as linear in the value as extinction is.
    let (length, opacity) = (1e-6 / SIGMA, -(-1e-6_f64).exp_m1());
    let mut seen = |shades: bool| {
        let scene = format!(
            "(volumes_shade_meshes: {shades}, entities: {{
                \"eye\": ( ViewCamera: (eye: (1.55, -1.0, 0.0), target: (1.55, -3.0, 0.0), up: (0.0, 0.0, 1.0), projection: Orthographic(height: 0.2)) ),
                \"sun\": ( DirectionalLight: (direction: (0.5, -1.0, 0.0)) ),
                \"floor\": ( Transform: (translation: (0.0, -3.0, 0.0)), Mesh: Plane(size: (9.0, 9.0)) ),
                \"wave\": (
                    Volume: Raw(path: \"wave.raw\", size: ({voxels}, {voxels}, {voxels}), format: F32, spacing: ({0:?}, {0:?}, {0:?})),
                    TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (1.0, 1.0, 1.0), 0.0), (1.0, (1.0, 1.0, 1.0), {opacity:.17})], opacity_length: {length:.17}),
                    VolumeLighting: SingleScattering() ) }})",
            1.0 / voxels as f64
        );
        studio.radiance(&scene, 15, 9)
    };
    let (dimmed, whole) = (seen(true), seen(false));
    // The middle row, by x; seen from above with z up, x goes to the left.
    (0..15)
        .rev()
        .map(|x| -(f64::from(dimmed[4 * 15 + x][0]) / f64::from(whole[4 * 15 + x][0])).ln() / SIGMA)
        .collect()
}

/// Half the voxel leaves a quarter of the error of the light that goes straight through.
#[needs(gpu)]
#[test]
fn direct_light_is_of_second_order_in_the_voxel() {
    use std::f64::consts::TAU;
    let mut studio = Studio::new();
    let exact: Vec<f64> = (0..15)
        .map(|pixel| {
            // On the floor, and where the light comes out of the volume, from 0 to 1 across it.
            let floor = 1.55 + (f64::from(pixel) - 7.0) / 45.0;
            let out = floor - 0.5 * 2.5 + 0.5;
            let wave = ((TAU * out).sin() - (TAU * (out - 0.5)).sin()) / (TAU * 0.5);
            1.25f64.sqrt() * (0.5 + 0.4 * wave)
        })
        .collect();
    let errors: Vec<f64> = [8, 16, 32]
        .into_iter()
        .map(|voxels| {
            let found = depths_on_a_floor(&mut studio, voxels);
            let squares = found.iter().zip(&exact).map(|(found, exact)| (found - exact).powi(2));
            (squares.sum::<f64>() / 15.0).sqrt()
        })
        .collect();
    eprintln!("errors with 8, 16 and 32 voxels: {errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.4).contains(&order), "order {order}: {errors:?}");
    }
}

/// Balls of 25 mm with a sharp edge, in voxels of these sizes.
const GRIDS: [([usize; 3], [f32; 3]); 3] =
    [([60, 60, 12], [1.0, 1.0, 5.0]), ([30, 30, 30], [2.0, 2.0, 2.0]), ([60, 60, 60], [1.0, 1.0, 1.0])];

fn in_ron(numbers: &[impl std::fmt::Debug]) -> String {
    format!("{numbers:?}").replace('[', "(").replace(']', ")")
}

/// A ball, as it is interpolated.
struct Ball {
    size: [usize; 3],
    spacing: [f32; 3],
}

impl Ball {
    fn value(&self, voxel: [usize; 3]) -> f32 {
        let square = |axis: usize| {
            ((voxel[axis] as f32 + 0.5 - self.size[axis] as f32 / 2.0) * self.spacing[axis]).powi(2)
        };
        (1.2 - (0..3).map(square).sum::<f32>().sqrt() / 25.0).clamp(0.0, 1.0)
    }

    /// Extinction at a place, in mm from the middle, as `FUNCTION` has it.
    fn extinction(&self, place: [f64; 3]) -> f64 {
        let at = [0, 1, 2]
            .map(|axis| place[axis] / f64::from(self.spacing[axis]) + self.size[axis] as f64 / 2.0 - 0.5);
        if (0..3).any(|axis| at[axis] < -0.5 || at[axis] > self.size[axis] as f64 - 0.5) {
            return 0.0;
        }
        let value = (0..8).map(|corner| {
            let mut weight = 1.0;
            let voxel = [0, 1, 2].map(|axis| {
                let low = at[axis].floor();
                let above = (corner >> axis) & 1;
                weight *= if above == 1 { at[axis] - low } else { 1.0 - (at[axis] - low) };
                (low + f64::from(above)).clamp(0.0, self.size[axis] as f64 - 1.0) as usize
            });
            weight * f64::from(self.value(voxel))
        });
        let opacity = ((value.sum::<f64>() - 0.45) / 0.1).clamp(0.0, 1.0) * 0.8;
        -(-opacity).ln_1p()
    }

    /// Radiance along a ray, of light that was scattered once, in mm and for an irradiance of 4 pi.
    fn radiance(&self, eye: [f64; 3], direction: [f64; 3], to_light: [f64; 3]) -> f64 {
        const STEP: f64 = 0.2;
        let along = |from: [f64; 3], direction: [f64; 3], t: f64| {
            [0, 1, 2].map(|axis| from[axis] + direction[axis] * t)
        };
        let (mut sum, mut depth) = (0.0, 0.0);
        for index in 0..400 {
            let place = along(eye, direction, 95.0 + (f64::from(index) + 0.5) * STEP);
            let here = self.extinction(place) * STEP;
            if here > 0.0 && depth < 7.0 {
                let towards =
                    |index| self.extinction(along(place, to_light, (f64::from(index) + 0.5) * STEP));
                let arrives = (-(0..280).map(towards).sum::<f64>() * STEP).exp();
                sum += (-depth - here / 2.0).exp() * here * arrives;
            }
            depth += here;
        }
        sum
    }
}

/// In thick slices and coarse voxels, cells of a light volume take several times what is left of a light.
#[needs(gpu)]
#[test]
fn light_in_dense_media_is_right_however_large_the_voxels() {
    let mut studio = Studio::new();
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|part| part * part).sum::<f64>().sqrt();
        v.map(|part| part / length)
    };
    let eye = [40.0, 60.0, 110.0];
    let (forward, to_light) = (unit(eye.map(|part| -part)), unit([0.3, 1.0, 1.0]));
    let up = unit([0, 1, 2].map(|axis| f64::from(u8::from(axis == 1)) - forward[1] * forward[axis]));
    for (size, spacing) in GRIDS {
        let ball = Ball { size, spacing };
        studio.volume("ball.raw", size, |voxel| ball.value(voxel));
        let mut seen = |lighting: &str| {
            let scene = format!(
                "(entities: {{ \"eye\": ( ViewCamera: (eye: (40.0, 60.0, 110.0)) ),
                    \"sun\": ( DirectionalLight: (direction: (-0.3, -1.0, -1.0), irradiance: (3.0, 3.0, 3.0)) ),
                    \"v\": ( Volume: Raw(path: \"ball.raw\", size: {0}, format: F32, spacing: {1}), VolumeLighting: {lighting},
                        RayCast: (step: {2}, early_termination: 0.9995),
                        TransferFunction: (opacity_length: 1.0, domain: (0.0, 1.0), points: [(0.0, (0.9, 0.9, 0.9), 0.0), (0.45, (0.9, 0.9, 0.9), 0.0),
                            (0.55, (0.9, 0.9, 0.9), 0.8), (1.0, (0.9, 0.9, 0.9), 0.8)]) ) }})",
                in_ron(&size),
                in_ron(&spacing),
                0.1 / spacing[0]
            );
            studio.radiance(&scene, 1, 64).iter().map(|pixel| f64::from(pixel[0])).collect::<Vec<_>>()
        };
        let found = seen("SingleScattering()");
        let exact: Vec<f64> = (0..64)
            .map(|row| {
                let height = (1.0 - 2.0 * (f64::from(row) + 0.5) / 64.0) * 22.5f64.to_radians().tan();
                let direction = unit([0, 1, 2].map(|axis| forward[axis] + height * up[axis]));
                ball.radiance(eye, direction, to_light) * 0.9 * 3.0 / (4.0 * std::f64::consts::PI)
            })
            .collect();
        // Not at the rim, which one grid or the other draws a little too wide.
        let lit: Vec<usize> = (0..64).filter(|row| exact[*row] > 0.02).collect();
        let lit = &lit[2..lit.len() - 2];
        let mean = lit.iter().map(|row| exact[*row]).sum::<f64>() / lit.len() as f64;
        let bias = lit.iter().map(|row| found[*row] - exact[*row]).sum::<f64>() / lit.len() as f64 / mean;
        let squares =
            lit.iter().map(|row| (found[*row] - exact[*row]).powi(2)).sum::<f64>() / lit.len() as f64;
        let error = squares.sqrt() / mean;
        eprintln!(
            "voxels of {spacing:?} mm: {bias:+.4} in the mean, {error:.4} in a pixel, {} pixels",
            lit.len()
        );
        assert!(bias.abs() < 0.02 && error < 0.03, "voxels of {spacing:?} mm: {bias}, {error}");
    }
}
