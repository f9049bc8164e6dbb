//! Points and iso values are added, dragged, deleted; presets, files, zoom.

use crate::panel::{Function, centre, choose, click, drag, function, on_picture, press, set};
use egui::{Key, Modifiers, MouseWheelUnit, vec2};
use egui_kittest::{Harness, kittest::Queryable};
use tyndall::optics::transfer::LookupTable;
use tyndall::prelude::*;

const PICTURE: &str = "Transfer function of head";

fn three_points() -> TransferFunction {
    let points = vec![
        ControlPoint(0.1, Vec3::X, 0.0),
        ControlPoint(0.5, Vec3::Y, 0.5),
        ControlPoint(0.8, Vec3::Z, 0.8),
    ];
    TransferFunction { points, ..Default::default() }
}

fn points<'h>(harness: &'h Harness<'_, Function>) -> &'h [ControlPoint] {
    &harness.state().edits.component.points
}

fn undo(harness: &mut Harness<Function>) {
    harness.state_mut().edits.undo();
    harness.run();
}

#[test]
fn a_click_on_the_curve_adds_a_point_that_changes_nothing() {
    let mut harness = function(three_points());
    let at = on_picture(&harness.get_by_label(PICTURE), 76.5, (0.0, 255.0), 0.25);
    click(&mut harness, at);
    let edits = &harness.state().edits;
    assert_eq!(edits.log, [("points".to_owned(), true)]);
    assert_eq!(edits.component.points.len(), 4);
    let added = edits.component.points[1];
    assert!((added.0 - 0.3).abs() < 0.01 && (added.2 - 0.25).abs() < 0.01, "{added:?}");
    let table = |function: &TransferFunction| LookupTable::new(function, (0.0, 255.0), 1.0, 1.0).entries;
    let differences = table(&edits.component).into_iter().zip(table(&three_points()));
    assert!(differences.into_iter().all(|(new, old)| (new - old).abs().max_element() < 1e-4));
    // It is chosen, and has a handle.
    harness.get_by_label("Control point 2 opacity");
    harness.get_by_label("Control point 4");
}

#[test]
fn a_click_beside_the_curve_adds_nothing() {
    let mut harness = function(three_points());
    let at = on_picture(&harness.get_by_label(PICTURE), 76.5, (0.0, 255.0), 0.7);
    click(&mut harness, at);
    assert!(harness.state().edits.log.is_empty());
}

#[test]
fn a_drag_moves_a_point_and_is_one_change() {
    let mut harness = function(three_points());
    let from = centre(&harness.get_by_label("Control point 2"));
    drag(&mut harness, from, vec2(20.0, -30.0));
    let edits = &harness.state().edits;
    let (moved, width) = (edits.component.points[1], harness.get_by_label(PICTURE).rect().width());
    assert!((moved.0 - (0.5 + 20.0 / width)).abs() < 0.005, "{moved:?}");
    assert!((moved.2 - (0.5 + 30.0 / 152.0)).abs() < 0.005, "{moved:?}");
    assert_eq!(moved.1, Vec3::Y);
    assert!(edits.log.len() > 2 && edits.log.iter().all(|(path, _)| path == "points[1]"));
    assert_eq!(edits.log.iter().filter(|(_, finished)| *finished).count(), 1, "{:?}", edits.log);
    assert!(edits.log.last().unwrap().1);
    undo(&mut harness);
    assert_eq!(harness.state().edits.component, three_points());
}

#[test]
fn a_point_does_not_pass_its_neighbours() {
    let mut harness = function(three_points());
    let from = centre(&harness.get_by_label("Control point 2"));
    drag(&mut harness, from, vec2(300.0, 400.0));
    assert_eq!((points(&harness)[1].0, points(&harness)[1].2), (0.8, 0.0));
    let from = centre(&harness.get_by_label("Control point 2"));
    drag(&mut harness, from, vec2(-600.0, -400.0));
    assert_eq!((points(&harness)[1].0, points(&harness)[1].2), (0.1, 1.0));
    let from = centre(&harness.get_by_label("Control point 1"));
    drag(&mut harness, from, vec2(-600.0, 0.0));
    assert_eq!(points(&harness)[0].0, 0.0);
}

#[test]
fn of_points_in_one_place_the_one_moves_that_can() {
    for (by, moved) in [(-60.0, 0), (60.0, 1)] {
        let same = ControlPoint(0.5, Vec3::ONE, 0.5);
        let mut harness = function(TransferFunction { points: vec![same, same], ..Default::default() });
        let from = centre(&harness.get_by_label("Control point 2"));
        drag(&mut harness, from, vec2(by, 0.0));
        let points = points(&harness);
        assert!((points[moved].0 - 0.5).abs() > 0.1, "{points:?}");
        assert_eq!(points[1 - moved].0, 0.5);
    }
}

#[test]
fn delete_deletes_and_undo_brings_back() {
    let mut harness = function(three_points());
    press(&mut harness, "Control point 2");
    assert!(harness.get_by_label("Control point 2").is_focused());
    harness.key_press(Key::Delete);
    harness.run();
    assert_eq!(points(&harness).iter().map(|point| point.0).collect::<Vec<_>>(), [0.1, 0.8]);
    undo(&mut harness);
    assert_eq!(harness.state().edits.component, three_points());
    // By its menu.
    harness.get_by_label("Control point 3").click_secondary();
    harness.run();
    harness.get_by_label("Delete").click();
    harness.run();
    assert_eq!(points(&harness).len(), 2);
    assert_eq!(points(&harness)[1].0, 0.5);
}

#[test]
fn the_last_point_stays() {
    let points = vec![ControlPoint(0.5, Vec3::ONE, 0.5)];
    let mut harness = function(TransferFunction { points, ..Default::default() });
    press(&mut harness, "Control point 1");
    harness.key_press(Key::Delete);
    harness.run();
    assert!(harness.state().edits.log.is_empty());
    harness.get_by_label_contains("The last one stays");
}

#[test]
fn keys_alone_are_enough() {
    let mut harness = function(three_points());
    harness.get_by_label("Control point 1").focus();
    harness.run();
    harness.key_press(Key::ArrowRight);
    harness.key_press(Key::ArrowUp);
    harness.run();
    let point = points(&harness)[0];
    assert!((point.0 - 0.11).abs() < 0.002 && (point.2 - 0.01).abs() < 1e-4, "{point:?}");
    assert!(harness.state().edits.log.iter().all(|(_, finished)| *finished));
    harness.key_press(Key::Tab);
    harness.run();
    assert!(harness.get_by_label("Control point 2").is_focused());
    harness.key_press(Key::Backspace);
    harness.run();
    assert_eq!(points(&harness).len(), 2);
}

#[test]
fn the_ramp_that_nothing_stands_for_is_written_when_it_is_changed() {
    let mut harness = function(TransferFunction::default());
    let from = centre(&harness.get_by_label("Control point 2"));
    drag(&mut harness, from, vec2(0.0, -76.0));
    assert_eq!(points(&harness).len(), 2);
    assert!((points(&harness)[1].2 - 0.6).abs() < 0.01);
    assert_eq!(harness.state().edits.before.len(), 1);
    undo(&mut harness);
    assert_eq!(harness.state().edits.component, TransferFunction::default());
}

#[test]
fn numbers_and_colours_of_the_chosen_point_are_changed() {
    let mut harness = function(three_points());
    press(&mut harness, "Control point 2");
    set(&mut harness, "Control point 2 opacity", 0.03);
    set(&mut harness, "Control point 2 value", 102.0);
    set(&mut harness, "Control point 2 blue", 2.5);
    assert_eq!(points(&harness)[1], ControlPoint(0.4, Vec3::new(0.0, 1.0, 2.5), 0.03));
    press(&mut harness, "Control point 1");
    press(&mut harness, "Control point 1 colour");
    set(&mut harness, "Control point 1 colour hue", 120.0);
    assert_eq!(points(&harness)[0].1, Vec3::Y);
    let before = harness.state().edits.before.len();
    let square = harness.get_by_label("Control point 1 colour saturation and value").rect();
    drag(&mut harness, square.right_top() + vec2(-1.0, 1.0), vec2(1.0 - square.width(), 0.0));
    let picked = points(&harness)[0].1;
    assert!(picked.min_element() > 0.9, "white: {picked}");
    assert_eq!(harness.state().edits.before.len(), before + 1);
    set(&mut harness, "Control point 1 colour brightness", 4.0);
    assert!(points(&harness)[0].1.max_element() == 4.0);
}

#[test]
fn presets_fit_the_data_and_can_be_undone() {
    let mut harness = function(three_points());
    choose(&mut harness, "Presets", "Glow");
    let edits = &harness.state().edits;
    assert_eq!(edits.log, [(String::new(), true)]);
    // Nothing is seen of the air, whose hump ends at about 40.
    let start = edits.component.points[0].0 * 255.0;
    assert!((35.0..=70.0).contains(&start), "{start}");
    undo(&mut harness);
    assert_eq!(harness.state().edits.component, three_points());
    choose(&mut harness, "Presets", "ember");
    assert_eq!(points(&harness).len(), 6);
}

#[test]
fn iso_values_are_added_dragged_and_deleted() {
    let mut harness = function(TransferFunction::default());
    press(&mut harness, "Add iso value");
    let function = &harness.state().edits.component;
    assert_eq!((function.iso.len(), function.points.len()), (1, 2), "the ramp stays");
    let iso = function.iso[0];
    assert!((iso.value - 127.0).abs() < 2.0 && iso.width > 0.0, "{iso:?}");
    let from = centre(&harness.get_by_label("Iso value 1"));
    drag(&mut harness, from, vec2(38.0, 60.0));
    let moved = harness.state().edits.component.iso[0];
    assert!((moved.value - iso.value - 25.5).abs() < 1.5 && moved.absorption < 0.5, "{moved:?}");
    assert_eq!(harness.state().edits.before.len(), 2);
    let from = centre(&harness.get_by_label("Width of iso value 1, right"));
    drag(&mut harness, from, vec2(38.0, 0.0));
    let wider = harness.state().edits.component.iso[0];
    assert!((wider.width - moved.width - 51.0).abs() < 3.0, "{wider:?}");
    set(&mut harness, "Iso value 1 absorption", 3.0);
    set(&mut harness, "Iso value 1 red", 0.25);
    let set = harness.state().edits.component.iso[0];
    assert_eq!((set.absorption, set.color.x), (3.0, 0.25));
    harness.get_by_label("Iso value 1").focus();
    harness.run();
    harness.key_press(Key::Delete);
    harness.run();
    assert!(harness.state().edits.component.iso.is_empty());
}

#[test]
fn the_wheel_zooms_and_the_domain_comes_back() {
    let mut harness = function(three_points());
    let view = |harness: &Harness<Function>| -> Vec<f64> {
        let text = harness.get_by_label(PICTURE).value().unwrap();
        text.split(" to ").map(|number| number.parse().unwrap()).collect()
    };
    assert_eq!(view(&harness), [0.0, 255.0]);
    let at = on_picture(&harness.get_by_label(PICTURE), 51.0, (0.0, 255.0), 0.9);
    harness.hover_at(at);
    harness.run();
    for _ in 0..8 {
        harness.event(egui::Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: vec2(0.0, 60.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        harness.run_steps(20);
    }
    let zoomed = view(&harness);
    assert!(zoomed[1] - zoomed[0] < 100.0 && zoomed[0] < 51.0 && zoomed[1] > 51.0, "{zoomed:?}");
    // What is under the pointer stays there.
    assert!(((51.0 - zoomed[0]) / (zoomed[1] - zoomed[0]) - 0.2).abs() < 0.02, "{zoomed:?}");
    assert!(harness.query_by_label("Control point 3").is_none(), "out of view");
    drag(&mut harness, at, vec2(30.0, 0.0));
    assert!(view(&harness)[0] < zoomed[0]);
    press(&mut harness, "Domain");
    assert_eq!(view(&harness), [0.0, 255.0]);
    assert!(harness.state().edits.log.is_empty(), "looking changes nothing");
}

#[test]
fn a_drag_with_shift_zooms_into_a_range() {
    let mut harness = function(three_points());
    let picture = harness.get_by_label(PICTURE).rect();
    let from = egui::pos2(picture.left() + 0.25 * picture.width(), picture.top() + 12.0);
    harness.event(egui::Event::ModifiersChanged(Modifiers::SHIFT));
    harness.run();
    drag(&mut harness, from, vec2(0.25 * picture.width(), 0.0));
    let text = harness.get_by_label(PICTURE).value().unwrap();
    let ends: Vec<f64> = text.split(" to ").map(|number| number.parse().unwrap()).collect();
    assert!((ends[0] - 63.75).abs() < 2.0 && (ends[1] - 127.5).abs() < 2.0, "{text}");
}

#[test]
fn the_domain_is_changed_in_data_values() {
    let mut harness = function(three_points());
    harness.get_by_label("auto").click();
    harness.run();
    assert_eq!(harness.state().edits.component.domain, Auto::Value(Vec2::new(0.0, 255.0)));
    set(&mut harness, "Domain to", 100.0);
    set(&mut harness, "Domain from", 50.0);
    assert_eq!(harness.state().edits.component.domain, Auto::Value(Vec2::new(50.0, 100.0)));
    // Ends do not meet.
    set(&mut harness, "Domain from", 100.0);
    assert_eq!(harness.state().edits.component.domain, Auto::Value(Vec2::new(50.0, 100.0)));
    harness.get_by_label("auto").click();
    harness.run();
    assert_eq!(harness.state().edits.component.domain, Auto::Auto);
}

#[test]
fn a_function_is_saved_and_loaded() {
    let mut harness = function(three_points());
    let field = |harness: &mut Harness<Function>, text: &str| {
        harness.get_by_label("File of the transfer function").focus();
        harness.run();
        harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
        harness.get_by_label("File of the transfer function").type_text(text);
        harness.run();
    };
    field(&mut harness, "mine");
    press(&mut harness, "Save");
    let path = harness.state().folder.path().join("mine.ron");
    assert!(std::fs::read_to_string(&path).unwrap().contains("(0.5, (0.0, 1.0, 0.0), 0.5)"));
    harness.get_by_label_contains("Saved as");
    choose(&mut harness, "Presets", "Surface");
    assert!(points(&harness).is_empty());
    press(&mut harness, "Load");
    assert_eq!(harness.state().edits.component, three_points());
    // A mistake is told with its place, and nothing changes.
    std::fs::write(&path, "(\n  points: [(0.9, (1.0, 1.0, 1.0), 0.5), (0.1, (1.0, 1.0, 1.0), 0.5)],\n)")
        .unwrap();
    press(&mut harness, "Load");
    harness.get_by_label_contains("mine.ron:2:");
    assert_eq!(harness.state().edits.component, three_points());
    field(&mut harness, "no such folder/mine");
    press(&mut harness, "Save");
    harness.get_by_label_contains("cannot write");
}
