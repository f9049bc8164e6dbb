//! The panels of the window, clicked and typed into as a person would, without a window and without drawing the scene.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_ecs::reflect::AppTypeRegistry;
use egui::{Key, Modifiers, vec2};
use egui_kittest::{
    Harness,
    kittest::{NodeT, Queryable},
};
use glam::DVec2;
use tyndall::components::{DirectionalLight, SceneSettings, Shading};
use tyndall::scene::{Edits, Problem, SceneDocument, SceneEntities};
use tyndall::ui::{
    self, Axis, Command, Level, Log, OpenPanels, PictureFile, SceneProblems, Section, Sections, Selection,
    Shown,
};
use tyndall::{Comparison, Split, TyndallPlugins};

/// A scene, and what was asked for in its panels.
struct Panels {
    app: App,
    shown: Shown,
    commands: Vec<Command>,
    picture: egui::Rect,
}

const SCENE: &str = r#"(
    entities: {
        "sun": ( DirectionalLight: () ),
        "ball": ( Mesh: Sphere(subdivisions: 1), Subsurface: (material: Preset("skin1")) ),
        "stone": ( Mesh: Box(), Phong: () ),
    },
)"#;

fn panels(scene: &str) -> Harness<'static, Panels> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    std::fs::write(&path, scene).unwrap();
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let document = tyndall::render::load_scene(&mut app, &path, &[]);
    assert!(!document.has_errors(), "{:#?}", document.problems);
    ui::init(app.world_mut());
    app.update();
    let state = Panels { app, shown: Shown::default(), commands: Vec::new(), picture: egui::Rect::ZERO };
    let mut harness = Harness::builder().with_size(vec2(1100.0, 700.0)).build_ui_state(
        |ui, state: &mut Panels| {
            let laid = ui::panels(ui, state.app.world_mut(), &state.shown);
            state.commands.extend(laid.commands);
            state.picture = laid.picture;
        },
        state,
    );
    harness.run();
    harness
}

impl Panels {
    fn resource<R: Resource + Clone>(&self) -> R {
        self.app.world().resource::<R>().clone()
    }

    fn entity(&self, name: &str) -> Entity {
        self.app.world().resource::<SceneEntities>().0[name]
    }
}

fn commands(harness: &mut Harness<'_, Panels>) -> Vec<Command> {
    std::mem::take(&mut harness.state_mut().commands)
}

#[test]
fn the_tree_names_entities_and_their_components() {
    let mut harness = panels(SCENE);
    for name in ["ball", "stone", "sun"] {
        harness.get_by_label(name);
    }
    harness.get_by_role_and_label(egui::accesskit::Role::Button, "Scene");
    assert!(harness.query_by_label("Subsurface").is_none());
    harness.get_by_label("components of ball").click();
    harness.run();
    for component in ["Mesh", "Subsurface", "Transform"] {
        harness.get_by_label(component);
    }
    harness.get_by_label("ball").click();
    harness.run();
    assert_eq!(harness.state().resource::<Selection>().0, Some(harness.state().entity("ball")));
    harness.get_by_label("frame").click();
    harness.run();
    let ball = harness.state().entity("ball");
    assert_eq!(commands(&mut harness), [Command::Frame(Some(ball))]);
}

#[test]
fn components_of_the_selected_entity_are_changed_where_they_are_shown() {
    let mut harness = panels(SCENE);
    let sun = harness.state().entity("sun");
    harness.state_mut().app.insert_resource(Selection(Some(sun)));
    harness.run();
    let light = |harness: &Harness<Panels>| harness.state().app.world().get::<DirectionalLight>(sun).cloned();
    let before = light(&harness).unwrap();
    let from = harness.get_by_label("DirectionalLight.irradiance red").rect().center();
    harness.hover_at(from);
    harness.run();
    harness.drag_at(from);
    harness.run();
    harness.hover_at(from + vec2(60.0, 0.0));
    harness.run();
    harness.drop_at(from + vec2(60.0, 0.0));
    harness.run();
    let after = light(&harness).unwrap();
    assert!(after.irradiance.x > before.irradiance.x + 0.1, "{before:?} {after:?}");
    assert_eq!(after.direction, before.direction);
    // What is only looked at stays as it is.
    let ticks = |harness: &Harness<Panels>| {
        let world = harness.state().app.world();
        world.entity(sun).get_change_ticks::<DirectionalLight>().unwrap().changed.get()
    };
    let then = ticks(&harness);
    harness.run();
    assert_eq!(ticks(&harness), then);
}

#[test]
fn the_tree_is_filtered_by_name() {
    let mut harness = panels(SCENE);
    let field = harness.get_by_role(egui::accesskit::Role::TextInput);
    field.focus();
    harness.run();
    // Letters that are shortcuts elsewhere are letters here.
    harness.get_by_role(egui::accesskit::Role::TextInput).type_text("STo");
    harness.run();
    assert!(harness.query_by_label("stone").is_some());
    assert!(harness.query_by_label("ball").is_none());
    harness.key_press(Key::F);
    harness.run();
    assert_eq!(commands(&mut harness), []);
}

#[test]
fn errors_stand_with_the_entity_that_has_them() {
    let mut harness = panels(SCENE);
    let ball = harness.state().entity("ball");
    let problems = [
        (Some(ball), Problem::error("the ball is not round").help("inflate it")),
        (None, Problem::error("a bracket is missing")),
    ];
    harness.state_mut().app.insert_resource(SceneProblems::new(problems));
    harness.run();
    harness.get_by_label("Scene, has errors");
    harness.get_by_label("stone");
    harness.get_by_label("ball, has errors").click();
    harness.run();
    harness.get_by_label("the ball is not round");
    harness.get_by_label("inflate it");
}

#[test]
fn scattering_is_switched_for_everything_and_for_one_entity() {
    let mut harness = panels(SCENE);
    show_only_scattering(&mut harness);
    harness.get_by_label("Scattering in the scene").click();
    harness.run();
    assert_eq!(harness.state().resource::<SceneSettings>().shading, Shading::Local);
    harness.get_by_label("Scattering in the scene").click();
    harness.run();
    assert_eq!(harness.state().resource::<SceneSettings>().shading, Shading::Scattering);

    let (ball, stone) = (harness.state().entity("ball"), harness.state().entity("stone"));
    harness.state_mut().app.insert_resource(Selection(Some(stone)));
    harness.run();
    assert!(harness.query_by_label("local").is_none(), "nothing of a stone scatters");
    harness.state_mut().app.insert_resource(Selection(Some(ball)));
    harness.run();
    harness.get_by_label("local").click();
    harness.run();
    assert_eq!(harness.state().app.world().get::<Shading>(ball), Some(&Shading::Local));
    harness.get_by_label("as the scene").click();
    harness.run();
    assert_eq!(harness.state().app.world().get::<Shading>(ball), None);
}

#[test]
fn two_shadings_are_compared_by_a_line_that_can_be_moved() {
    let mut harness = panels(SCENE);
    harness.key_press(Key::C);
    harness.run();
    let start = Split { at: 0.5, left: Shading::Scattering, right: Shading::Local };
    assert_eq!(harness.state().resource::<Comparison>().0, Some(start));

    let picture = harness.state().picture;
    harness.drag_at(picture.center());
    harness.step();
    let to = picture.left() + 0.25 * picture.width();
    harness.hover_at(egui::pos2(to, picture.center().y));
    harness.step();
    harness.drop_at(egui::pos2(to, picture.center().y));
    harness.run();
    let at = harness.state().resource::<Comparison>().0.unwrap().at;
    assert!((at - 0.25).abs() < 0.01, "{at}");
    assert_eq!(commands(&mut harness), [], "the scene is not turned along with it");

    harness.key_press(Key::ArrowRight);
    harness.run();
    let moved = harness.state().resource::<Comparison>().0.unwrap().at;
    assert!((moved - at - 0.02).abs() < 1e-4, "{moved}");
    harness.get_by_label("Swap").click();
    harness.run();
    let swapped = harness.state().resource::<Comparison>().0.unwrap();
    assert_eq!((swapped.left, swapped.right), (Shading::Local, Shading::Scattering));
    harness.get_by_label("Compare with local shading").click();
    harness.run();
    assert_eq!(harness.state().resource::<Comparison>().0, None);
}

#[test]
fn the_picture_is_turned_moved_and_zoomed_by_pointer() {
    let mut harness = panels(SCENE);
    let middle = harness.state().picture.center();
    let height = f64::from(harness.state().picture.height());
    harness.drag_at(middle);
    harness.step();
    harness.hover_at(middle + vec2(60.0, 30.0));
    harness.step();
    harness.drop_at(middle + vec2(60.0, 30.0));
    harness.run();
    let moved = commands(&mut harness).into_iter().fold(DVec2::ZERO, |sum, command| match command {
        Command::Orbit(by) => sum + by,
        other => panic!("{other:?}"),
    });
    assert!((moved * height).distance(DVec2::new(60.0, 30.0)) < 1e-3, "{moved}");

    harness.hover_at(middle + vec2(0.0, -0.25 * height as f32));
    harness.step();
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: vec2(0.0, 30.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    harness.run();
    let mut zoomed = 1.0;
    for command in commands(&mut harness) {
        let Command::Zoom { factor, cursor } = command else { panic!("{command:?}") };
        assert!(cursor.distance(DVec2::new(0.0, 0.5)) < 1e-3, "{cursor}");
        zoomed *= factor;
    }
    assert!(zoomed < 0.99, "{zoomed}");
}

#[test]
fn everything_is_done_by_keys_too() {
    let mut harness = panels(SCENE);
    let keys = [
        (Key::F, Command::Frame(None)),
        (Key::O, Command::ToggleProjection),
        (Key::Home, Command::ResetCamera),
        (Key::F12, Command::Screenshot(PictureFile::Png)),
        (Key::Num3, Command::LookAlong(Axis::Right)),
        (Key::Num5, Command::LookAlong(Axis::Above)),
    ];
    for (key, command) in keys {
        harness.key_press(key);
        harness.run();
        assert_eq!(commands(&mut harness), [command], "{key:?}");
    }
    harness.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    harness.run();
    assert_eq!(commands(&mut harness), [Command::Screenshot(PictureFile::Exr)]);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Q);
    harness.run();
    assert_eq!(commands(&mut harness), [Command::Quit]);

    let picture =
        |harness: &Harness<'_, Panels>| harness.get_by_role(egui::accesskit::Role::Image).is_focused();
    for _ in 0..100 {
        if picture(&harness) {
            break;
        }
        harness.key_press(Key::Tab);
        harness.run();
    }
    assert!(picture(&harness), "the picture is not reached by the Tab key");
    commands(&mut harness);
    harness.key_press(Key::ArrowRight);
    harness.run();
    harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowUp);
    harness.run();
    harness.key_press(Key::Plus);
    harness.run();
    let made = commands(&mut harness);
    assert!(
        matches!(made.as_slice(), [Command::Orbit(right), Command::Pan(up), Command::Zoom { factor, .. }]
            if right.x > 0.0 && up.y < 0.0 && *factor < 1.0),
        "{made:?}"
    );
}

#[test]
fn panels_are_opened_and_closed() {
    let mut harness = panels(SCENE);
    let log = harness.state().resource::<Log>();
    log.tell(Level::Warning, "mind the gap");
    assert!(harness.query_by_label("mind the gap").is_none());
    harness.get_by_label("Log").click();
    harness.run();
    harness.get_by_label("mind the gap");
    harness.get_by_label("Report").click();
    harness.run();
    harness.get_by_label("held on the GPU");
    harness.get_by_label("Inspector").click();
    harness.run();
    assert!(harness.query_by_label("Scattering in the scene").is_none());
    let open = harness.state().resource::<OpenPanels>();
    assert_eq!(open, OpenPanels { log: true, report: true, inspector: false, ..Default::default() });
}

#[test]
fn plugins_add_sections() {
    let mut harness = panels(SCENE);
    let section = Section {
        title: "Own",
        show: |ui, world, selected| {
            let name = selected.and_then(|entity| world.get::<Name>(entity)).map_or("nobody", Name::as_str);
            ui.label(format!("this is {name}"));
        },
    };
    harness.state_mut().app.world_mut().resource_mut::<Sections>().0.push(section);
    harness.run();
    harness.get_by_label("this is nobody");
    harness.get_by_label("sun").click();
    harness.run();
    harness.get_by_label("this is sun");
}

#[test]
fn what_is_still_being_done_is_shown() {
    let mut harness = panels(SCENE);
    harness.state_mut().shown.refined = Some((5, 16));
    harness.state_mut().shown.failure = Some("the driver is asleep\nand dreams".into());
    harness.run();
    harness.get_by_label("refined 5 of 16");
    harness.get_by_label("the driver is asleep");
    harness.state_mut().shown.refined = Some((16, 16));
    harness.run();
    assert!(harness.query_by_label_contains("refined").is_none());
}

#[test]
fn ten_thousand_entities_are_scrolled_through() {
    let mut text = String::from("(entities: {");
    for index in 0..10_000 {
        text += &format!("\"light {index:05}\": ( DirectionalLight: () ),");
    }
    let mut harness = panels(&(text + "})"));
    harness.get_by_label("light 00000");
    assert!(harness.query_by_label("light 09999").is_none(), "what cannot be seen is not laid out");
    let started = std::time::Instant::now();
    for _ in 0..10 {
        harness.step();
    }
    assert!(started.elapsed().as_secs_f64() < 5.0, "{:?} for ten frames", started.elapsed());
}

/// Leaves nothing in the right panel but what switches scattering: what the inspector shows has some of the same names.
fn show_only_scattering(harness: &mut Harness<'_, Panels>) {
    let world = harness.state_mut().app.world_mut();
    world.resource_mut::<Sections>().0.retain(|section| section.title == "Scattering");
    harness.run();
}

/// Panels over a scene that can be edited, and its file.
fn editable() -> (Harness<'static, Panels>, tempfile::TempDir) {
    let mut harness = panels(SCENE);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    std::fs::write(&path, SCENE).unwrap();
    let world = harness.state_mut().app.world_mut();
    let edits = Edits::open(world, &path, &[]).unwrap();
    world.insert_resource(edits);
    harness.run();
    (harness, folder)
}

#[test]
fn shading_is_an_edit_that_can_be_undone() {
    let (mut harness, _folder) = editable();
    show_only_scattering(&mut harness);
    assert!(harness.get_by_label("Undo").accesskit_node().is_disabled());
    harness.get_by_label("Scattering in the scene").click();
    harness.run();
    let next = |harness: &Harness<'_, Panels>| harness.state().app.world().resource::<Edits>().next_undo();
    assert_eq!(harness.state().resource::<SceneSettings>().shading, Shading::Local);
    assert_eq!(next(&harness).as_deref(), Some("shading"));
    harness.get_by_label("ball").click();
    harness.run();
    harness.get_by_label("local").click();
    harness.run();
    let ball = harness.state().entity("ball");
    assert_eq!(harness.state().app.world().get::<Shading>(ball), Some(&Shading::Local));
    assert_eq!(next(&harness).as_deref(), Some("ball.Shading"));
    harness.get_by_label("as the scene").click();
    harness.run();
    assert_eq!(harness.state().app.world().get::<Shading>(ball), None);
    harness.get_by_label("not saved");
    for name in ["Undo", "Save"] {
        harness.get_by_label(name).click();
        harness.run();
    }
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.run();
    let asked = [Command::Undo, Command::Save, Command::Undo, Command::Redo, Command::Save];
    let mut found = commands(&mut harness);
    // Keys of one frame are taken in the order of what they do.
    assert_eq!(found.drain(..2).collect::<Vec<_>>(), asked[..2]);
    for command in &asked[2..] {
        assert!(found.contains(command), "{found:?}");
    }
}

#[test]
fn conflicts_are_decided_where_they_are_listed() {
    let (mut harness, folder) = editable();
    harness.get_by_label("Scattering in the scene").click();
    harness.run();
    let theirs = SCENE.replace("entities: {", "shading: Local, millimetres_per_unit: 2.0, entities: {");
    assert!(harness.query_by_label("Ours: shading").is_none());
    let reload = |harness: &mut Harness<'_, Panels>, text: &str| {
        let path = folder.path().join("scene.ron");
        std::fs::write(&path, text).unwrap();
        let world = harness.state_mut().app.world_mut();
        let registry = world.resource::<AppTypeRegistry>().clone();
        let document = SceneDocument::load(&path, &registry.read(), &[]);
        world.resource_scope(|world, mut edits: Mut<Edits>| edits.reload(world, document).unwrap());
        harness.run();
    };
    reload(&mut harness, &theirs);
    assert!(harness.query_by_label("Ours: shading").is_none(), "both have made the same of it");
    harness.state_mut().app.world_mut().resource_scope(|world, mut edits: Mut<Edits>| {
        edits.set_setting(world, "millimetres_per_unit", &5.0_f32).unwrap();
    });
    reload(&mut harness, &theirs.replace("2.0", "3.0"));
    let shown =
        |harness: &Harness<'_, Panels>| harness.state().resource::<SceneSettings>().millimetres_per_unit;
    assert_eq!(shown(&harness), 3.0);
    harness.get_by_label("Theirs: millimetres_per_unit");
    harness.get_by_label("Ours: millimetres_per_unit").click();
    harness.run();
    assert_eq!(shown(&harness), 5.0);
    assert!(harness.query_by_label("Ours: millimetres_per_unit").is_none());
}

#[test]
fn edits_of_an_earlier_run_are_offered() {
    for (answer, command) in
        [("Take back", Some(Command::Recover)), ("Delete", Some(Command::ForgetRecovered)), ("Later", None)]
    {
        let mut harness = panels(SCENE);
        assert!(harness.query_by_label("Take back").is_none());
        let folder = tempfile::tempdir().unwrap();
        let (file, kept) = (folder.path().join("s.ron"), folder.path().join("s.recovered.ron"));
        std::fs::write(&file, SCENE).unwrap();
        let world = harness.state_mut().app.world_mut();
        let edits = Edits::open(world, &file, &[]).unwrap();
        world.insert_resource(edits);
        world.insert_resource(ui::Recovered(vec![(file, kept.clone())]));
        harness.run();
        harness.get_by_label(&kept.display().to_string());
        harness.get_by_label(answer).click();
        harness.run();
        assert_eq!(commands(&mut harness), command.into_iter().collect::<Vec<_>>(), "{answer}");
        if answer == "Later" {
            assert!(harness.query_by_label("Take back").is_none());
        }
    }
}
