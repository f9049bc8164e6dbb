//! What translucent meshes send out, through the whole pipeline, against the models in 64 bits.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod support;
#[path = "support/translucent.rs"]
mod translucent;

use glam::DVec3;
use serde_json::Value;
use std::f64::consts::PI;
use support::Studio;
use translucent::{custom, from_above, look, mean, plate_with_hole, spread, sun};
use tyndall::optics::calibration::{Calibration, calibration, directional_reflectance};
use tyndall::optics::dipole::{DirectionalDipole, Entry, Exit, StandardDipole};
use tyndall::optics::fresnel::{refract, transmittance};
use tyndall::optics::medium::Medium;
use tyndall::optics::moments::Boundary;
use tyndall_needs::needs;

/// A half space that truth knows the reflectance of.
struct HalfSpace {
    id: String,
    medium: Medium,
    degrees: f64,
    truth: Value,
}

impl HalfSpace {
    /// The length over which its light dies out; of a white one, over which all but little of it has left.
    fn reach(&self) -> f64 {
        let diffusion = self.medium.diffusion();
        let white = 200.0 / diffusion.sigma_t_prime;
        if diffusion.mu > 0.0 { diffusion.mu.recip().min(white) } else { white }
    }

    /// What can be rendered at once.
    fn key(&self) -> [f64; 3] {
        [self.medium.eta, self.medium.g, self.degrees]
    }
}

fn half_spaces() -> Vec<HalfSpace> {
    let file: Value = serde_json::from_str(include_str!("truth/rd_semi_infinite.json")).unwrap();
    let case = |truth: &Value| {
        let number = |name: &str| truth[name].as_f64().unwrap();
        let [sigma_a, sigma_s, g, eta] = ["sigma_a", "sigma_s", "g", "eta"].map(number);
        HalfSpace {
            id: format!(
                "{} {}",
                truth["material"].as_str().unwrap(),
                truth["channel"].as_str().unwrap_or("-")
            ),
            medium: Medium { sigma_a, sigma_s, g, eta },
            degrees: number("angle_deg"),
            truth: truth.clone(),
        }
    };
    let mut all: Vec<HalfSpace> = file["cases"].as_array().unwrap().iter().map(case).collect();
    all.sort_by(|a, b| (a.key(), a.reach()).partial_cmp(&(b.key(), b.reach())).unwrap());
    all
}

/// Up to three half spaces at a time, of one index, phase function and angle, and of similar reach.
fn packed(all: &[HalfSpace]) -> Vec<&[HalfSpace]> {
    let mut packs = Vec::new();
    let mut rest = all;
    while let Some(first) = rest.first() {
        let fits = |other: &&HalfSpace| other.key() == first.key() && other.reach() < 8.0 * first.reach();
        let count = rest.iter().take(3).take_while(fits).count();
        packs.push(&rest[..count]);
        rest = &rest[count..];
    }
    packs
}

/// What share of the light a slab sends back, per channel, and how much that varies from pixel to pixel.
fn reflectance(studio: &mut Studio, pack: &[HalfSpace], model: &str, maps: &str) -> ([f64; 3], [f64; 3]) {
    let media = [0, 1, 2].map(|c| pack[c.min(pack.len() - 1)].medium);
    let (eta, degrees) = (media[0].eta, pack[0].degrees);
    let side = 80.0 * pack.iter().map(HalfSpace::reach).fold(0.0, f64::max);
    let scene = format!(
        "(entities: {{ {} {} \"slab\": ( Mesh: Plane(size: ({side:?}, {side:?})),
            Subsurface: (material: {}, model: {model}), ScatteringMaps: (progressive: false, {maps}) ) }})",
        from_above(side, 0.4 * side),
        sun(degrees),
        custom(&media),
    );
    let pixels = studio.radiance(&scene, 48, 48);
    look("slab-plane", &pixels, 48);
    // Of the radiance along the normal T(eta, 1) M_o to the exitance 4 pi C_phi(1/eta) M_o, over what arrives.
    let exitance = 4.0 * PI * Boundary::exact(eta).c_phi_inverse / transmittance(1.0, eta);
    (mean(&pixels).map(|radiance| exitance * radiance / degrees.to_radians().cos()), spread(&pixels))
}

/// Compares all half spaces with one model's truth, in the mean of the pixels, and bounds how much they vary.
fn compare(model: &str, truth: &str, tolerance: f64, maps: &str) {
    let mut studio = Studio::new();
    let all = half_spaces();
    assert_eq!(all.len(), 81);
    let mut misses = Vec::new();
    for pack in packed(&all) {
        let (found, noise) = reflectance(&mut studio, pack, model, maps);
        for (c, half_space) in pack.iter().enumerate() {
            let expected = half_space.truth[truth].as_f64().unwrap();
            let error = found[c] / expected - 1.0;
            let HalfSpace { id, medium, degrees, .. } = half_space;
            let line = format!(
                "{model} {id} g {} eta {} {degrees}°: {:.5}, {truth} is {expected:.5}: {:+.2} % (pixels vary by {:.1} %)",
                medium.g,
                medium.eta,
                found[c],
                100.0 * error,
                100.0 * noise[c]
            );
            println!("{line}");
            // With the default samples. Where the light grazes, discs across it are long ellipses on the slab.
            let most_noise = if *degrees > 45.0 { 0.12 } else { 0.005 };
            if error.is_nan() || error.abs() > tolerance || noise[c] > most_noise {
                misses.push(line);
            }
        }
    }
    assert!(misses.is_empty(), "{} beyond {} %:\n{}", misses.len(), 100.0 * tolerance, misses.join("\n"));
}

#[needs(gpu)]
#[test]
fn a_slab_reflects_what_the_directional_dipole_says() {
    compare("DirectionalDipole", "directional_clamped", 0.01, "");
}

#[needs(gpu)]
#[test]
fn a_slab_reflects_what_a_half_space_really_does() {
    compare("CalibratedDipole", "exact", 0.01, "");
}

#[needs(gpu)]
#[test]
fn a_slab_reflects_what_the_standard_dipole_says() {
    compare("StandardDipole", "std_dipole", 0.005, "");
}

/// Compares slabs in light from near the horizon with the plane integral of the model in 64 bits.
fn compare_grazing(angles: &[f64]) {
    let mut studio = Studio::new();
    let mut misses = Vec::new();
    for (sigma_a, sigma_s, eta) in [(0.0041, 2.62, 1.5), (0.145, 1.79, 1.3), (0.5, 0.5, 1.0)] {
        let medium = Medium { sigma_a, sigma_s, g: 0.0, eta };
        for degrees in angles.iter().copied() {
            // No nearer to the source than the pipeline goes.
            let least_distance = medium.diffusion().d / 4.0;
            let dipole = DirectionalDipole { least_distance, ..DirectionalDipole::new(&medium) };
            let expected = directional_reflectance(&dipole, f64::to_radians(degrees).cos());
            let pack = [HalfSpace { id: String::new(), medium, degrees, truth: Value::Null }];
            let (found, noise) = reflectance(&mut studio, &pack, "DirectionalDipole", "samples: 192");
            let error = found[0] / expected - 1.0;
            let line = format!(
                "eta {eta} {degrees}°: {:.5}, expected {expected:.5}: {:+.2} % (pixels vary by {:.1} %)",
                found[0],
                100.0 * error,
                100.0 * noise[0]
            );
            println!("{line}");
            if error.is_nan() || error.abs() > 0.003 {
                misses.push(line);
            }
        }
    }
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}

#[needs(gpu)]
#[test]
fn a_slab_in_oblique_light_reflects_what_the_model_says() {
    compare_grazing(&[60.0, 75.0]);
}

#[needs(gpu)]
#[test]
fn a_slab_in_grazing_light_reflects_what_the_model_says() {
    compare_grazing(&[80.0, 85.0, 88.0]);
}

/// What leaves a point of the plane y = 0 for a thin beam on a square around the origin, as radiance along the normal.
fn beyond_a_hole(medium: &Medium, standard: bool, degrees: f64, half_width: f64, at: [f64; 2]) -> f64 {
    const STEPS: usize = 20;
    let (sin, cos) = degrees.to_radians().sin_cos();
    let to_light = DVec3::new(-sin, cos, 0.0);
    let direction = refract(to_light, DVec3::Y, medium.eta).unwrap();
    let (directional, isotropic) = (DirectionalDipole::new(medium), StandardDipole::new(medium));
    let exit = Exit { position: DVec3::new(at[0], 0.0, at[1]), normal: DVec3::Y };
    let c_phi = Boundary::exact(medium.eta).c_phi_inverse;
    let step = 2.0 * half_width / STEPS as f64;
    let mut sum = 0.0;
    for i in 0..STEPS * STEPS {
        let place = |i: usize| (i as f64 + 0.5) * step - half_width;
        let position = DVec3::new(place(i % STEPS), 0.0, place(i / STEPS));
        let s_d = match standard {
            true => isotropic.r_d(position.distance(exit.position)) / (4.0 * PI * c_phi),
            false => directional.s_d(&Entry { position, normal: DVec3::Y, direction }, &exit).max(0.0),
        };
        sum += s_d * step * step;
    }
    transmittance(1.0, medium.eta) * transmittance(cos, medium.eta) * cos * sum
}

/// Radiance around a thin beam, in rings from the edge of the hole outwards, each in three sectors: upstream, across, downstream.
fn beam(model: &str, degrees: f64, maps: &str) {
    const PIXELS: u32 = 80;
    let medium = Medium { sigma_a: 0.05, sigma_s: 0.95, g: 0.0, eta: 1.3 };
    let (side, half_width) = (16.0, 2.0);
    let mut studio = Studio::new();
    studio.file("plate.obj", plate_with_hole(8.0 * side, half_width).as_bytes());
    // The plate is behind the camera, and its hole where the beam goes through the origin.
    let shift = -4.0 * degrees.to_radians().tan();
    let scene = format!(
        "(entities: {{ {} {} \"slab\": ( Mesh: Plane(size: ({side:?}, {side:?})), Subsurface: (material: {}, model: {model}),
                ScatteringMaps: (progressive: false, {maps}) ),
            \"plate\": ( Transform: (translation: ({shift:?}, 4.0, 0.0)), Mesh: File(\"plate.obj\") ) }})",
        from_above(2.0, side),
        sun(degrees),
        custom(&[medium; 3]),
    );
    let pixels = studio.radiance(&scene, PIXELS, PIXELS);
    look(&format!("slab-beam-{model}-{degrees}"), &pixels, PIXELS);
    let mut rings = [[[0.0; 3]; 3]; 5];
    for (i, pixel) in pixels.iter().enumerate() {
        let pixel_size = side / f64::from(PIXELS);
        let place = |i: u32| (f64::from(i) + 0.5) * pixel_size - side / 2.0;
        let at = [place(i as u32 % PIXELS), place(i as u32 / PIXELS)];
        let from_edge = at[0].hypot(at[1]) - half_width * 2f64.sqrt();
        let sector = (at[0].atan2(at[1].abs()) / PI * 3.0 + 1.5) as usize;
        // Rings are one mean free path wide.
        if from_edge >= 0.0 && from_edge < rings.len() as f64 {
            let ring = &mut rings[from_edge as usize][sector.min(2)];
            ring[0] += f64::from(pixel[0]);
            ring[1] += beyond_a_hole(&medium, model == "StandardDipole", degrees, half_width, at);
            ring[2] += 1.0;
        }
    }
    let mut misses = Vec::new();
    for (distance, ring) in rings.iter().enumerate() {
        for (sector, [found, expected, count]) in ring.iter().enumerate() {
            let error = found / expected - 1.0;
            let line = format!(
                "{model} {degrees} {distance} sector {sector}: {:.3e}, expected {:.3e}: {:+.2} %",
                found / count,
                expected / count,
                100.0 * error
            );
            println!("{line}");
            if error.is_nan() || error.abs() > 0.05 {
                misses.push(line);
            }
        }
    }
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}

#[needs(gpu)]
#[test]
fn around_a_thin_beam_light_falls_off_as_the_models_say() {
    beam("DirectionalDipole", 0.0, "samples: 1024");
    beam("StandardDipole", 0.0, "samples: 1024");
    beam("DirectionalDipole", 45.0, "samples: 1024");
}

/// The radiance along z of a point of the unit sphere in light from +x.
fn of_sphere(medium: &Medium, calibrated: bool, at: DVec3) -> f64 {
    const TURNS: usize = 90;
    const RINGS: usize = 240;
    // No nearer to the source than the pipeline goes.
    let least_distance = medium.diffusion().d / 4.0;
    let dipole = DirectionalDipole { least_distance, ..DirectionalDipole::new(medium) };
    let factor = if calibrated { calibration(medium) } else { Calibration([1.0, 0.0, 0.0]) };
    let exit = Exit { position: at, normal: at };
    let (u, v) = at.any_orthonormal_pair();
    // Rings around the point, even in the logarithm of the angle to it.
    let (near, far) = (1e-4f64.ln(), PI.ln());
    let mut sum = 0.0;
    for i in 0..RINGS * TURNS {
        let step = (far - near) / RINGS as f64;
        let angle = (near + (0.5 + (i / TURNS) as f64) * step).exp();
        let turn = 2.0 * PI * (0.5 + (i % TURNS) as f64) / TURNS as f64;
        let position = angle.cos() * at + angle.sin() * (turn.cos() * u + turn.sin() * v);
        if position.x <= 0.0 {
            continue;
        }
        let area = angle.sin() * angle * step * 2.0 * PI / TURNS as f64;
        let direction = refract(DVec3::X, position, medium.eta).unwrap();
        let s_d = dipole.s_d(&Entry { position, normal: position, direction }, &exit).max(0.0);
        sum += factor.at(position.x) * transmittance(position.x, medium.eta) * position.x * s_d * area;
    }
    transmittance(at.z, medium.eta) * sum
}

/// On a curved surface, from where the light is overhead to where it does not reach.
#[needs(gpu)]
#[test]
fn a_sphere_in_light_from_the_side_shines_as_the_models_say() {
    const SIZE: u32 = 81;
    let mut studio = Studio::new();
    let media = [(0.5, 9.5), (2.0, 8.0), (0.1, 4.9)].map(|(sigma_a, sigma_s)| Medium {
        sigma_a,
        sigma_s,
        g: 0.0,
        eta: 1.3,
    });
    let mut misses = Vec::new();
    for model in ["DirectionalDipole", "CalibratedDipole"] {
        let scene = format!(
            "(entities: {{ \"eye\": ( ViewCamera: (eye: (0.0, 0.0, 4.0), projection: Orthographic(height: 2.0)) ),
                \"sun\": ( DirectionalLight: (direction: (-1.0, 0.0, 0.0)) ),
                \"ball\": ( Mesh: Sphere(subdivisions: 6), Subsurface: (material: {}, model: {model}),
                    ScatteringMaps: (progressive: false, samples: 1024) ) }})",
            custom(&media)
        );
        let pixels = studio.radiance(&scene, SIZE, SIZE);
        look("slab-sphere", &pixels, SIZE);
        for x in [34i32, 30, 20, 10, 4, 0, -4, -10, -20, -30] {
            // Patches above and below the middle, where all is alike.
            let patch: Vec<[f32; 3]> =
                [-4i32, -2, 0, 2, 4].map(|y| pixels[((40 + y) * SIZE as i32 + 40 + x) as usize]).to_vec();
            let x = f64::from(x) * 2.0 / f64::from(SIZE);
            for (c, medium) in media.iter().enumerate() {
                let point = |y: f64| DVec3::new(x, y, (1.0 - x * x - y * y).sqrt());
                let expected = [0.0, 2.0, 4.0].map(|y| {
                    of_sphere(medium, model == "CalibratedDipole", point(y * 2.0 / f64::from(SIZE)))
                });
                let expected = (expected[0] + 2.0 * expected[1] + 2.0 * expected[2]) / 5.0;
                let error = mean(&patch)[c] / expected - 1.0;
                let line = format!(
                    "{model} {c} x {x:.3}: {:.3e}, expected {expected:.3e}: {:+.2} %",
                    mean(&patch)[c],
                    100.0 * error
                );
                println!("{line}");
                // Beyond the horizon of the light, what there is comes from where it grazes.
                if error.is_nan() || error.abs() > if x > 0.2 { 0.003 } else { 0.03 } {
                    misses.push(line);
                }
            }
        }
    }
    assert!(misses.is_empty(), "{}", misses.join("\n"));
}
