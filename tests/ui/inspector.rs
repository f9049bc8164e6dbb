//! Components of the framework in the inspector.

use crate::panel::{Inspected, centre, choose, drag, inspector, inspector_with, press, registry, set};
use bevy_reflect::std_traits::ReflectDefault;
use egui::{Key, vec2};
use egui_kittest::{Harness, kittest::NodeT, kittest::Queryable};
use glam::Quat;
use std::path::Path;
use tyndall::components::{Specular, VolumeLighting};
use tyndall::prelude::*;
use tyndall::ui::{InspectorContext, inspect};

#[test]
fn a_slider_is_dragged_in_one_change() {
    let mut harness = inspector(ViewCamera::default());
    let slider = harness.get_by_label("ViewCamera.projection.vertical_fov slider").rect();
    let from = egui::pos2(egui::lerp(slider.x_range(), 40.0 / 115.0), slider.center().y);
    drag(&mut harness, from, vec2(20.0, 0.0));
    let edits = &harness.state().edits;
    let Projection::Perspective { vertical_fov } = edits.component.projection else { panic!("perspective") };
    assert!(vertical_fov > 50.0, "{vertical_fov}");
    assert!(edits.log.iter().all(|(path, _)| path == "projection.vertical_fov"));
    assert!(edits.log.len() > 1 && edits.log.last().unwrap().1);
    assert_eq!(edits.before.len(), 1, "{:?}", edits.log);
    harness.state_mut().edits.undo();
    harness.run();
    assert_eq!(harness.state().edits.component, ViewCamera::default());
}

#[test]
fn a_number_is_dragged_in_one_change() {
    let mut harness = inspector(DirectionalLight::default());
    let from = centre(&harness.get_by_label("DirectionalLight.irradiance red"));
    drag(&mut harness, from, vec2(60.0, 0.0));
    let edits = &harness.state().edits;
    assert!(edits.component.irradiance.x > 1.2, "brighter than 1: {:?}", edits.component);
    assert_eq!(edits.before.len(), 1, "{:?}", edits.log);
}

#[test]
fn a_variant_begins_with_its_defaults() {
    let mut harness = inspector(ViewCamera::default());
    choose(&mut harness, "ViewCamera.projection", "Orthographic");
    assert_eq!(harness.state().edits.component.projection, Projection::Orthographic { height: 2.0 });
    set(&mut harness, "ViewCamera.projection.height", 5.0);
    assert_eq!(harness.state().edits.component.projection, Projection::Orthographic { height: 5.0 });
    let paths: Vec<_> = harness.state().edits.log.iter().map(|(path, _)| path.as_str()).collect();
    assert_eq!(paths, ["projection", "projection.height"]);
}

#[test]
fn a_medium_is_chosen_by_name() {
    let mut harness = inspector(Subsurface::default());
    choose(&mut harness, "Subsurface.material.0", "ketchup");
    assert_eq!(harness.state().edits.component.material, Material::Preset("ketchup".into()));
    choose(&mut harness, "Subsurface.material", "Custom");
    let medium = harness.state().edits.component.material.coefficients().unwrap();
    let ketchup = Material::Preset("ketchup".into()).coefficients().unwrap();
    assert!((medium[0].sigma_s - ketchup[0].sigma_s).abs() < 1e-5);
    set(&mut harness, "Subsurface.material.sigma_a green", 0.5);
    assert_eq!(harness.state().edits.log.last().unwrap().0, "material.sigma_a");
    press(&mut harness, "Subsurface.specular is set");
    assert_eq!(harness.state().edits.component.specular, Some(Specular::default()));
    set(&mut harness, "Subsurface.specular.shininess", 500.0);
    assert_eq!(harness.state().edits.component.specular.unwrap().shininess, 500.0);
    harness.state_mut().edits.undo();
    harness.run();
    assert_eq!(harness.state().edits.component.specular, Some(Specular::default()));
}

#[test]
fn what_is_automatic_may_be_a_value() {
    let mut harness = inspector(VolumeLighting::default());
    choose(&mut harness, "VolumeLighting kind", "LightVolume");
    choose(&mut harness, "VolumeLighting.cone_angle kind", "Value");
    set(&mut harness, "VolumeLighting.cone_angle", 30.0);
    let VolumeLighting::LightVolume { cone_angle, .. } = harness.state().edits.component else {
        panic!("chosen")
    };
    assert_eq!(cone_angle, Auto::Value(30.0));
    // The range is that of the field.
    set(&mut harness, "VolumeLighting.cone_angle", 95.0);
    let VolumeLighting::LightVolume { cone_angle, .. } = harness.state().edits.component else {
        panic!("chosen")
    };
    assert_eq!(cone_angle, Auto::Value(30.0));
}

#[test]
fn an_entity_is_chosen_by_what_it_has() {
    let camera = ScatteringCamera { target: "bunny".into(), ..Default::default() };
    let mut harness = inspector(camera);
    choose(&mut harness, "ScatteringCamera.target", "dragon");
    assert_eq!(harness.state().edits.component.target, "dragon");
}

#[test]
fn a_path_says_whether_its_file_is_there() {
    let mut path = AssetPath::new("../assets/lotus.obj");
    path.resolve(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes"));
    let mut harness = inspector(Mesh::File { path, normals: Default::default(), materials: true });
    let explanation = |harness: &Harness<Inspected<Mesh>>| {
        harness.get_by_label("Mesh.path").accesskit_node().description().unwrap()
    };
    assert!(explanation(&harness).ends_with("lotus.obj: exists"), "{}", explanation(&harness));
    harness.get_by_label("Mesh.path").focus();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    harness.get_by_label("Mesh.path").type_text("../assets/rose.obj");
    harness.key_press(Key::Enter);
    harness.run();
    let Mesh::File { path, .. } = &harness.state().edits.component else { panic!("a file") };
    assert_eq!(path.written(), "../assets/rose.obj");
    assert_eq!(path.path(), Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/../assets/rose.obj"));
    assert!(explanation(&harness).ends_with("rose.obj: does not exist"));
}

#[test]
fn what_would_be_wrong_waits_until_it_is_right() {
    let mut harness =
        inspector(DirectionalLight { direction: Vec3::new(0.0, -2.0, 0.0), ..Default::default() });
    set(&mut harness, "DirectionalLight.direction y", 0.0);
    assert!(harness.state().edits.log.is_empty());
    harness.get_by_label_contains("a light needs a direction");
    set(&mut harness, "DirectionalLight.direction x", 3.0);
    assert_eq!(harness.state().edits.component.direction, Vec3::new(3.0, 0.0, 0.0));
    assert_eq!(harness.state().edits.before.len(), 1);
    assert!(harness.query_by_label_contains("a light needs").is_none());
    // Given up, it is as it was.
    set(&mut harness, "DirectionalLight.direction x", 0.0);
    press(&mut harness, "Give up changes of DirectionalLight");
    assert!(harness.query_by_label_contains("a light needs").is_none());
    assert_eq!(harness.get_by_label("DirectionalLight.direction x").value().unwrap(), "3");
}

#[test]
fn a_light_is_turned_by_its_handle() {
    let mut harness = inspector(DirectionalLight { direction: Vec3::NEG_Z, ..Default::default() });
    press(&mut harness, "DirectionalLight.direction handle");
    let nodes = harness.get_all_by_label("DirectionalLight.direction handle");
    let ball = nodes.map(|node| node.rect()).max_by(|a, b| a.width().total_cmp(&b.width())).unwrap();
    assert!(ball.width() > 60.0);
    drag(&mut harness, ball.center(), vec2(25.0, 0.0));
    let edits = &harness.state().edits;
    assert!(edits.component.direction.x < -0.3, "{:?}", edits.component);
    assert_eq!((edits.before.len(), edits.log[0].0.as_str()), (1, "direction"));
}

#[test]
fn documentation_unit_range_and_default_are_told() {
    let mut harness = inspector(ViewCamera::default());
    let described = harness.get_by_label("ViewCamera.exposure").accesskit_node().description().unwrap();
    assert_eq!(described, "Exposure value.\nEV, from -100 to 100\ndefault 0");
    // And to those who hover.
    let label = harness.get_by_label("exposure EV").rect();
    harness.hover_at(label.center());
    harness.run_steps(60);
    harness.get_by_label_contains("Exposure value.");
}

#[test]
fn the_keyboard_reaches_everything() {
    let mut harness = inspector(Phong::default());
    let mut reached = Vec::new();
    for _ in 0..60 {
        harness.key_press(Key::Tab);
        harness.run();
        let focused = harness.root().children_recursive().find(|node| node.is_focused());
        reached.extend(focused.and_then(|node| node.accesskit_node().label()));
    }
    for field in ["ambient", "diffuse", "specular"] {
        for part in ["colour", "red", "green", "blue"] {
            let name = format!("Phong.{field} {part}");
            assert!(reached.contains(&name), "{name} in {reached:?}");
        }
    }
    assert!(
        reached.contains(&"Phong.shininess".into()) && reached.contains(&"Phong.shininess slider".into())
    );
}

#[test]
fn every_component_can_be_shown() {
    let registry = registry();
    let mut shown = 0;
    for registration in registry.iter().filter(|registration| registration.contains::<ReflectComponent>()) {
        let Some(default) = registration.data::<ReflectDefault>() else { continue };
        let component = default.default();
        let mut harness = Harness::builder().with_size(vec2(340.0, 900.0)).build_ui(|ui| {
            let context = InspectorContext {
                entities_with: &|_| Vec::new(),
                folder: Path::new("."),
                eye_from_scene: Quat::IDENTITY,
            };
            assert!(inspect(ui, "thing", component.as_ref(), &registry, &context).is_empty());
        });
        // Whatever can be used has a name; the harness looks after that.
        harness.run();
        shown += 1;
    }
    assert!(shown >= 13, "{shown}");
}

#[test]
fn numbers_that_are_none_and_lists_without_end_do_no_harm() {
    let nan = Vec3::splat(f32::NAN);
    let mut harness = inspector(Phong {
        ambient: nan,
        diffuse: Vec3::splat(f32::INFINITY),
        specular: nan,
        shininess: f32::NAN,
    });
    harness.run();
    assert!(harness.state().edits.log.is_empty(), "showing changes nothing");
    set(&mut harness, "Phong.shininess", 7.0);
    assert_eq!(harness.state().edits.component.shininess, 7.0);
    let points = (0..100_000).map(|index| ControlPoint(index as f32 / 1e5, Vec3::ONE, 0.5)).collect();
    let function = TransferFunction { points, ..Default::default() };
    let mut harness = inspector_with(function, registry(), vec2(360.0, 1400.0));
    assert!(harness.query_by_label("TransferFunction.points[60]").is_none());
    press(&mut harness, "Later items of TransferFunction.points");
    harness.get_by_label("Remove TransferFunction.points[60]").click();
    harness.run();
    assert_eq!(harness.state().edits.component.points.len(), 99_999);
}

#[test]
fn a_number_that_is_only_looked_at_keeps_its_digits() {
    let exact = Vec3::new(0.123_456_79, 1.0 / 3.0, 1e-7 / 3.0);
    let mut harness = inspector(Phong { diffuse: exact, ..Default::default() });
    assert_eq!(harness.get_by_label("Phong.diffuse red").value().unwrap(), "0.1235");
    for _ in 0..40 {
        harness.key_press(Key::Tab);
        harness.run();
    }
    assert!(harness.state().edits.log.is_empty());
    assert_eq!(harness.state().edits.component.diffuse, exact);
}
