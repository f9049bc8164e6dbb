//! Shaders that change while they are used.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/files.rs"]
mod files;
#[path = "support/own_shaders.rs"]
mod own_shaders;

use files::{Live, mark};
use glam::UVec2;
use own_shaders::with_own_shaders;
use std::fs;
use std::path::Path;
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
        let live = Live::open_in(app, &[("scene.ron", &scene), ("mark.ron", &mark(0.0))], "scene.ron");
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
