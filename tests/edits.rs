//! Scenes are edited while they are shown, and edits go back to the files that they came from.

#![allow(clippy::unwrap_used, reason = "a helper that cannot do its work fails the test")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tyndall::prelude::*;
use tyndall::scene::{Conflict, EditError, Edits, SaveError, SceneDocument, SceneEntities, Side};
use tyndall_turntable::TurntablePlugin;

/// A folder with scenes, one of which is edited.
struct Desk {
    folder: tempfile::TempDir,
    app: App,
    edits: Edits,
    scene: PathBuf,
}

impl Desk {
    /// With the repository's own scenes.
    fn of(scene: &str) -> Self {
        let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let folder = tempfile::tempdir().unwrap();
        copy(&from, &folder.path().join("scenes"));
        Self::open(folder, &format!("scenes/{scene}"))
    }

    fn with(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        Self::open(folder, files[0].0)
    }

    fn open(folder: tempfile::TempDir, scene: &str) -> Self {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins).add_plugins(TurntablePlugin);
        let scene = folder.path().join(scene);
        let edits =
            Edits::open(app.world_mut(), &scene, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        Self { folder, app, edits, scene }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn try_set(&mut self, entity: &str, path: &str, value: impl Reflect) -> Result<(), EditError> {
        self.edits.set(self.app.world_mut(), entity, path, value.as_partial_reflect())
    }

    fn set(&mut self, entity: &str, path: &str, value: impl Reflect) {
        self.try_set(entity, path, value).unwrap_or_else(|error| panic!("{entity}.{path}: {error}"));
    }

    fn undo(&mut self) -> bool {
        self.edits.undo(self.app.world_mut()).unwrap()
    }

    fn redo(&mut self) -> bool {
        self.edits.redo(self.app.world_mut()).unwrap()
    }

    fn save(&mut self) -> Vec<PathBuf> {
        let saved = self.edits.save(self.app.world_mut()).unwrap_or_else(|error| panic!("{error}"));
        assert!(!self.edits.is_unsaved());
        saved
    }

    /// Takes in what the files say now, and gives the number of new conflicts.
    fn reload(&mut self) -> usize {
        let registry = self.app.world().resource::<AppTypeRegistry>().clone();
        let document = SceneDocument::load(&self.scene, &registry.read(), &[]);
        self.edits.reload(self.app.world_mut(), document).unwrap_or_else(|problems| panic!("{problems:?}"))
    }

    fn resolve(&mut self, side: Side) {
        let id = self.edits.conflicts()[0].id;
        self.edits.resolve(self.app.world_mut(), id, side).unwrap_or_else(|error| panic!("{error}"));
    }

    fn get<T: Component + Clone>(&self, entity: &str) -> T {
        let entity = self.app.world().resource::<SceneEntities>().0[entity];
        self.app.world().get::<T>(entity).cloned().unwrap()
    }

    fn is_unsaved_at(&mut self, entity: &str, path: &str) -> bool {
        self.edits.is_unsaved_at(self.app.world_mut(), Some(entity), path)
    }

    /// What the world's scene is, as text: every reflected component of every entity, and the head.
    fn world(&self) -> BTreeMap<String, String> {
        described(self.app.world())
    }

    /// The same of a world that just read the files.
    fn fresh(&self) -> BTreeMap<String, String> {
        let mut app = App::new();
        app.add_plugins(TyndallPlugins).add_plugins(TurntablePlugin);
        Edits::open(app.world_mut(), &self.scene, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        described(app.world())
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        match entry.file_type().unwrap().is_dir() {
            true => copy(&entry.path(), &to.join(entry.file_name())),
            false => drop(fs::copy(entry.path(), to.join(entry.file_name())).unwrap()),
        }
    }
}

fn described(world: &World) -> BTreeMap<String, String> {
    let registry = world.resource::<AppTypeRegistry>().read();
    let mut all = BTreeMap::new();
    all.insert(String::new(), format!("{:?}", world.resource::<SceneSettings>()));
    for (name, entity) in &world.resource::<SceneEntities>().0 {
        let entity = world.entity(*entity);
        let components = registry.iter_with_data::<ReflectComponent>();
        let mut values: Vec<String> = components
            .filter_map(|(_, component)| Some(format!("{:?}", component.reflect(entity)?)))
            .collect();
        values.sort_unstable();
        all.insert(name.clone(), values.join("\n"));
    }
    all
}

/// The lines in which two texts differ, `-` for the first and `+` for the second; of equal parts nothing.
fn difference(before: &str, after: &str) -> String {
    let (before, after): (Vec<_>, Vec<_>) = (before.lines().collect(), after.lines().collect());
    let start = before.iter().zip(&after).take_while(|(a, b)| a == b).count();
    let most = before.len().min(after.len()) - start;
    let end = before.iter().rev().zip(after.iter().rev()).take(most).take_while(|(a, b)| a == b).count();
    let gone = before[start..before.len() - end].iter().map(|line| format!("-{}", line.trim_start()));
    let come = after[start..after.len() - end].iter().map(|line| format!("+{}", line.trim_start()));
    gone.chain(come).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_value_is_exchanged_and_all_else_stays_byte_for_byte() {
    let mut desk = Desk::of("showcase.ron");
    let before = desk.text("scenes/showcase.ron");
    desk.set("lotus", "ScatteringMaps.samples", 64_u32);
    assert_eq!(desk.get::<ScatteringMaps>("lotus").samples, 64);
    assert_eq!(desk.text("scenes/showcase.ron"), before, "not saved yet");
    assert_eq!(desk.save(), [desk.path("scenes/showcase.ron")]);
    let after = desk.text("scenes/showcase.ron");
    assert_eq!(after, before.replace("(samples: 256)", "(samples: 64)"));
    desk.set("pond", "Phong.diffuse", Vec3::new(0.0015, 0.25, 0.017));
    desk.save();
    let expected = after.replace("diffuse: (0.0015, 0.009, 0.017)", "diffuse: (0.0015, 0.25, 0.017)");
    assert_eq!(desk.text("scenes/showcase.ron"), expected, "0.0020 beside it keeps its digits");
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn what_was_not_written_is_added_in_the_style_of_its_neighbours() {
    let mut desk = Desk::of("showcase.ron");
    let before = desk.text("scenes/showcase.ron");
    desk.set("eye", "ViewCamera.exposure", 0.5_f32);
    desk.set("pad left", "Mesh.subdivisions", 3_u32);
    desk.set("lotus", "Subsurface.model", DipoleModel::StandardDipole);
    desk.edits.add_component(desk.app.world_mut(), "molecule", &Shading::Local).unwrap();
    desk.edits.add_component(desk.app.world_mut(), "sunset", &Transform::default()).unwrap();
    desk.edits.set_setting(desk.app.world_mut(), "shading", &Shading::Local).unwrap();
    let pebble = Phong { shininess: 8.0, ..Phong::default() };
    let parts: [&dyn Reflect; 2] = [&Mesh::Sphere { radius: 0.25, subdivisions: 5 }, &pebble];
    desk.edits.add_entity(desk.app.world_mut(), "pebble", &parts).unwrap();
    desk.save();
    let after = desk.text("scenes/showcase.ron");
    let expected = before
        .replace("vertical_fov: 33.0)) )", "vertical_fov: 33.0), exposure: 0.5) )")
        .replacen("Mesh: Sphere(), Phong: (diffuse: (0.008", "Mesh: Sphere(subdivisions: 3), Phong: (diffuse: (0.008", 1)
        .replace(
            "                specular: Some((strength: 0.05, shininess: 40.0)),\n",
            "                specular: Some((strength: 0.05, shininess: 40.0)),\n                model: StandardDipole,\n",
        )
        .replace("            RayCast: (step: 0.25),\n", "            RayCast: (step: 0.25),\n            Shading: Local,\n")
        .replace("irradiance: (10.0, 7.8, 6.2)) )", "irradiance: (10.0, 7.8, 6.2)), Transform: () )")
        .replace("    background: (0.004, 0.006, 0.012),\n", "    background: (0.004, 0.006, 0.012),\n    shading: Local,\n")
        .replace(
            "        ),\n    },\n)",
            "        ),\n        \"pebble\": ( Mesh: Sphere(radius: 0.25), Phong: (shininess: 8.0) ),\n    },\n)",
        );
    assert_eq!(after, expected, "{}", difference(&expected, &after));
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn what_is_taken_away_leaves_the_comments_around_it() {
    let mut desk = Desk::of("showcase.ron");
    let before = desk.text("scenes/showcase.ron");
    let world = desk.app.world_mut();
    desk.edits.remove_entity(world, "sunset").unwrap();
    desk.edits.remove_entity(world, "adrift").unwrap();
    desk.edits.remove_component(world, "lotus", "ScatteringMaps").unwrap();
    desk.edits.remove_component(world, "pad far", "Phong").unwrap();
    desk.save();
    let after = desk.text("scenes/showcase.ron");
    let adrift = before.find("        \"adrift\"").unwrap()..before.rfind("    },\n)").unwrap();
    let mut expected = before;
    expected.replace_range(adrift, "");
    let expected = expected
        .replace("        \"sunset\": ( DirectionalLight: (direction: (-0.5, -0.5, 0.9), irradiance: (10.0, 7.8, 6.2)) ),\n", "")
        .replace("            ScatteringMaps: (samples: 256),\n", "")
        .replace(
            "Mesh: Sphere(), Phong: (diffuse: (0.009, 0.040, 0.015), specular: (0.003, 0.004, 0.003), shininess: 40.0),",
            "Mesh: Sphere(),",
        );
    assert_eq!(after, expected, "{}", difference(&expected, &after));
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn points_of_a_transfer_function_come_and_go_one_by_one() {
    let mut desk = Desk::of("showcase.ron");
    let before = desk.text("scenes/transfer_functions/frost.ron");
    let mut points = desk.get::<TransferFunction>("adrift").points;
    points.insert(2, ControlPoint(0.3, Vec3::new(0.5, 0.5, 0.5), 0.1));
    points.remove(3);
    points[1].2 = 0.08;
    points.push(ControlPoint(1.0, Vec3::ONE, 1.0));
    desk.set("adrift", "TransferFunction.points", points.clone());
    assert_eq!(desk.get::<TransferFunction>("drifting").points, points, "the other one that uses the file");
    assert!(desk.is_unsaved_at("drifting", "TransferFunction.points[1].2"));
    assert!(
        desk.is_unsaved_at("drifting", "") && !desk.is_unsaved_at("drifting", "TransferFunction.entries")
    );
    assert!(!desk.is_unsaved_at("molecule", ""));
    assert_eq!(desk.save(), [desk.path("scenes/transfer_functions/frost.ron")]);
    let expected = before
        .replace("(0.22, (0.10, 0.45, 0.85), 0.04)", "(0.22, (0.10, 0.45, 0.85), 0.08)")
        .replace("(0.45, (0.25, 0.75, 0.95), 0.20)", "(0.3, (0.5, 0.5, 0.5), 0.1)")
        .replace("1.00), 0.90),\n", "1.00), 0.90),\n        (1.0, (1.0, 1.0, 1.0), 1.0),\n");
    let after = desk.text("scenes/transfer_functions/frost.ron");
    assert_eq!(after, expected, "{}", difference(&expected, &after));
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn each_edit_goes_to_the_file_that_it_came_from() {
    let mut desk = Desk::of("overlapping_volumes.ron");
    let unsaved = |desk: &mut Desk| {
        let preview = desk.edits.preview(desk.app.world_mut()).unwrap();
        preview
            .into_keys()
            .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
            .collect::<Vec<_>>()
    };
    assert!(unsaved(&mut desk).is_empty());
    desk.set("key light", "DirectionalLight.irradiance", Vec3::ONE);
    assert_eq!(unsaved(&mut desk), ["studio.ron"]);
    desk.set("eye", "ViewCamera.gamma", 2.0_f32);
    let mist = SceneDocument::load(&desk.scene, &desk.app.world().resource::<AppTypeRegistry>().read(), &[]);
    let misty = mist.entities.iter().find(|entity| {
        entity.place_of("TransferFunction").file.path().ends_with("transfer_functions/mist.ron")
    });
    let misty = misty.unwrap().name.clone();
    desk.set(&misty, "TransferFunction.entries", 64_u32);
    assert_eq!(unsaved(&mut desk), ["overlapping_volumes.ron", "studio.ron", "mist.ron"]);
    let before =
        ["studio.ron", "transfer_functions/mist.ron"].map(|name| desk.text(&format!("scenes/{name}")));
    desk.save();
    let after =
        ["studio.ron", "transfer_functions/mist.ron"].map(|name| desk.text(&format!("scenes/{name}")));
    assert_eq!(after[0], before[0].replace("(3.1, 2.8, 2.4)", "(1.0, 1.0, 1.0)"));
    assert_eq!(after[1], before[1].replace("    ],\n)", "    ],\n    entries: 64,\n)"));
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn undo_and_redo_walk_through_every_kind_of_edit() {
    let mut desk = Desk::of("scattering_maps.ron");
    let first = desk.world();
    let mut states = vec![first.clone()];
    let name = desk.edits.document().entities.iter().find(|entity| entity.is_written("Subsurface")).unwrap();
    let name = name.name.clone();
    for step in 0..8 {
        let world = desk.app.world_mut();
        let edits = &mut desk.edits;
        match step {
            0 => edits.set(world, &name, "Subsurface.local.shininess", &3.0_f32).unwrap(),
            1 => edits.set(world, &name, "Subsurface.material", &Material::Preset("wax".into())).unwrap(),
            2 => edits.add_entity(world, "new", &[&Mesh::CornellBox]).unwrap(),
            3 => edits.rename_entity(world, &name, "renamed").unwrap(),
            4 => edits.set(world, "renamed", "Subsurface.specular", &None::<Specular>).unwrap(),
            5 => edits.remove_component(world, "renamed", "ScatteringMaps").unwrap(),
            6 => edits.remove_entity(world, "new").unwrap(),
            _ => edits.set_setting(world, "background", &Vec3::X).unwrap(),
        }
        if desk.world() != *states.last().unwrap() {
            states.push(desk.world());
        }
    }
    assert_eq!(states.len(), 9, "each of the eight changed something");
    for state in states.iter().rev().skip(1) {
        assert!(desk.undo());
        assert_eq!(desk.world(), *state);
    }
    assert!(!desk.undo() && !desk.edits.is_unsaved(), "back at the start nothing is unsaved");
    for state in &states[1..] {
        assert!(desk.redo());
        assert_eq!(desk.world(), *state);
    }
    assert!(!desk.redo());
    desk.save();
    assert_eq!(desk.world(), desk.fresh());
    while desk.undo() {}
    assert_eq!(desk.world(), first);
    desk.save();
    assert_eq!(desk.fresh(), first, "undone after it was saved, and saved again");
}

#[test]
fn a_drag_is_one_step() {
    let mut desk = Desk::of("showcase.ron");
    desk.set("lotus", "ScatteringMaps.samples", 64_u32);
    desk.edits.begin_drag();
    for radius in 1..=20 {
        desk.set("lotus", "Transform.scale", Scale::Uniform(radius as f32));
    }
    desk.edits.end_drag();
    desk.set("lotus", "Transform.scale", Scale::Uniform(0.5));
    assert_eq!(desk.edits.next_undo().as_deref(), Some("lotus.Transform.scale"));
    assert!(desk.undo());
    assert_eq!(desk.get::<Transform>("lotus").scale, Scale::Uniform(20.0));
    assert!(desk.undo());
    assert_eq!(desk.get::<Transform>("lotus").scale, Scale::Uniform(1.4));
    assert_eq!(desk.edits.next_undo().as_deref(), Some("lotus.ScatteringMaps.samples"));
    assert_eq!(desk.edits.next_redo().as_deref(), Some("lotus.Transform.scale"));
    desk.edits.begin_drag();
    desk.set("lotus", "Transform.scale", Scale::Uniform(3.0));
    desk.set("lotus", "Transform.scale", Scale::Uniform(1.4));
    desk.edits.end_drag();
    assert_eq!(desk.edits.next_undo().as_deref(), Some("lotus.ScatteringMaps.samples"), "dragged back");
}

#[test]
fn a_drag_of_what_no_file_says_is_one_step_too() {
    let mut desk = Desk::with(&[("scene.ron", "(entities: { \"ball\": ( Mesh: Sphere() ) })")]);
    let first = desk.world();
    desk.edits.begin_drag();
    desk.edits.add_component(desk.app.world_mut(), "ball", &Transform::default()).unwrap();
    for tenths in 1..=20 {
        desk.set("ball", "Transform.scale", Scale::Uniform(tenths as f32 / 10.0));
    }
    desk.edits.end_drag();
    assert_eq!(desk.get::<Transform>("ball").scale, Scale::Uniform(2.0));
    assert!(desk.undo());
    assert_eq!(desk.world(), first);
    assert!(!desk.undo());
}

#[test]
fn only_what_an_edit_changes_counts_as_changed() {
    let mut desk = Desk::of("showcase.ron");
    let changed = |desk: &mut Desk| {
        let world = desk.app.world_mut();
        let mut found = Vec::new();
        let mut transforms = world.query_filtered::<&Name, Changed<Transform>>();
        found.extend(transforms.iter(world).map(|name| format!("{name} Transform")));
        let mut functions = world.query_filtered::<&Name, Changed<TransferFunction>>();
        found.extend(functions.iter(world).map(|name| format!("{name} TransferFunction")));
        let mut surfaces = world.query_filtered::<&Name, Changed<Subsurface>>();
        found.extend(surfaces.iter(world).map(|name| format!("{name} Subsurface")));
        let mut meshes = world.query_filtered::<&Name, Changed<Mesh>>();
        found.extend(meshes.iter(world).map(|name| format!("{name} Mesh")));
        let mut names = world.query_filtered::<&Name, Changed<Name>>();
        found.extend(names.iter(world).map(|name| format!("{name} Name")));
        found.extend(world.is_resource_changed::<SceneSettings>().then(|| "head".to_owned()));
        world.clear_trackers();
        found.sort_unstable();
        found
    };
    changed(&mut desk);
    desk.set("lotus", "Transform.scale", Scale::Uniform(1.4));
    assert!(changed(&mut desk).is_empty() && desk.edits.next_undo().is_none(), "the same value");
    desk.set("lotus", "Transform.scale", 2.0_f32);
    assert_eq!(changed(&mut desk), ["lotus Transform"]);
    desk.set("drifting", "TransferFunction.entries", 64_u32);
    assert_eq!(changed(&mut desk), ["adrift TransferFunction", "drifting TransferFunction"]);
    let lotus = desk.app.world().resource::<SceneEntities>().0["lotus"];
    desk.edits.rename_entity(desk.app.world_mut(), "lotus", "rose").unwrap();
    assert_eq!(changed(&mut desk), ["rose Name"]);
    assert_eq!(desk.app.world().resource::<SceneEntities>().0["rose"], lotus);
    desk.undo();
    assert_eq!(changed(&mut desk), ["lotus Name"]);
    desk.save();
    assert!(changed(&mut desk).is_empty());
}

#[test]
fn an_edit_that_makes_no_scene_changes_nothing() {
    let mut desk = Desk::of("scattering_maps.ron");
    let before = desk.world();
    let mesh = desk.edits.document().entities.iter().find(|entity| entity.is_written("Subsurface")).unwrap();
    let mesh = mesh.name.clone();
    let told = |error: Result<(), EditError>| error.unwrap_err().to_string();
    let cases = [
        (
            told(desk.try_set(&mesh, "Subsurface.local.shininess", -1.0_f32)),
            "`shininess` must be from 0 to 10000, found `-1`",
        ),
        (told(desk.try_set(&mesh, "Subsurface.local.shininess", f32::NAN)), "`shininess`"),
        (told(desk.try_set(&mesh, "Subsurface.local.shininess", 1.0_f64)), "is a `f32`, not a `f64`"),
        (
            told(desk.try_set(&mesh, "Subsurface.material", Material::Preset("granit".into()))),
            "there is no medium `granit`",
        ),
        (told(desk.try_set(&mesh, "Subsurface.material.g", 0.5_f32)), "has no `Subsurface.material.g`"),
        (told(desk.try_set(&mesh, "Subsurface[", 0.5_f32)), "has no `Subsurface[`"),
        (told(desk.try_set(&mesh, "", 0.5_f32)), "has no ``"),
        (told(desk.try_set("nobody", "Mesh", Mesh::CornellBox)), "no entity `nobody`"),
        (
            told(desk.edits.set_setting(desk.app.world_mut(), "background", &Vec3::NEG_X)),
            "`background` must be at least 0",
        ),
        (
            told(desk.edits.set_setting(desk.app.world_mut(), "", &SceneSettings::default())),
            "the head of the scene",
        ),
        (
            told(desk.edits.add_component(desk.app.world_mut(), &mesh, &Mesh::CornellBox)),
            "has a `Mesh` already",
        ),
        (told(desk.edits.add_component(desk.app.world_mut(), &mesh, &1.0_f32)), "no component of scenes"),
        (told(desk.edits.remove_component(desk.app.world_mut(), &mesh, "Volume")), "has no `Volume`"),
        (told(desk.edits.add_entity(desk.app.world_mut(), &mesh, &[])), "there is an entity"),
        (told(desk.edits.rename_entity(desk.app.world_mut(), &mesh, "eye")), "there is an entity `eye`"),
        (told(desk.edits.remove_entity(desk.app.world_mut(), "nobody")), "no entity `nobody`"),
    ];
    for (told, expected) in &cases {
        assert!(told.contains(expected), "{told}");
    }
    assert_eq!(desk.world(), before);
    assert!(!desk.edits.is_unsaved() && desk.edits.next_undo().is_none());
}

/// Two translucent balls of one material, and a camera that names one of them.
const BALLS: &[(&str, &str)] = &[
    (
        "scene.ron",
        r#"(
    // What all of it stands in front of.
    background: (0.1, 0.2, 0.3),
    include: ["more.ron"],
    entities: {
        "ball": ( Mesh: Sphere(radius: 2.0), Subsurface: File("materials/jade.ron") ), // round
        "from above": ( ScatteringCamera: (target: "ball", direction: (0.0, -1.0, 0.0)) ),
    },
)"#,
    ),
    (
        "more.ron",
        r#"(entities: { "bowl": ( Mesh: Box(), Subsurface: File("./materials/jade.ron"), Phong: (shininess: 8.0) ) })"#,
    ),
    (
        "materials/jade.ron",
        "// Jade, made up.\n(material: Custom(sigma_a: (0.1, 0.2, 0.3), sigma_s: (1.0, 2.0, 3.0)))\n",
    ),
];

#[test]
fn a_new_name_is_written_wherever_the_entity_is_named() {
    let mut desk = Desk::with(BALLS);
    let told = desk.edits.remove_entity(desk.app.world_mut(), "ball").unwrap_err().to_string();
    assert!(told.contains("there is no entity `ball`"), "{told}");
    let before = desk.text("scene.ron");
    desk.edits.rename_entity(desk.app.world_mut(), "ball", "a \"ball\"").unwrap();
    assert_eq!(desk.get::<ScatteringCamera>("from above").target, "a \"ball\"");
    desk.save();
    assert_eq!(desk.text("scene.ron"), before.replace("\"ball\"", r#""a \"ball\"""#));
    assert!(desk.undo());
    desk.save();
    assert_eq!(desk.text("scene.ron"), before);
}

#[test]
fn a_shared_material_is_changed_in_its_file_for_all() {
    let mut desk = Desk::with(BALLS);
    desk.set("bowl", "Subsurface.material.sigma_s", Vec3::new(1.0, 2.5, 3.0));
    desk.set("ball", "Subsurface.material.g", 0.5_f32);
    assert_eq!(desk.get::<Subsurface>("ball"), desk.get::<Subsurface>("bowl"));
    assert!(desk.is_unsaved_at("ball", "Subsurface.material.sigma_s"));
    assert!(!desk.is_unsaved_at("ball", "Subsurface.material.sigma_a"));
    desk.save();
    let jade =
        "// Jade, made up.\n(material: Custom(sigma_a: (0.1, 0.2, 0.3), sigma_s: (1.0, 2.5, 3.0), g: 0.5))\n";
    assert_eq!(desk.text("materials/jade.ron"), jade);
    assert_eq!(desk.world(), desk.fresh());
    // Taken away and put back, it is still kept in its file.
    let before = desk.text("more.ron");
    desk.edits.remove_component(desk.app.world_mut(), "bowl", "Subsurface").unwrap();
    desk.save();
    assert_eq!(desk.text("more.ron"), before.replace("Subsurface: File(\"./materials/jade.ron\"), ", ""));
    desk.undo();
    desk.save();
    assert!(
        desk.text("more.ron")
            .contains("Phong: (shininess: 8.0), Subsurface: File(\"./materials/jade.ron\") )")
    );
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn edits_survive_a_reload_of_other_fields() {
    let mut desk = Desk::with(BALLS);
    desk.set("ball", "Mesh.radius", 3.0_f32);
    desk.set("bowl", "Phong.diffuse", Vec3::X);
    desk.set("ball", "Subsurface.material.g", 0.5_f32);
    desk.edits.set_setting(desk.app.world_mut(), "millimetres_per_unit", &10.0_f32).unwrap();
    desk.edits.rename_entity(desk.app.world_mut(), "ball", "globe").unwrap();
    // Somebody else saves what has nothing to do with it, in the same entities, components and files.
    let moved = desk
        .text("scene.ron")
        .replace("(0.1, 0.2, 0.3),\n", "(0.5, 0.2, 0.3),\n")
        .replace("radius: 2.0", "subdivisions: 4, radius: 2.0");
    desk.write("scene.ron", &format!("// Hello.\n{moved}"));
    desk.write("more.ron", &desk.text("more.ron").replace("shininess: 8.0", "shininess: 9.0"));
    desk.write("materials/jade.ron", &desk.text("materials/jade.ron").replace("0.3)", "0.4)"));
    assert_eq!(desk.reload(), 0);
    assert_eq!(desk.get::<Mesh>("globe"), Mesh::Sphere { radius: 3.0, subdivisions: 4 });
    let phong = desk.get::<Phong>("bowl");
    assert_eq!((phong.diffuse, phong.shininess), (Vec3::X, 9.0));
    let Material::Custom { sigma_a, g, .. } = desk.get::<Subsurface>("bowl").material else { panic!() };
    assert_eq!((sigma_a, g), (Some(Vec3::new(0.1, 0.2, 0.4)), 0.5));
    assert_eq!(desk.app.world().resource::<SceneSettings>().background.x, 0.5);
    desk.save();
    let text = desk.text("scene.ron");
    assert!(
        text.starts_with("// Hello.\n(\n    // What all of it")
            && text.contains("subdivisions: 4, radius: 3.0"),
        "{text}"
    );
    assert_eq!(desk.world(), desk.fresh());
    // Undone one by one, what somebody else did stays.
    while desk.undo() {}
    assert_eq!(desk.get::<Mesh>("ball"), Mesh::Sphere { radius: 2.0, subdivisions: 4 });
    assert_eq!(desk.get::<Phong>("bowl").shininess, 9.0);
    desk.save();
    assert_eq!(
        desk.text("scene.ron").replace("    millimetres_per_unit: 1.0,\n", ""),
        format!("// Hello.\n{moved}")
    );
}

#[test]
fn the_same_field_changed_on_both_sides_is_a_conflict_until_somebody_chooses() {
    for side in [Side::Ours, Side::Theirs] {
        let mut desk = Desk::with(BALLS);
        desk.set("ball", "Mesh.radius", 3.0_f32);
        desk.set("bowl", "Phong.shininess", 32.0_f32);
        desk.write("scene.ron", &desk.text("scene.ron").replace("radius: 2.0", "radius: 5.0"));
        assert_eq!(desk.reload(), 1);
        let registry = desk.app.world().resource::<AppTypeRegistry>().clone();
        let text = |desk: &Desk, version: fn(&Conflict) -> &tyndall::scene::Version| {
            version(&desk.edits.conflicts()[0]).text(&registry.read())
        };
        let conflict = &desk.edits.conflicts()[0];
        assert_eq!((conflict.entity.as_deref(), conflict.path.as_str()), (Some("ball"), "Mesh.radius"));
        let versions = [text(&desk, |c| &c.was), text(&desk, |c| &c.ours), text(&desk, |c| &c.theirs)];
        assert_eq!(versions, ["2.0", "3.0", "5.0"]);
        assert_eq!(desk.get::<Mesh>("ball"), Mesh::Sphere { radius: 5.0, subdivisions: 5 }, "the file's");
        assert!(desk.edits.is_unsaved());
        let error = desk.edits.save(desk.app.world_mut()).unwrap_err();
        assert!(matches!(error, SaveError::Conflicts { count: 1 }), "{error}");
        // The file changes once more.
        desk.write("scene.ron", &desk.text("scene.ron").replace("radius: 5.0", "radius: 6.0"));
        assert_eq!((desk.reload(), desk.edits.conflicts().len()), (0, 1));
        assert_eq!(text(&desk, |c| &c.theirs), "6.0");
        desk.resolve(side);
        assert!(desk.edits.conflicts().is_empty());
        let radius = if side == Side::Ours { 3.0 } else { 6.0 };
        assert_eq!(desk.get::<Mesh>("ball"), Mesh::Sphere { radius, subdivisions: 5 });
        desk.save();
        assert!(desk.text("scene.ron").contains(&format!("radius: {radius:?}")));
        assert!(desk.text("more.ron").contains("shininess: 32.0"));
        assert!(matches!(desk.edits.resolve(desk.app.world_mut(), 1, side), Err(EditError::NoConflict)));
    }
}

#[test]
fn a_conflict_ends_when_the_file_says_what_the_edit_did() {
    let mut desk = Desk::with(BALLS);
    desk.set("ball", "Mesh.radius", 3.0_f32);
    let before = desk.text("scene.ron");
    desk.write("scene.ron", &before.replace("radius: 2.0", "radius: 5.0"));
    assert_eq!(desk.reload(), 1);
    desk.write("scene.ron", &before.replace("radius: 2.0", "radius: 3.0"));
    assert_eq!(desk.reload(), 0);
    assert!(desk.edits.conflicts().is_empty() && !desk.edits.is_unsaved());
    // The same edit on both sides is none either.
    desk.set("bowl", "Phong.shininess", 4.0_f32);
    desk.write("more.ron", &desk.text("more.ron").replace("8.0", "4.0"));
    assert_eq!(desk.reload(), 0);
    assert!(!desk.edits.is_unsaved());
}

#[test]
fn an_edit_of_what_is_gone_is_a_conflict() {
    let cases: [(&str, &str, &str); 4] = [
        ("more.ron", r#"(entities: {})"#, ""),
        ("more.ron", r#"(entities: { "bowl": ( Mesh: Box() ) })"#, "Phong"),
        (
            "more.ron",
            r#"(entities: { "dish": ( Mesh: Box(), Subsurface: File("./materials/jade.ron"), Phong: (shininess: 8.0) ) })"#,
            "",
        ),
        ("scene.ron", r#"(entities: { "x": () })"#, ""),
    ];
    for (file, text, path) in cases {
        let mut desk = Desk::with(BALLS);
        desk.set("bowl", "Phong.shininess", 32.0_f32);
        desk.write(file, text);
        assert_eq!(desk.reload(), 1, "{text}");
        let conflict = &desk.edits.conflicts()[0];
        assert_eq!((conflict.entity.as_deref(), conflict.path.as_str()), (Some("bowl"), path));
        assert!(conflict.theirs.is_nothing() && !conflict.ours.is_nothing() && !conflict.was.is_nothing());
        assert_eq!(desk.world(), desk.fresh());
        if file == "scene.ron" {
            // What it was kept with is gone too, so it comes with all that it had.
            desk.resolve(Side::Ours);
            assert_eq!(desk.get::<Phong>("bowl").shininess, 32.0);
            desk.save();
            assert!(desk.text("scene.ron").contains("\"bowl\": ("), "{}", desk.text("scene.ron"));
        } else {
            desk.resolve(Side::Ours);
            assert_eq!(desk.get::<Phong>("bowl").shininess, 32.0);
            desk.save();
        }
        assert_eq!(desk.world(), desk.fresh());
    }
}

#[test]
fn what_was_removed_here_and_changed_there_is_a_conflict() {
    for side in [Side::Ours, Side::Theirs] {
        let mut desk = Desk::with(BALLS);
        desk.edits.remove_entity(desk.app.world_mut(), "bowl").unwrap();
        desk.edits.remove_component(desk.app.world_mut(), "from above", "ScatteringCamera").unwrap();
        desk.write("more.ron", &desk.text("more.ron").replace("8.0", "9.0"));
        assert_eq!(desk.reload(), 1);
        assert_eq!(desk.get::<Phong>("bowl").shininess, 9.0);
        desk.write("scene.ron", &desk.text("scene.ron").replace("-1.0", "-2.0"));
        assert_eq!(desk.reload(), 1);
        assert_eq!(desk.edits.conflicts()[1].path, "ScatteringCamera");
        desk.resolve(side);
        desk.resolve(side);
        desk.save();
        let fresh = desk.fresh();
        assert_eq!(desk.world(), fresh);
        assert_eq!(fresh.contains_key("bowl"), side == Side::Theirs);
        assert_eq!(fresh["from above"].contains("ScatteringCamera"), side == Side::Theirs);
    }
}

#[test]
fn sides_that_do_not_fit_together_are_a_conflict() {
    // The file takes the camera's target away; the name of a medium and its coefficients exclude each other.
    let mut desk = Desk::with(BALLS);
    let camera = ScatteringCamera { target: "bowl".into(), direction: Vec3::Y };
    desk.edits.add_entity(desk.app.world_mut(), "from below", &[&camera]).unwrap();
    desk.set("ball", "Mesh.radius", 7.0_f32);
    desk.write("more.ron", "(entities: {})");
    assert_eq!(desk.reload(), 1);
    assert_eq!(desk.edits.conflicts()[0].entity.as_deref(), Some("from below"));
    assert_eq!(
        desk.get::<Mesh>("ball"),
        Mesh::Sphere { radius: 7.0, subdivisions: 5 },
        "the other edit stays"
    );
    let id = desk.edits.conflicts()[0].id;
    let error = desk.edits.resolve(desk.app.world_mut(), id, Side::Ours).unwrap_err().to_string();
    assert!(error.contains("there is no entity `bowl`") && desk.edits.conflicts().len() == 1, "{error}");
    desk.resolve(Side::Theirs);
    desk.save();
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn two_new_entities_of_one_name_are_a_conflict() {
    let mut desk = Desk::with(BALLS);
    desk.edits.add_entity(desk.app.world_mut(), "cube", &[&Mesh::Box { size: Vec3::ONE }]).unwrap();
    desk.edits.rename_entity(desk.app.world_mut(), "bowl", "dish").unwrap();
    let text = desk.text("scene.ron");
    desk.write(
        "scene.ron",
        &text.replace(
            "    },\n)",
            "        \"cube\": ( Mesh: CornellBox ),\n        \"dish\": (),\n    },\n)",
        ),
    );
    assert_eq!(desk.reload(), 2);
    assert_eq!(
        (desk.get::<Mesh>("cube"), desk.get::<Mesh>("bowl")),
        (Mesh::CornellBox, Mesh::Box { size: Vec3::ONE })
    );
    let dish =
        desk.edits.conflicts().iter().find(|conflict| conflict.entity.as_deref() == Some("bowl")).unwrap().id;
    assert!(matches!(
        desk.edits.resolve(desk.app.world_mut(), dish, Side::Ours),
        Err(EditError::NameTaken { .. })
    ));
    desk.edits.resolve(desk.app.world_mut(), dish, Side::Theirs).unwrap();
    desk.resolve(Side::Ours);
    assert_eq!(desk.get::<Mesh>("cube"), Mesh::Box { size: Vec3::ONE });
    desk.save();
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn an_undo_of_what_somebody_else_has_changed_is_left_out() {
    let mut desk = Desk::with(BALLS);
    desk.set("bowl", "Phong.shininess", 32.0_f32);
    desk.set("ball", "Mesh.radius", 3.0_f32);
    desk.save();
    desk.write("scene.ron", &desk.text("scene.ron").replace("radius: 3.0", "radius: 5.0"));
    assert_eq!(desk.reload(), 0, "it was saved");
    let error = desk.edits.undo(desk.app.world_mut()).unwrap_err();
    assert!(matches!(error, EditError::Overtaken { .. }), "{error}");
    assert_eq!(desk.get::<Mesh>("ball"), Mesh::Sphere { radius: 5.0, subdivisions: 5 });
    assert!(desk.undo());
    assert_eq!(desk.get::<Phong>("bowl").shininess, 8.0);
}

#[test]
fn saving_merges_with_what_was_saved_since() {
    let mut desk = Desk::with(BALLS);
    desk.set("ball", "Mesh.radius", 3.0_f32);
    let theirs = desk.text("scene.ron").replace("(0.1, 0.2, 0.3)", "(0.9, 0.2, 0.3)");
    desk.write("scene.ron", &theirs);
    desk.save();
    assert_eq!(desk.text("scene.ron"), theirs.replace("radius: 2.0", "radius: 3.0"));
    assert_eq!(desk.app.world().resource::<SceneSettings>().background.x, 0.9);
    desk.set("ball", "Mesh.radius", 4.0_f32);
    desk.write("scene.ron", &theirs);
    let error = desk.edits.save(desk.app.world_mut()).unwrap_err();
    assert!(matches!(error, SaveError::Conflicts { count: 1 }), "{error}");
    assert_eq!(desk.text("scene.ron"), theirs, "not overwritten");
    desk.resolve(Side::Ours);
    desk.write("scene.ron", "(entities: {");
    let error = desk.edits.save(desk.app.world_mut()).unwrap_err();
    assert!(matches!(error, SaveError::Broken(_)), "{error}");
    assert_eq!(desk.text("scene.ron"), "(entities: {");
    desk.write("scene.ron", &theirs);
    desk.save();
    assert_eq!(desk.text("scene.ron"), theirs.replace("radius: 2.0", "radius: 4.0"));
}

#[test]
fn overrides_are_edits_that_are_not_saved_yet() {
    let desk = Desk::with(BALLS);
    let overrides = [
        "ball.Mesh.radius=4",
        "bowl.Subsurface.material.g=0.25",
        "background=(1, 1, 1)",
        "bowl.Transform.scale=2",
    ];
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    let mut app = App::new();
    app.add_plugins(TyndallPlugins);
    let edits = Edits::open(app.world_mut(), &desk.scene, &overrides)
        .unwrap_or_else(|problems| panic!("{problems:?}"));
    let mut desk = Desk { app, edits, ..desk };
    assert_eq!(desk.get::<Mesh>("ball"), Mesh::Sphere { radius: 4.0, subdivisions: 5 });
    assert!(desk.is_unsaved_at("ball", "Mesh.radius") && desk.is_unsaved_at("ball", "Subsurface.material.g"));
    desk.write("scene.ron", &desk.text("scene.ron").replace("-1.0", "-2.0"));
    assert_eq!(desk.reload(), 0);
    assert_eq!(desk.get::<Transform>("bowl").scale, Scale::Uniform(2.0));
    desk.save();
    assert!(
        desk.text("scene.ron").contains("radius: 4.0") && desk.text("materials/jade.ron").contains("g: 0.25")
    );
    let wrong: Vec<_> = vec!["ball.Mesh.radius=-4".parse().unwrap()];
    assert!(Edits::open(desk.app.world_mut(), &desk.scene, &wrong).is_err());
}

#[test]
fn line_ends_and_indentation_stay_those_of_the_file() {
    let text = "(\r\n\tentities: {\r\n\t\t\"a\": (\r\n\t\t\tMesh: Sphere(), // é\r\n\t\t),\r\n\t},\r\n)\r\n";
    let mut desk = Desk::with(&[("scene.ron", text)]);
    let points = vec![ControlPoint(0.25, Vec3::new(0.123, 0.456, 0.789), 0.5); 4];
    let function = TransferFunction { points, ..TransferFunction::default() };
    desk.edits.add_component(desk.app.world_mut(), "a", &function).unwrap();
    desk.edits.add_entity(desk.app.world_mut(), "b", &[]).unwrap();
    desk.save();
    let point = "(0.25, (0.123, 0.456, 0.789), 0.5),\r\n";
    let points = format!("\t\t\t\t\t{point}").repeat(4);
    let function =
        format!("\t\t\tTransferFunction: (\r\n\t\t\t\tpoints: [\r\n{points}\t\t\t\t],\r\n\t\t\t),\r\n");
    let expected = text
        .replace("// é\r\n", &format!("// é\r\n{function}"))
        .replace("\n\t\t),\r\n", "\n\t\t),\r\n\t\t\"b\": (),\r\n");
    let after = desk.text("scene.ron");
    assert_eq!(after, expected, "{after}");
}

#[test]
fn a_scene_without_entities_or_fields_can_be_filled() {
    for text in [
        "()",
        "( )",
        "(\n)",
        "// c\n(entities: {})",
        "#![enable(implicit_some)]\n(\n    entities: {\n        // none yet\n    },\n)",
    ] {
        let mut desk = Desk::with(&[("scene.ron", text)]);
        desk.edits.set_setting(desk.app.world_mut(), "background", &Vec3::X).unwrap();
        desk.edits.add_entity(desk.app.world_mut(), "a", &[&Mesh::CornellBox, &Phong::default()]).unwrap();
        desk.edits.add_entity(desk.app.world_mut(), "b", &[]).unwrap();
        desk.save();
        assert_eq!(desk.world(), desk.fresh(), "{text}");
        while desk.undo() {}
        desk.save();
        assert_eq!(desk.world(), desk.fresh(), "{text}");
    }
}

#[cfg(unix)]
#[test]
fn links_and_permissions_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let mut desk = Desk::with(BALLS);
    let (link, jade) = (desk.path("materials/jade.ron"), desk.path("real.ron"));
    fs::rename(&link, &jade).unwrap();
    symlink("../real.ron", &link).unwrap();
    fs::set_permissions(&jade, fs::Permissions::from_mode(0o640)).unwrap();
    desk.set("ball", "Subsurface.material.g", 0.5_f32);
    desk.save();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::metadata(&jade).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(desk.text("real.ron").contains("g: 0.5"));
    assert_eq!(fs::read_dir(desk.folder.path()).unwrap().count(), 4, "nothing is left behind");
}

#[test]
fn what_cannot_be_written_stays_unsaved() {
    let mut desk = Desk::with(BALLS);
    let file = desk.path("materials/jade.ron");
    let permissions = fs::metadata(&file).unwrap().permissions();
    let mut read_only = permissions.clone();
    read_only.set_readonly(true);
    fs::set_permissions(&file, read_only).unwrap();
    desk.set("ball", "Mesh.radius", 3.0_f32);
    desk.set("ball", "Subsurface.material.g", 0.5_f32);
    let (scene, jade) = (desk.text("scene.ron"), desk.text("materials/jade.ron"));
    let error = desk.edits.save(desk.app.world_mut()).unwrap_err();
    assert!(
        matches!(&error, SaveError::File { path, .. } if path.ends_with("materials/jade.ron")),
        "{error}"
    );
    assert!(error.to_string().contains("make the file and its folder writable"), "{error}");
    assert_eq!((desk.text("scene.ron"), desk.text("materials/jade.ron")), (scene, jade), "none of both");
    assert!(desk.is_unsaved_at("ball", "Mesh.radius") && desk.is_unsaved_at("ball", "Subsurface.material.g"));
    assert_eq!(desk.get::<Mesh>("ball"), Mesh::Sphere { radius: 3.0, subdivisions: 5 });
    fs::set_permissions(&file, permissions).unwrap();
    desk.save();
    assert_eq!(desk.world(), desk.fresh());
}

/// A folder in which there is room for short names of files only, so that nothing can be written beside the scene, as on a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_file_loses_nothing() {
    const LONGEST_PATH: usize = 4095;
    let folder = tempfile::tempdir().unwrap();
    let mut deep = folder.path().to_owned();
    while deep.as_os_str().len() < LONGEST_PATH - 8 {
        let room = LONGEST_PATH - 7 - deep.as_os_str().len();
        deep.push("d".repeat((room - 1).clamp(1, 200)));
    }
    fs::create_dir_all(&deep).unwrap();
    let scene = deep.join("s.ron");
    fs::write(&scene, r#"(entities: { "a": ( Mesh: Sphere() ) })"#).unwrap();
    let name = scene.strip_prefix(folder.path()).unwrap().to_str().unwrap().to_owned();
    let mut desk = Desk::open(folder, &name);
    desk.set("a", "Mesh.radius", 2.0_f32);
    let error = desk.edits.save(desk.app.world_mut()).unwrap_err();
    assert!(matches!(&error, SaveError::File { .. }), "{error}");
    assert_eq!(fs::read_to_string(&desk.scene).unwrap(), r#"(entities: { "a": ( Mesh: Sphere() ) })"#);
    assert!(desk.edits.is_unsaved());
    assert_eq!(desk.get::<Mesh>("a"), Mesh::Sphere { radius: 2.0, subdivisions: 5 });
}

#[test]
fn paths_of_files_are_as_written_in_the_file_they_stand_in() {
    let mut desk = Desk::with(&[
        ("scenes/scene.ron", r#"(include: ["parts/more.ron"], entities: { "a": ( Mesh: Sphere() ) })"#),
        ("scenes/parts/more.ron", r#"(entities: { "b": ( Mesh: File("b.obj") ) })"#),
    ]);
    desk.set("a", "Mesh", Mesh::file("x.obj"));
    desk.set("b", "Mesh.path", AssetPath::new("../y.obj"));
    let resolved = |desk: &Desk, name: &str| match desk.get::<Mesh>(name) {
        Mesh::File { path, .. } => path.path().to_owned(),
        other => panic!("{other:?}"),
    };
    assert_eq!(resolved(&desk, "a"), desk.path("scenes/x.obj"));
    assert_eq!(resolved(&desk, "b"), desk.path("scenes/parts/../y.obj"));
    desk.save();
    assert!(desk.text("scenes/parts/more.ron").contains(r#"Mesh: File("../y.obj")"#));
    assert_eq!(desk.world(), desk.fresh());
}

#[test]
fn one_of_ten_thousand_entities_is_edited_alone() {
    let entities: String = (0..10_000)
        .map(|index| format!("\"ball {index}\": ( Mesh: Sphere(radius: {}.5) ), // b\n", index + 1))
        .collect();
    let mut desk = Desk::with(&[("scene.ron", &format!("(entities: {{\n{entities}}})"))]);
    desk.app.world_mut().clear_trackers();
    let started = std::time::Instant::now();
    desk.set("ball 5000", "Mesh.radius", 1.0_f32);
    eprintln!("one edit among 10,000 entities: {:?}", started.elapsed());
    let world = desk.app.world_mut();
    assert_eq!(world.query_filtered::<(), Changed<Mesh>>().iter(world).count(), 1);
    desk.save();
    assert!(desk.text("scene.ron").contains("\"ball 5000\": ( Mesh: Sphere(radius: 1.0) ), // b\n"));
}
