//! Light scattering in meshes and volumes, as data.
//!
//! A scene is a RON file. Each of its entries is an entity of an ECS, each field of an entry a component; systems read what files the
//! components name, bring them to the GPU, and draw meshes and volumes into one picture that is right in depth. What has not changed
//! since the last frame is not made again.
//!
//! ```text
//!  scene.ron ──scene──▶ components ──loading──▶ triangles, samples        once, and when a component changes
//!                           │                        │ passes::upload
//!                           │                        ▼
//!                           │  passes::classify   buffers, textures
//!                           ├─────────────────▶ lookup tables, bricks
//!                           │                        ▼
//!                           ├─── lights ───▶ light volumes, G-buffers ──▶ scattered light   when a light turns, or what it meets changes
//!                           ▼                        ▼
//!                  camera, lights ──▶ surface ──▶ raycast ──▶ tonemap     each frame
//!                                     radiance,   radiance    PNG
//!                                     distance    EXR
//! ```
//!
//! What runs when is said by [`Stage`], in this order. Where to look:
//!
//! | to | see |
//! |---|---|
//! | write scenes | [`components`]: each is documented with its fields, units, ranges, defaults and RON |
//! | show a scene in a window, or add to its panels | [`window`], [`ui`] |
//! | draw from a program | [`render`], [`gpu`]; `examples/render_scene.rs`, `examples/build_in_code.rs` |
//! | follow a scene's files while they are edited | [`scene::LiveScene`] |
//! | add components and systems | [`prelude`], [`Stage`]; `plugins/README.md` |
//! | make a command line with plugins of your own | [`cli::run`] |
//!
//! # A scene, read and looked at
//!
//! Without a GPU scenes are read, checked and animated, only not drawn:
//!
//! ```
//! use tyndall::prelude::*;
//! use tyndall::render::{load_scene, problems};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("scene.ron");
//! std::fs::write(&path, r#"(
//!     entities: {
//!         "sun": ( DirectionalLight: (direction: (1.0, -2.0, -1.0)) ),
//!         "ball": ( Transform: (translation: (0.0, 1.0, 0.0)), Mesh: Sphere(radius: 0.5) ),
//!     },
//! )"#)?;
//!
//! let mut app = App::new();
//! app.add_plugins(TyndallPlugins);
//! let document = load_scene(&mut app, &path, &[]);
//! app.update();
//! assert!(problems(app.world(), &document).is_empty());
//!
//! let world = app.world_mut();
//! let (name, placement) = world.query_filtered::<(&Name, &Placement), With<Mesh>>().single(world)?;
//! assert_eq!((name.as_str(), placement.0.translation), ("ball", DVec3::Y));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Drawn
//!
//! ```no_run
//! use tyndall::gpu::{Gpu, GpuOptions};
//! use tyndall::prelude::*;
//! use tyndall::render::{load_scene, render};
//!
//! let mut app = App::new();
//! app.add_plugins(TyndallPlugins);
//! app.insert_resource(pollster::block_on(Gpu::new(&GpuOptions::default()))?);
//! load_scene(&mut app, "scenes/showcase.ron".as_ref(), &[]);
//! let image = render(&mut app)?;
//! println!("{} x {} pixels", image.width, image.height);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod app;
mod changes;
pub mod cli;
pub mod components;
pub mod cpu;
mod failure;
pub mod gpu;
pub mod loading;
pub mod mirrors;
pub mod optics;
mod passes;
mod picture_file;
mod plain;
pub mod prelude;
mod regular_file;
pub mod render;
pub mod report;
pub mod scene;
pub mod sources;
pub mod ui;
mod view;
mod whole_file;
pub mod window;
pub use app::{SceneTime, Stage, TyndallPlugins};
pub use passes::light_budget::LightBudget;
pub use passes::light_gbuffer::LightTexels;
pub use passes::scattered_radiosity::Refinement;
pub use passes::scattering_gbuffer::AutomaticCamera;
pub use view::{
    Coarseness, Comparison, CutOut, Drawing, FreeCamera, Picture, SceneBounds, Split, View, Viewpoint,
};
