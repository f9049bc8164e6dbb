//! Shaders that change while they are used.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/files.rs"]
mod files;
#[path = "support/own_shaders.rs"]
mod own_shaders;

use files::{Live, mark};
use glam::UVec2;
use own_shaders::with_own_shaders;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use tyndall::LightBudget;
use tyndall::prelude::*;
use tyndall::render::{Pixels, render_what_is_there};
use tyndall::scene::Reload;
use tyndall_needs::needs;

struct Shaders<'a> {
    folder: &'a Path,
    live: Live,
}

impl<'a> Shaders<'a> {
    fn open(folder: &'a Path, entities: &str) -> Self {
        let mut app = App::new();
        app.insert_resource(pollster::block_on(Gpu::new(&GpuOptions::default())).unwrap());
        app.insert_resource(Picture { size: UVec2::splat(9), camera: None, encoded: false });
        let eye = "\"eye\": ( ViewCamera: (eye: (0.0, 0.0, 4.0), projection: Orthographic(height: 2.2)) ),
            \"sun\": ( DirectionalLight: (direction: (0.0, 0.0, -1.0)) ),";
        let scene = files::scene(&format!("{eye} {entities}"));
        // Bytes of a fog that is the same everywhere, for scenes that have one.
        let fog = "@".repeat(512);
        let files = [("scene.ron", scene.as_str()), ("mark.ron", &mark(0.0)), ("fog.raw", &fog)];
        let live = Live::open_in(app, &files, "scene.ron");
        Self { folder, live }
    }

    /// Replaces a piece of a shader's text.
    fn edit(&self, file: &str, from: &str, to: &str) {
        let path = self.folder.join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{file}: {from}");
        fs::write(&path, text.replacen(from, to, 1)).unwrap();
    }

    /// How many shaders the next change concerns.
    fn next(&mut self) -> usize {
        match self.live.next() {
            Reload::Reloaded { shaders, .. } => shaders,
            other => panic!("{other:?}"),
        }
    }

    /// How often each pass has run.
    fn all_runs(&self) -> BTreeMap<&'static str, u64> {
        let report = self.live.app.world().resource::<Report>();
        report.passes.iter().map(|(pass, record)| (*pass, record.runs)).collect()
    }

    /// The middle of the picture.
    fn middle(&mut self) -> [f32; 3] {
        match render_what_is_there(&mut self.live.app).unwrap().pixels {
            Pixels::Radiance(pixels) => pixels[pixels.len() / 2],
            Pixels::Encoded(_) => unreachable!("radiance was asked for"),
        }
    }

    fn runs(&self, pass: &str) -> u64 {
        self.live.app.world().resource::<Report>().passes.get(pass).map_or(0, |pass| pass.runs)
    }
}

fn is_near(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4)
}

#[needs(gpu)]
#[test]
fn a_shader_and_what_it_imports_are_followed_and_one_that_does_not_compile_changes_nothing() {
    let name = "a_shader_and_what_it_imports_are_followed_and_one_that_does_not_compile_changes_nothing";
    with_own_shaders(name, |folder| {
        let look = "Phong: (ambient: (0.5, 0.25, 0.125), diffuse: (0.0, 0.0, 0.0))";
        let mut shaders = Shaders::open(folder, &format!("\"ball\": ( Mesh: Sphere(), {look} ),"));
        assert!(is_near(shaders.middle(), [0.5, 0.25, 0.125]));
        shaders.edit("surface.wgsl", "vec4f(mesh.ambient +", "vec4f(2.0 * mesh.ambient +");
        assert_eq!(shaders.next(), 1);
        assert!(is_near(shaders.middle(), [1.0, 0.5, 0.25]));
        // What is imported, by others too.
        shaders.edit(
            "shared/fresnel.wgsl",
            "fn fresnel_transmittance",
            "const HALF = 0.5;\nfn fresnel_transmittance",
        );
        assert!(shaders.next() > 1);
        shaders.edit("surface.wgsl", "vec4f(2.0 *", "vec4f(HALF *");
        shaders.next();
        assert!(is_near(shaders.middle(), [0.25, 0.125, 0.0625]));
        // A mistake is told of with naga's words and its place, and the picture stays.
        shaders.edit("shared/fresnel.wgsl", "const HALF = 0.5;", "const HALF = nothing;");
        shaders.next();
        assert!(is_near(shaders.middle(), [0.25, 0.125, 0.0625]));
        let told = shaders.live.messages().join("\n");
        assert!(told.contains("no definition in scope for identifier: `nothing`"), "{told}");
        assert!(told.contains("shared/fresnel.wgsl:") && told.contains("const HALF = nothing;"), "{told}");
        // It is not tried again before it changes, and stays told.
        for _ in 0..3 {
            assert!(is_near(shaders.middle(), [0.25, 0.125, 0.0625]));
        }
        assert_eq!(shaders.live.messages().join("\n"), told);
        shaders.edit("shared/fresnel.wgsl", "const HALF = nothing;", "const HALF = 3.0;");
        shaders.next();
        assert!(is_near(shaders.middle(), [1.5, 0.75, 0.375]));
        assert!(!shaders.live.messages().join("\n").contains("compile"));
        // One that goes is the one built in again.
        fs::remove_file(folder.join("surface.wgsl")).unwrap();
        shaders.next();
        assert!(is_near(shaders.middle(), [0.5, 0.25, 0.125]));
    });
}

#[needs(gpu)]
#[test]
fn what_a_shader_made_is_made_again_and_nothing_before_it() {
    with_own_shaders("what_a_shader_made_is_made_again_and_nothing_before_it", |folder| {
        let look = "Subsurface: (material: Preset(\"marble\")), ScatteringMaps: (progressive: false)";
        let mut shaders =
            Shaders::open(folder, &format!("\"ball\": ( Mesh: Sphere(subdivisions: 2), {look} ),"));
        let before = shaders.middle();
        assert!(before[0] > 0.0);
        let passes = ["light_gbuffer", "scattered_radiosity", "combine"];
        assert_eq!(passes.map(|pass| shaders.runs(pass)), [1, 1, 1]);
        shaders.edit("combine.wgsl", "vec4f(sum, 1.0)", "vec4f(3.0 * sum, 1.0)");
        assert_eq!(shaders.next(), 1);
        let tripled = before.map(|channel| 3.0 * channel);
        assert!(is_near(shaders.middle(), tripled), "{before:?}");
        assert_eq!(passes.map(|pass| shaders.runs(pass)), [1, 1, 2]);
        // Sampling is imported through a module that is made for the use.
        shaders.edit("shared/sampling_adaptive.wgsl", "\n", "\n// a comment\n");
        shaders.next();
        assert!(is_near(shaders.middle(), tripled));
        assert_eq!(passes.map(|pass| shaders.runs(pass)), [1, 2, 3]);
        shaders.edit("gbuffer.wgsl", "\n", "\n// a comment\n");
        shaders.next();
        assert!(is_near(shaders.middle(), tripled));
        assert_eq!(passes.map(|pass| shaders.runs(pass)), [2, 3, 4]);
    });
}

/// Everything that has a shader: bodies of both strategies, a medium that scatters with a beam in its way, one that is classified
/// beforehand, one whose rays are cast in parts, and a light for which there is no room.
const EVERYTHING: &str = "
    \"moon\": ( DirectionalLight: (direction: (-1.0, -1.0, -1.0)) ),
    \"adaptive\": (
        Transform: (translation: (-0.6, 0.0, 0.9), scale: 0.3), Mesh: Sphere(subdivisions: 1),
        Subsurface: (material: Custom(sigma_s: (50.0, 60.0, 70.0), sigma_a: (0.1, 0.1, 0.1))), ScatteringMaps: (samples: 4, progressive: false),
    ),
    \"uniform\": (
        Transform: (translation: (0.6, 0.0, 0.9), scale: 0.3), Mesh: Sphere(subdivisions: 1),
        Subsurface: (material: Custom(sigma_s: (50.0, 60.0, 70.0), sigma_a: (0.1, 0.1, 0.1))),
        ScatteringMaps: (strategy: Uniform, samples: 4, progressive: false),
    ),
    \"beam\": ( Transform: (translation: (0.0, 0.0, 1.5)), Mesh: Box(size: (0.2, 0.2, 0.2)) ),
    \"fog\": (
        Volume: Raw(path: \"fog.raw\", size: (8, 8, 8), spacing: (0.25, 0.25, 0.25)),
        TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (0.9, 0.9, 0.9), 0.5), (1.0, (0.9, 0.9, 0.9), 0.5)]),
        VolumeLighting: LightVolume(g: 0.4, towards_eye: true),
    ),
    \"haze\": (
        Volume: Raw(path: \"fog.raw\", size: (8, 8, 8), spacing: (0.1, 0.1, 0.1)),
        TransferFunction: (
            domain: (0.0, 1.0), points: [(0.0, (0.9, 0.9, 0.9), 0.5), (1.0, (0.9, 0.9, 0.9), 0.5)],
            classification: Pre,
        ),
    ),
    \"fine\": (
        Volume: Raw(path: \"fog.raw\", size: (1, 1, 512), spacing: (0.1, 0.1, 0.001)),
        TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (0.9, 0.9, 0.9), 0.5), (1.0, (0.9, 0.9, 0.9), 0.5)]),
        RayCast: (step: 0.01),
    ),";

#[needs(gpu)]
#[test]
fn every_shader_is_followed() {
    with_own_shaders("every_shader_is_followed", |folder| {
        let mut shaders = Shaders::open(folder, EVERYTHING);
        shaders.live.app.insert_resource(LightBudget { volumes: 1, ..Default::default() });
        shaders.live.app.insert_resource(Picture { size: UVec2::splat(9), camera: None, encoded: true });
        render_what_is_there(&mut shaders.live.app).unwrap();
        assert_eq!(shaders.live.messages(), [""; 0]);
        let files: BTreeSet<String> = ["", "shared/"]
            .iter()
            .flat_map(|sub| {
                let entries = fs::read_dir(folder.join(sub)).unwrap().map(Result::unwrap);
                let files = entries.filter(|entry| entry.path().is_file());
                files.map(move |entry| format!("{sub}{}", entry.file_name().to_string_lossy()))
            })
            .collect();
        for file in &files {
            // One that does not compile costs no compiling, and the pipelines that look at it say so.
            let mistake = "\nconst MISTAKE = nothing;\n";
            let text = fs::read_to_string(folder.join(file)).unwrap();
            let before = shaders.all_runs();
            fs::write(folder.join(file), format!("{text}{mistake}")).unwrap();
            shaders.next();
            render_what_is_there(&mut shaders.live.app).unwrap();
            let told = shaders.live.messages().join("\n");
            assert!(told.contains(&format!("{file}:")), "nothing looks at {file}: {told}");
            let mut ran = shaders.all_runs();
            ran.retain(|pass, runs| before.get(pass).is_none_or(|before| before != runs));
            let ran: Vec<&str> = ran
                .keys()
                .copied()
                .filter(|pass| !["surface", "raycast", "tonemap"].contains(pass))
                .collect();
            println!("{file}: {ran:?}");
            fs::write(folder.join(file), text).unwrap();
            shaders.next();
            render_what_is_there(&mut shaders.live.app).unwrap();
            assert_eq!(shaders.live.messages(), [""; 0], "{file}");
        }
    });
}

#[needs(gpu)]
#[test]
fn how_light_diffuses_is_followed() {
    with_own_shaders("how_light_diffuses_is_followed", |folder| {
        let fog = "\"fog\": (
            Volume: Raw(path: \"fog.raw\", size: (8, 8, 8), spacing: (0.25, 0.25, 0.25)),
            TransferFunction: (domain: (0.0, 1.0), points: [(0.0, (0.9, 0.9, 0.9), 0.5), (1.0, (0.9, 0.9, 0.9), 0.5)]),
            VolumeLighting: LightVolume(),
        ),";
        let edits = [
            ("diffusion.wgsl", "max(share * found,", "max(3.0 * share * found,"),
            ("light_network.wgsl", "vec4f(medium.a * level.unit", "vec4f(3.0 * medium.a * level.unit"),
            ("light_escape.wgsl", "+= fan.share *", "+= 0.25 * fan.share *"),
        ];
        let mut shaders = Shaders::open(folder, fog);
        for (file, from, to) in edits {
            let before = shaders.middle();
            shaders.edit(file, from, to);
            shaders.next();
            let after = shaders.middle();
            assert!(!is_near(before, after), "{file}: {before:?} {after:?}");
            shaders.edit(file, to, from);
            shaders.next();
            assert!(is_near(shaders.middle(), before), "{file}");
        }
    });
}
