//! Pictures of the panels, compared with pictures that were looked at.
//!
//! `TYNDALL_BLESS=name cargo xtask test ui` accepts what `name` looks like now. A failure leaves `name.actual.png` beside the picture.
//! With `TYNDALL_LOOK` set to a folder, all of them are written there too, in twice the size besides.

use crate::panel::{function_over, press, registry, two_humps};
use egui::vec2;
use egui_kittest::{Harness, kittest::Queryable};
use glam::Quat;
use std::path::Path;
use tyndall::components::{ChooseVariant, Specular};
use tyndall::prelude::*;
use tyndall::ui::{InspectorContext, inspect, light_direction};
use tyndall_needs::needs;

/// Drivers differ in the last bits of a blend.
const OUTLIER: u8 = 24;
const MOST_OUTLIERS: usize = 60;

fn check<S>(name: &str, scale: f32, harness: &mut Harness<S>) {
    let image = harness.render().unwrap();
    if let Ok(folder) = std::env::var("TYNDALL_LOOK") {
        image.save(Path::new(&folder).join(format!("{name}_{scale}x.png"))).unwrap();
    }
    if scale != 1.0 {
        return;
    }
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"));
    let bless = std::env::var("TYNDALL_BLESS").unwrap_or_default();
    let image = image::DynamicImage::ImageRgba8(image).to_rgb8();
    if bless == name || bless == "all" {
        save(&golden, &image);
        let bytes = std::fs::metadata(&golden).unwrap().len();
        assert!(bytes <= 64 << 10, "a golden picture has at most 64 KiB, found {bytes} bytes");
        return;
    }
    let expected = image::open(&golden)
        .unwrap_or_else(|error| panic!("{error}; look at the picture and bless it: TYNDALL_BLESS={name}"))
        .to_rgb8();
    let differs =
        |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| (0..3).any(|c| a.0[c].abs_diff(b.0[c]) > OUTLIER);
    let outliers = image.pixels().zip(expected.pixels()).filter(|pair| differs(*pair)).count();
    if image.dimensions() != expected.dimensions() || outliers > MOST_OUTLIERS {
        let actual = golden.with_extension("actual.png");
        image.save(&actual).unwrap();
        panic!("{name} differs in {outliers} pixels; see {}", actual.display());
    }
}

fn save(path: &Path, image: &image::RgbImage) {
    use image::codecs::png::{CompressionType, FilterType, PngEncoder};
    let file = std::fs::File::create(path).unwrap();
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive);
    image.write_with_encoder(encoder).unwrap();
}

fn components() -> Vec<Box<dyn Reflect>> {
    let material = Material::Preset("marble".into()).chosen("Custom").unwrap().take::<Material>().unwrap();
    let specular = Some(Specular::default());
    vec![
        Box::new(Subsurface { material, specular, ..Default::default() }),
        Box::new(DirectionalLight {
            direction: Vec3::new(-1.0, -2.0, -0.5),
            irradiance: Vec3::new(3.0, 2.9, 2.7),
        }),
        Box::new(Mesh::file("assets/lotus.obj")),
        Box::new(TransferFunction {
            points: TransferFunction::default().points_in_force(),
            ..Default::default()
        }),
    ]
}

#[needs(gpu)]
#[test]
fn the_inspector() {
    for scale in [1.0, 2.0] {
        let (registry, components) = (registry(), components());
        let mut harness =
            Harness::builder().with_size(vec2(360.0, 800.0)).with_pixels_per_point(scale).wgpu().build_ui(
                move |ui| {
                    let context = InspectorContext {
                        entities_with: &|_| vec!["bunny".into()],
                        folder: Path::new(env!("CARGO_MANIFEST_DIR")),
                        eye_from_scene: Quat::IDENTITY,
                    };
                    for component in &components {
                        inspect(ui, "thing", component.as_ref(), &registry, &context);
                    }
                },
            );
        harness.run();
        check("inspector", scale, &mut harness);
    }
}

#[needs(gpu)]
#[test]
fn the_transfer_function_editor() {
    for scale in [1.0, 2.0] {
        let points = vec![
            ControlPoint(0.2, Vec3::new(0.3, 0.1, 0.05), 0.0),
            ControlPoint(0.36, Vec3::new(0.9, 0.3, 0.15), 0.25),
            ControlPoint(0.5, Vec3::new(0.9, 0.6, 0.4), 0.08),
            ControlPoint(0.85, Vec3::new(1.0, 0.95, 0.8), 0.85),
        ];
        let iso =
            vec![IsoValue { value: 150.0, width: 9.0, color: Vec3::new(0.1, 0.7, 1.0), absorption: 0.9 }];
        let function = TransferFunction { points, iso, ..Default::default() };
        let mut harness = function_over(function, Some(two_humps()), (0.0, 255.0), scale);
        press(&mut harness, "Iso value 1");
        harness.get_by_label("Control point 4").click();
        harness.run();
        harness.remove_cursor();
        harness.run();
        check("transfer_function", scale, &mut harness);
    }
}

#[needs(gpu)]
#[test]
fn the_light_direction() {
    for scale in [1.0, 2.0] {
        let mut harness =
            Harness::builder().with_size(vec2(220.0, 230.0)).with_pixels_per_point(scale).wgpu().build_ui(
                |ui| {
                    let view = Quat::from_rotation_x(0.5) * Quat::from_rotation_y(-0.6);
                    light_direction(ui, "key light", Vec3::new(-1.0, -1.2, -0.5), view);
                    light_direction(ui, "from behind", Vec3::new(-0.2, -0.3, 1.0), view);
                },
            );
        harness.run();
        check("light_direction", scale, &mut harness);
    }
}

#[needs(gpu)]
#[test]
fn the_colour_picker() {
    for scale in [1.0, 2.0] {
        let points =
            vec![ControlPoint(0.2, Vec3::new(4.0, 1.2, 0.6), 0.0), ControlPoint(0.8, Vec3::ONE, 0.4)];
        let function = TransferFunction { points, ..Default::default() };
        let mut harness = function_over(function, None, (0.0, 1.0), scale);
        harness.set_size(vec2(380.0, 600.0));
        press(&mut harness, "Control point 1");
        press(&mut harness, "Control point 1 colour");
        check("colour_picker", scale, &mut harness);
    }
}
