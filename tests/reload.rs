//! Scenes that follow their files: real files, real events. Tests wait for what must come and never for time to pass.
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/files.rs"]
mod files;

use bevy_ecs::reflect::{AppTypeRegistry, ReflectComponent};
use files::{Live, ball, mark, scene};
use std::fs::{self, File};
use std::io::Write;
use tyndall::loading::{LoadedMesh, LoadedVolume};
use tyndall::prelude::*;
use tyndall::report::Report;
use tyndall::scene::{Changes, LiveScene, Reload, SceneDocument, SceneEntities, reconcile_after};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

fn open(entities: &str, more: &[(&str, &str)]) -> Live {
    let (text, mark) = (scene(entities), mark(0.0));
    let mut files = vec![("scene.ron", text.as_str()), ("mark.ron", mark.as_str())];
    files.extend(more);
    Live::open(&files)
}

fn open_ball() -> Live {
    open("\"ball\": ( Mesh: Sphere(radius: 1.0, subdivisions: 0) ),", &[])
}

fn triangles(live: &mut Live, name: &str) -> Option<usize> {
    let entity = live.app.world().resource::<SceneEntities>().0[name];
    let mesh = live.app.world().get::<LoadedMesh>(entity)?;
    mesh.data.as_ref().map(|data| data.triangles.len())
}

fn greatest(live: &Live, name: &str) -> Option<f32> {
    let entity = live.app.world().resource::<SceneEntities>().0[name];
    live.app.world().get::<LoadedVolume>(entity).map(|volume| volume.data.range.1)
}

#[test]
fn every_way_of_saving_is_followed() {
    let mut live = open_ball();
    let path = live.at("scene.ron");
    let (beside, backup) = (live.at(".scene.ron.swp"), live.at("scene.ron~"));
    let ways: [(&str, &dyn Fn(&str)); 6] = [
        ("in place", &|text| fs::write(&path, text).unwrap()),
        ("truncated first", &|text| {
            File::create(&path).unwrap().sync_all().unwrap();
            File::options().append(true).open(&path).unwrap().write_all(text.as_bytes()).unwrap();
        }),
        ("renamed over", &|text| {
            fs::write(&beside, text).unwrap();
            fs::rename(&beside, &path).unwrap();
        }),
        ("deleted and made again", &|text| {
            fs::remove_file(&path).unwrap();
            fs::write(&path, text).unwrap();
        }),
        ("moved away and made again", &|text| {
            fs::rename(&path, &backup).unwrap();
            fs::write(&path, text).unwrap();
        }),
        ("piece by piece", &|text| {
            let mut file = File::create(&path).unwrap();
            for piece in text.as_bytes().chunks(7) {
                file.write_all(piece).unwrap();
                file.flush().unwrap();
            }
        }),
    ];
    for round in 0..3 {
        for (index, (way, save)) in ways.iter().enumerate() {
            let radius = (10 + round * 10 + index) as f32;
            save(&ball(radius));
            live.until(way, |live| live.radius() == radius && !live.scene.is_refused());
            assert!(live.problems().iter().all(|problem| problem.place.is_some()), "{:#?}", live.problems());
        }
    }
}

#[test]
fn a_torn_file_is_told_of_with_its_place_and_the_last_good_world_stays() {
    let mut live = open_ball();
    let text = ball(2.0);
    let before = live.ticks();
    live.write("scene.ron", &text[..text.len() / 2]);
    live.until("the torn text", |live| live.scene.is_refused());
    assert_eq!((live.radius(), live.changed_since(&before)), (1.0, vec![]));
    let problems = live.problems();
    let place = problems[0].place.as_ref().unwrap();
    assert_eq!(place.file.path(), live.at("scene.ron"));
    assert!(problems[0].to_string().contains("scene.ron:2:11: expected `,`"), "{problems:#?}");
    // A good include does not make a bad scene good.
    live.write("mark.ron", &mark(9.0));
    live.write("scene.ron", &text);
    live.until("the whole text", |live| live.radius() == 2.0);
    assert!(!live.scene.is_refused());
    assert_eq!(live.get::<Transform>("mark").unwrap().translation.x, 9.0);
    assert_eq!(live.changed_since(&before), ["ball.Mesh"]);
    assert!(live.messages().iter().all(|message| message.contains("no light")), "{:?}", live.messages());
}

#[test]
fn files_and_folders_that_vanish_may_return() {
    let files = [("scenes/deep/scene.ron", ball(1.0)), ("scenes/deep/mark.ron", mark(0.0))];
    let files: Vec<_> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
    let mut live = Live::open_in(App::new(), &files, "scenes/deep/scene.ron");
    let (path, folder) = (live.at("scenes/deep/scene.ron"), live.at("scenes/deep"));
    let is_gone = |live: &mut Live| live.scene.is_refused();
    fs::remove_file(&path).unwrap();
    live.until("the file gone", is_gone);
    assert!(live.messages()[0].contains("there is no file"), "{:?}", live.messages());
    assert_eq!(live.radius(), 1.0);
    fs::write(&path, ball(2.0)).unwrap();
    live.until("the file back", |live| live.radius() == 2.0);
    // The folder goes with all that is in it, and another comes.
    fs::remove_dir_all(&folder).unwrap();
    live.until("the folder gone", is_gone);
    fs::create_dir(&folder).unwrap();
    fs::write(folder.join("mark.ron"), mark(0.0)).unwrap();
    fs::write(&path, ball(3.0)).unwrap();
    live.until("the folder back", |live| live.radius() == 3.0 && !live.scene.is_refused());
    // It moves away and back, and is followed still.
    fs::rename(&folder, live.at("elsewhere")).unwrap();
    live.until("the folder moved", is_gone);
    fs::rename(live.at("elsewhere"), &folder).unwrap();
    live.until("the folder moved back", |live| !live.scene.is_refused());
    fs::write(&path, ball(4.0)).unwrap();
    live.until("an edit after all that", |live| live.radius() == 4.0);
    // What is above is exchanged: no folder that is watched has changed.
    fs::rename(live.at("scenes"), live.at("old")).unwrap();
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("mark.ron"), mark(0.0)).unwrap();
    fs::write(&path, ball(5.0)).unwrap();
    live.until("another folder above", |live| live.radius() == 5.0);
}

#[test]
fn files_that_are_named_before_they_are_there_are_read_when_they_come() {
    let mut live = open(
        "\"shape\": ( Mesh: File(\"meshes/fine/shape.obj\") ), \"grid\": ( Volume: File(\"scan\") ),",
        &[],
    );
    assert_eq!(live.messages().iter().filter(|message| message.contains("no such file")).count(), 2);
    fs::create_dir_all(live.at("meshes/fine")).unwrap();
    fs::write(live.at("meshes/fine/shape.obj"), TRIANGLE).unwrap();
    live.until("the mesh", |live| triangles(live, "shape") == Some(1));
    assert!(!live.messages().iter().any(|message| message.contains("`shape`: ")), "{:?}", live.messages());
    // A folder of slices counts with all that comes into it.
    fs::create_dir(live.at("scan")).unwrap();
    live.until("the folder", |live| {
        live.messages().iter().any(|message| message.contains("without DICOM slices"))
    });
    let mut slice = vec![0; 128];
    slice.extend(b"DICM\x08\x00\x60\x00UI\xff\xff");
    fs::write(live.at("scan/1.dcm"), slice).unwrap();
    live.until("a slice", |live| live.messages().iter().any(|message| message.contains("1.dcm")));
    live.write("scene.ron", &scene("\"other\": ( Mesh: Sphere() ),").replace("mark.ron", "later.ron"));
    live.until("an include that is not there", |live| live.scene.is_refused());
    live.write("later.ron", &mark(3.0));
    live.until("the include", |live| {
        live.has("other") && live.get::<Transform>("mark").unwrap().translation.x == 3.0
    });
    assert!(!live.has("shape"));
}

#[cfg(unix)]
#[test]
fn links_are_followed_to_where_they_lead_now() {
    use std::os::unix::fs::symlink;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir_all(at("one")).unwrap();
    fs::create_dir_all(at("two")).unwrap();
    let save = |name: &str, radius: f32| {
        fs::write(at(name), ball(radius).replace("mark.ron", "../mark.ron")).unwrap();
    };
    fs::write(at("mark.ron"), mark(0.0)).unwrap();
    save("one/real.ron", 1.0);
    save("two/real.ron", 5.0);
    symlink("one", at("current")).unwrap();
    symlink("current/real.ron", at("scene.ron")).unwrap();
    fs::create_dir(at("in")).unwrap();
    symlink("../scene.ron", at("in/scene.ron")).unwrap();
    let mut live = Live::open(&[]);
    live.scene = LiveScene::open(&mut live.app, &at("in/scene.ron"), &[]);
    live.listen();
    // Paths in a scene start where the link is.
    live.until("the scene", |live| live.has("ball") && live.radius() == 1.0);
    save("one/real.ron", 2.0);
    live.until("an edit behind two links", |live| live.radius() == 2.0);
    symlink("two", at("next")).unwrap();
    fs::rename(at("next"), at("current")).unwrap();
    live.until("the folder's link exchanged", |live| live.radius() == 5.0);
    save("two/real.ron", 6.0);
    live.until("an edit where it leads now", |live| live.radius() == 6.0);
    fs::remove_file(at("scene.ron")).unwrap();
    live.until("the link gone", |live| live.scene.is_refused());
    symlink("one/real.ron", at("scene.ron")).unwrap();
    live.until("another link", |live| live.radius() == 2.0);
}

#[test]
fn a_burst_of_saves_is_followed_now_and_then_and_to_its_end() {
    let mut live = open_ball();
    let path = live.at("scene.ron");
    let saver = std::thread::spawn(move || {
        for save in 1..=1000 {
            fs::write(&path, ball(save as f32)).unwrap();
        }
    });
    let started = std::time::Instant::now();
    let reloads = live.until("the last of them", |live| live.radius() == 1000.0 && !live.scene.is_refused());
    saver.join().unwrap();
    // At most one in 50 ms, however long the saves take; and a few around them.
    let most = 5 + started.elapsed().as_millis() as usize / 50;
    assert!(reloads.len() <= most, "{} reloads, {most} were expected at most", reloads.len());
    live.until_marked();
    assert_eq!(live.radius(), 1000.0);
}

#[test]
fn saving_what_is_there_already_redoes_nothing() {
    let entities = "\"shape\": ( Mesh: File(\"shape.obj\"), Phong: File(\"look.ron\") ), \"grid\": ( Volume: Raw(path: \"v.raw\", size: (2, 2, 1)) ),";
    let mut live =
        open(entities, &[("shape.obj", TRIANGLE), ("look.ron", "(shininess: 7.0)"), ("v.raw", "abcd")]);
    live.until_marked();
    let before = live.ticks();
    let loaded = |live: &mut Live| {
        let world = live.app.world_mut();
        let mut meshes = world.query::<Ref<LoadedMesh>>();
        let mut all: Vec<u32> = meshes.iter(world).map(|mesh| mesh.last_changed().get()).collect();
        let mut volumes = world.query::<Ref<LoadedVolume>>();
        all.extend(volumes.iter(world).map(|volume| volume.last_changed().get()));
        all
    };
    let loads = loaded(&mut live);
    assert_eq!(loads.len(), 2);
    for name in ["scene.ron", "shape.obj", "look.ron", "v.raw", "mark.ron"] {
        let (path, beside) = (live.at(name), live.at("beside"));
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes).unwrap();
        fs::write(&beside, &bytes).unwrap();
        fs::rename(&beside, &path).unwrap();
        fs::remove_file(&path).unwrap();
        fs::write(&path, &bytes).unwrap();
        let text = "nothing that anyone reads";
        fs::write(live.at("unrelated.ron"), text).unwrap();
        let written = Changes { written: 1, ..Changes::default() };
        for reload in live.until_marked() {
            // Only where the system was caught between deleting and making again.
            let expected = Reload::Reloaded { changes: written, assets: 0, shaders: 0 };
            assert_eq!(reload, expected, "{name}");
        }
    }
    assert_eq!(live.changed_since(&before), Vec::<String>::new());
    assert_eq!(loaded(&mut live), loads);
}

#[test]
fn one_of_ten_thousand_entities_is_one_component() {
    let many = |radius: f32| {
        let entity = |index: usize| {
            let radius = if index == 5000 { radius } else { 1.0 };
            format!(
                "\"ball {index}\": ( Transform: (translation: ({index}.0, 0.0, 0.0)), Mesh: Sphere(radius: {radius:?}, subdivisions: 0) ), // a ball\n"
            )
        };
        scene(&(0..10_000).map(entity).collect::<String>())
    };
    let mut live = Live::open(&[("scene.ron", &many(1.0)), ("mark.ron", &mark(0.0))]);
    let before = live.ticks();
    live.app.world_mut().resource_mut::<Report>().timeline.clear();
    live.write("scene.ron", &many(2.0));
    let one = Changes { written: 1, ..Changes::default() };
    assert_eq!(live.next(), Reload::Reloaded { changes: one, assets: 0, shaders: 0 });
    assert_eq!(live.changed_since(&before), ["ball 5000.Mesh"]);
    let timeline = &live.app.world().resource::<Report>().timeline;
    let parts: Vec<&str> = timeline.iter().map(|(part, _)| *part).collect();
    assert_eq!(parts, ["watch", "parse", "reconcile"], "{timeline:?}");
    // Places are those of the new text.
    let line = live.scene.document().entity("ball 9999").unwrap().place.to_string();
    assert!(line.ends_with("scene.ron:10001:1"), "{line}");
    // A comment moves everything and changes nothing.
    live.write("scene.ron", &format!("// a line more\n{}", many(2.0)));
    assert_eq!(live.next(), Reload::Reloaded { changes: Changes::default(), assets: 0, shaders: 0 });
    let moved = live.scene.document().entity("ball 9999").unwrap().place_of("Mesh.radius").to_string();
    assert!(moved.ends_with("scene.ron:10002:83"), "{moved}");
    assert_eq!(live.changed_since(&before), ["ball 5000.Mesh"]);
}

#[test]
fn what_is_shared_reaches_everyone_who_uses_it() {
    let look = "Mesh: Sphere(subdivisions: 0), Phong: File(\"look.ron\")";
    let entities = format!("\"a\": ( {look} ), \"b\": ( {look} ), \"c\": ( Mesh: Sphere(subdivisions: 0) ),");
    let more =
        "(entities: { \"d\": ( Phong: File(\"look.ron\") ), \"e\": ( Mesh: Sphere(subdivisions: 0) ) })";
    let text = scene(&entities).replace("[\"mark.ron\"]", "[\"mark.ron\", \"more.ron\"]");
    let mut live = Live::open(&[
        ("scene.ron", &text),
        ("mark.ron", &mark(0.0)),
        ("more.ron", more),
        ("look.ron", "(shininess: 3.0)"),
    ]);
    let before = live.ticks();
    live.write("look.ron", "(shininess: 4.0)");
    let three = Changes { written: 3, ..Changes::default() };
    assert_eq!(live.next(), Reload::Reloaded { changes: three, assets: 0, shaders: 0 });
    assert_eq!(live.changed_since(&before), ["a.Phong", "b.Phong", "d.Phong"]);
    let before = live.ticks();
    live.write("more.ron", &more.replace("subdivisions: 0", "subdivisions: 1"));
    live.next();
    assert_eq!(live.changed_since(&before), ["e.Mesh"]);
    // An error in it is told once, where it is.
    live.write("look.ron", "(shininess: -4.0)");
    live.until("the error", |live| live.scene.is_refused());
    let messages: Vec<_> =
        live.messages().into_iter().filter(|message| message.contains("shininess")).collect();
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].contains("look.ron:1:13"), "{messages:?}");
    live.write("look.ron", "(shininess: 4.0)");
    live.until("the mend", |live| !live.scene.is_refused());
    assert_eq!(live.changed_since(&before), ["e.Mesh"]);
}

#[test]
fn a_mesh_or_volume_whose_file_changes_is_read_again_alone_and_kept_if_it_cannot_be() {
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 1 1\nencoding: raw\ndata file: v.raw\n";
    let entities = "\"a\": ( Mesh: File(\"a.obj\") ), \"b\": ( Mesh: File(\"b.obj\") ), \"grid\": ( Volume: File(\"v.nhdr\") ),";
    let mut live =
        open(entities, &[("a.obj", TRIANGLE), ("b.obj", TRIANGLE), ("v.nhdr", header), ("v.raw", "ab")]);
    let before = live.ticks();
    let loaded_at = |live: &mut Live, name: &str| {
        let entity = live.app.world().resource::<SceneEntities>().0[name];
        live.app.world().entity(entity).get_ref::<LoadedMesh>().unwrap().last_changed().get()
    };
    let b = loaded_at(&mut live, "b");
    live.write("a.obj", SQUARE);
    live.until("the mesh", |live| triangles(live, "a") == Some(2));
    live.write("v.raw", "az");
    live.until("the data behind a header", |live| greatest(live, "grid") == Some(f32::from(b'z')));
    // Broken: told with the place in the scene, and what was there stays.
    live.write("a.obj", "v 0 0 nonsense\n");
    live.until("the broken mesh", |live| live.messages().iter().any(|message| message.contains("`a`: ")));
    live.write("v.raw", "a");
    live.until("the short volume", |live| live.messages().iter().any(|message| message.contains("`grid`: ")));
    assert_eq!((triangles(&mut live, "a"), greatest(&live, "grid")), (Some(2), Some(f32::from(b'z'))));
    assert!(
        live.messages().iter().any(|message| message.contains("scene.ron:2:19: `a`")),
        "{:?}",
        live.messages()
    );
    // Other edits do not make it forgotten.
    let told = live.messages();
    for _ in 0..3 {
        live.until_marked();
        assert_eq!(live.messages(), told);
    }
    live.write("v.raw", "ab");
    live.write("a.obj", TRIANGLE);
    live.until("both mended", |live| {
        triangles(live, "a") == Some(1) && greatest(live, "grid") == Some(f32::from(b'b'))
    });
    assert!(!live.messages().iter().any(|message| message.contains("`: ")), "{:?}", live.messages());
    assert_eq!(live.changed_since(&before), Vec::<String>::new());
    assert_eq!(loaded_at(&mut live, "b"), b);
    // A component that is taken away takes what was wrong with its file along.
    fs::remove_file(live.at("b.obj")).unwrap();
    live.until("the file gone", |live| live.messages().iter().any(|message| message.contains("`b`: ")));
    live.write("scene.ron", &scene(entities).replace("Mesh: File(\"b.obj\")", ""));
    live.until("the component gone", |live| live.get::<Mesh>("b").is_none());
    assert!(!live.messages().iter().any(|message| message.contains("`b`: ")), "{:?}", live.messages());
}

#[test]
fn entities_that_come_go_and_get_other_names_touch_only_themselves() {
    let one = |name: &str| format!("{name:?}: ( Mesh: Sphere(subdivisions: 0), Transform: () ),");
    let of = |names: &[&str]| scene(&names.iter().map(|name| one(name)).collect::<String>());
    let mut live = Live::open(&[("scene.ron", &of(&["a", "b", "c"])), ("mark.ron", &mark(0.0))]);
    let before = live.ticks();
    let entities = live.app.world().resource::<SceneEntities>().0.clone();
    live.write("scene.ron", &of(&["a", "new", "b", "c"]));
    live.next();
    assert_eq!(live.changed_since(&before), ["new.Mesh", "new.Transform"]);
    live.write("scene.ron", &of(&["c", "new", "renamed", "a"]));
    live.next();
    live.write("scene.ron", &of(&["c", "renamed", "a"]));
    live.next();
    let gone_and_new = ["b.Mesh", "b.Transform", "renamed.Mesh", "renamed.Transform"];
    assert_eq!(live.changed_since(&before), gone_and_new);
    let now = &live.app.world().resource::<SceneEntities>().0;
    assert_eq!(["a", "c", "mark"].map(|name| now[name]), ["a", "c", "mark"].map(|name| entities[name]));
    assert!(live.app.world().get_entity(entities["b"]).is_err());
}

/// A component that no scene writes.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
struct Selected(u32);

#[test]
fn what_is_not_in_the_file_survives() {
    let text = |radius: f32, more: &str| {
        scene(&format!(
            "\"ball\": ( Mesh: Sphere(radius: {radius:?}, subdivisions: 0), Transform: () {more} ), \"other\": ( Transform: () ),"
        ))
    };
    let mut live = Live::open(&[("scene.ron", &text(1.0, "")), ("mark.ron", &mark(0.0))]);
    let [ball, other] = ["ball", "other"].map(|name| live.app.world().resource::<SceneEntities>().0[name]);
    let moved = |x: f32| Transform { translation: Vec3::splat(x), ..Default::default() };
    let orbit = live.app.world_mut().spawn(ViewCamera { eye: Vec3::splat(7.0), ..Default::default() }).id();
    live.app.world_mut().entity_mut(ball).insert((Selected(3), moved(5.0)));
    live.app.world_mut().entity_mut(other).insert(moved(6.0));
    live.write("scene.ron", &text(2.0, ""));
    live.until("the edit", |live| live.radius() == 2.0);
    live.write("scene.ron", &text(2.0, ", Phong: ()"));
    live.until("another", |live| live.get::<Phong>("ball").is_some());
    let world = live.app.world();
    assert_eq!(world.get::<Selected>(ball), Some(&Selected(3)));
    assert_eq!(world.get::<ViewCamera>(orbit).unwrap().eye, Vec3::splat(7.0));
    assert_eq!((world.get(ball), world.get(other)), (Some(&moved(5.0)), Some(&moved(6.0))));
    // What the file says anew counts.
    live.write(
        "scene.ron",
        &text(2.0, "").replace("\"other\": ( Transform: ()", "\"other\": ( Transform: (scale: 2.0)"),
    );
    live.until("an edit of the same", |live| {
        live.get::<Transform>("other").unwrap().scale == Scale::Uniform(2.0)
    });
    assert_eq!(live.get::<Transform>("other").unwrap().translation, Vec3::ZERO);
}

#[test]
fn overrides_stay_in_force() {
    let mut live = open_ball();
    let set = ["ball.Mesh.radius=8.0".parse().unwrap()];
    live.scene = LiveScene::open(&mut live.app, &live.folder.path().join("scene.ron"), &set);
    live.listen();
    assert_eq!(live.radius(), 8.0);
    live.write("scene.ron", &ball(3.0).replace("\"ball\"", "\"more\": (), \"ball\""));
    live.until("the edit", |live| live.has("more"));
    assert_eq!(live.radius(), 8.0);
    assert!(live.scene.path().ends_with("scene.ron"));
}

#[test]
fn a_scene_that_begins_broken_is_shown_when_it_is_mended() {
    let mut live = Live::open(&[("scene.ron", "(entities: {"), ("mark.ron", &mark(0.0))]);
    assert!(live.scene.is_refused() && !live.has("ball"));
    live.write("scene.ron", &ball(2.0).replace("(include", "(millimetres_per_unit: 5.0, include"));
    live.until("the mend", |live| !live.scene.is_refused());
    assert_eq!(
        (live.radius(), live.app.world().resource::<SceneSettings>().millimetres_per_unit),
        (2.0, 5.0)
    );
}

/// Reading again what changed gives the same as reading everything, whatever the edit is; and so does the world.
#[test]
fn an_edit_read_after_another_is_as_if_read_afresh() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.ron");
    fs::write(folder.path().join("look.ron"), "(shininess: 3.0)").unwrap();
    let start = "( background: (0.1, 0.2, 0.3), include: [\"more.ron\"], entities: {
        // the first\n \"a\": ( Mesh: Sphere(radius: 2.0, subdivisions: 0), Phong: File(\"look.ron\") ),
        \"b\": ( Transform: (scale: (1.0, 2.0, 3.0)), Mesh: Box ), /* é */ \"c\": ( Shading: Local ),
        \"eye\": ( ViewCamera: (eye: (1.0, 2.0, 3.0), projection: Orthographic(height: 2.0)) ),
    })";
    let pieces = [
        "(",
        ")",
        "{",
        "}",
        "\"",
        ",",
        ":",
        "//",
        "/*",
        "\"a\": ( Mesh: Box ),",
        "2.5",
        "Box",
        "\"look.ron\"",
        " ",
        "\n",
        "é",
        "b",
        "()",
    ];
    let mut random = 0x2545_f491_4f6c_dd1du64;
    let mut next = move |below: usize| {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        (random % below as u64) as usize
    };
    fs::write(folder.path().join("more.ron"), "(entities: { \"d\": ( Phong: File(\"look.ron\") ) })")
        .unwrap();
    let mut follower = App::new();
    follower.add_plugins(TyndallPlugins);
    let registry = follower.world().resource::<AppTypeRegistry>().clone();
    let registry = registry.read();
    let (mut text, mut last, mut good) = (start.to_owned(), None, 0);
    for step in 0..3000 {
        let at = text.floor_char_boundary(next(text.len() + 1));
        let end = text.floor_char_boundary((at + next(9)).min(text.len()));
        match next(4) {
            0 => text.replace_range(at..end, ""),
            1 => text = start.to_owned(),
            2 => fs::write(folder.path().join("look.ron"), format!("(shininess: {}.0)", next(3))).unwrap(),
            _ => text.insert_str(at, pieces[next(pieces.len())]),
        }
        fs::write(&path, &text).unwrap();
        let fresh = SceneDocument::load(&path, &registry, &[]);
        let after = SceneDocument::load_after(&path, &registry, &[], last.as_ref());
        let describe = |document: &SceneDocument| -> Vec<String> {
            let problems = document.problems.iter().map(|problem| format!("{problem} {:?}", problem.help));
            let entities = document.entities.iter().map(|entity| {
                let components = entity.components.iter().map(|component| {
                    let place = entity.place_of(&format!("{}.radius", component.name));
                    format!("{} {:?} {place} {:?}", component.name, component.value, place.bytes)
                });
                format!("{} {} {:?}", entity.name, entity.place, components.collect::<Vec<_>>())
            });
            problems
                .chain(entities)
                .chain([format!("{:?} {:?}", document.settings, document.files)])
                .collect()
        };
        assert_eq!(describe(&after), describe(&fresh), "step {step}: {text}");
        if after.has_errors() {
            continue;
        }
        good += 1;
        reconcile_after(follower.world_mut(), &after, last.as_ref());
        last = Some(after);
        let names = &follower.world().resource::<SceneEntities>().0;
        assert_eq!(names.len(), fresh.entities.len());
        for entity in &fresh.entities {
            let there = follower.world().entity(names[&entity.name]);
            for component in entity.components.iter() {
                let data = registry.get_type_data::<ReflectComponent>(component.type_id).unwrap();
                let value = data.reflect(there).unwrap();
                assert_eq!(
                    value.reflect_partial_eq(component.value.as_partial_reflect()),
                    Some(true),
                    "step {step}"
                );
            }
        }
    }
    assert!(good > 500, "{good} good texts");
}
