//! Entities and components that come, go, or get another name, and files that several of them share.

use crate::in_company::{
    FOG_LIT_ANEW, FOG_RELOADED, JAR_MAPPED, LIGHT_TURNED, SCENE, SMOKE_RECLASSIFIED, SMOKE_RELOADED,
    WAX_RESHAPED,
};
use crate::stage::Stage;
use crate::table::Trial;
use tyndall::prelude::*;
use tyndall::scene::SceneEntities;
use tyndall_needs::needs;

/// A change of what there is in the scene of [`in_company`](crate::in_company).
#[derive(Debug)]
enum Edit {
    Without(&'static str),
    Renamed(&'static str, &'static str),
    /// One entity more, behind the others.
    With(&'static str),
    /// The lines of an entity that begin with a component, up to those that begin with another.
    Cut(&'static str, &'static str, &'static str),
}

use Edit::{Cut, Renamed, With, Without};

/// What is changed, what that makes again, and what changing it back does.
const ROWS: &[(Edit, &str, &str)] = &[
    (Without("eye"), "", ""),
    (Without("block"), "", "upload_meshes 1 of 12 triangles"),
    (Without("above"), JAR_MAPPED, JAR_MAPPED),
    (Without("a"), "combine 2, summed_light 1", LIGHT_TURNED),
    (Without("b"), "combine 2, summed_light 1", LIGHT_TURNED),
    (Without("wax"), "", WAX_RESHAPED),
    (Without("fog"), "", FOG_RELOADED),
    (Without("smoke"), "", SMOKE_RELOADED),
    (Renamed("eye", "viewer"), "", ""),
    (Renamed("block", "brick"), "upload_meshes 1 of 12 triangles", "upload_meshes 1 of 12 triangles"),
    (Renamed("b", "lamp"), LIGHT_TURNED, LIGHT_TURNED),
    (Renamed("wax", "candle"), WAX_RESHAPED, WAX_RESHAPED),
    (Renamed("fog", "mist"), FOG_RELOADED, FOG_RELOADED),
    (
        With("\"c\": ( DirectionalLight: (direction: (0.0, 0.0, 1.0)) ),"),
        LIGHT_TURNED,
        "combine 2, summed_light 1",
    ),
    (With("\"pole\": ( Transform: (translation: (4.0, 4.0, 0.0)), Caption: (text: \"a pole\") ),"), "", ""),
    (Cut("block", "Phong", "Lifted"), "", ""),
    (Cut("block", "Lifted", "Caption"), "", ""),
    (Cut("block", "Caption", ")"), "", ""),
    (
        Cut("wax", "Subsurface", "ScatteringMaps"),
        "",
        "surface_points 1, light_gbuffer 2, scattered_radiosity 2, combine 1",
    ),
    // Then it stands in the middle of the fog.
    (
        Cut("wax", "Transform", "Mesh"),
        "light_gbuffer 2, dimmed_gbuffer 2, scattered_radiosity 2, combine 1, volume_shadow 2, scattered_light 2, summed_light 1",
        "light_gbuffer 2, scattered_radiosity 2, combine 1, scattered_light 2, summed_light 1",
    ),
    (Cut("fog", "Volume:", "TransferFunction"), "", FOG_RELOADED),
    (Cut("fog", "VolumeLighting", "RayCast"), "", FOG_LIT_ANEW),
    (Cut("fog", "RayCast", "Shading"), "", ""),
    (Cut("fog", "Shading", ")"), "", ""),
    (Cut("smoke", "TransferFunction", "VolumeLighting"), "classify 1", SMOKE_RECLASSIFIED),
];

impl Edit {
    fn of(&self, scene: &str) -> String {
        let lines: Vec<&str> = scene.lines().collect();
        // Where an entity begins, and the line behind it.
        let entity = |name: &str| {
            let first =
                lines.iter().position(|line| line.starts_with(&format!("        \"{name}\": ("))).unwrap();
            let is_last = |line: &&str| line.ends_with("),") && !line.starts_with("         ");
            (first, first + lines[first..].iter().position(is_last).unwrap() + 1)
        };
        match self {
            Without(name) => {
                let (first, end) = entity(name);
                [&lines[..first], &lines[end..]].concat().join("\n")
            }
            Renamed(from, to) => scene.replace(&format!("\"{from}\": ("), &format!("\"{to}\": (")),
            With(entity) => scene.replace("\n    },\n", &format!("\n        {entity}\n    }},\n")),
            Cut(name, from, to) => {
                let (first, end) = entity(name);
                let next = |after: usize, component: &str| {
                    let begins = |line: &&str| line.trim_start().starts_with(component);
                    after + lines[after..end].iter().position(begins).unwrap()
                };
                let from = next(first, from);
                [&lines[..from], &lines[next(from, to)..]].concat().join("\n")
            }
        }
    }
}

#[needs(gpu)]
#[test]
fn what_comes_and_goes_concerns_nothing_else() {
    let mut complaints = Vec::new();
    for (edit, reruns, back) in ROWS {
        // An entity that is made by hand does not follow the file from then on.
        let mut stage = Stage::open(SCENE);
        let (base, as_before) = (stage.read(&[]), stage.shown());
        let edited = edit.of(SCENE);
        assert_ne!(edited, SCENE, "{edit:?}");
        let edited = stage.read_text(&edited);
        let trial = Trial {
            base: &base,
            as_before: &as_before,
            edited: &edited,
            commented: None,
            reruns,
            back: Some(back),
        };
        complaints.extend(trial.complaints(&mut stage).map(|what| format!("{edit:?}, {what}")));
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[needs(gpu)]
#[test]
fn another_name_by_hand_concerns_who_looks_for_it() {
    let mut stage = Stage::open(SCENE);
    let mut rename = |from: &str, to: &'static str| {
        let entity = stage.world().resource::<SceneEntities>().0[from];
        stage.world().entity_mut(entity).insert(Name::new(to));
        stage.frame().to_string()
    };
    for name in ["block", "wax", "fog", "a"] {
        assert_eq!(rename(name, "another"), "", "{name}");
    }
    // Its camera finds it no more.
    assert_ne!(rename("jar", "pot"), "");
    assert_eq!(rename("above", "below"), "");
}

#[needs(gpu)]
#[test]
fn a_file_concerns_those_who_share_it() {
    let volume = |name: &str, x: f32, data: &str, function: &str| {
        format!(
            "\"{name}\": (
                Transform: (translation: ({x:?}, 0.0, 0.0)),
                Volume: Raw(path: \"{data}\", size: (10, 10, 10), spacing: (0.3, 0.3, 0.3)),
                TransferFunction: {function},
                VolumeLighting: SingleScattering(),
            ),"
        )
    };
    let haze = |opacity: f32, green: f32| {
        format!("(points: [(0.0, (1.0, {green:?}, 0.2), {opacity:?})], entries: 32)")
    };
    let light =
        |x: f32| format!("(entities: {{ \"a\": ( DirectionalLight: (direction: ({x:?}, 0.0, -1.0)) ) }})");
    let scene = format!(
        "(include: [\"light.ron\"], entities: {{ {} {} {} }})",
        volume("left", -4.0, "smoke.raw", "File(\"haze.ron\")"),
        volume("middle", 0.0, "other.raw", "File(\"haze.ron\")"),
        volume("right", 4.0, "smoke.raw", "(entries: 64)"),
    );
    let other = "\u{7}".repeat(1000);
    let files = [("haze.ron", haze(0.1, 0.5)), ("light.ron", light(0.1)), ("other.raw", other.clone())];
    let mut stage = Stage::open_with(&scene, &files);
    let mut complaints = Vec::new();
    for (name, text, reruns) in [
        ("haze.ron", haze(0.2, 0.5), "classify 2 of 64 entries, light_volume 2"),
        ("haze.ron", haze(0.2, 0.6), "classify 2 of 64 entries"),
        ("haze.ron", format!("{} // a comment", haze(0.2, 0.6)), ""),
        ("light.ron", light(0.2), "light_volume 3"),
        ("light.ron", format!("{} // a comment", light(0.2)), ""),
        (
            "other.raw",
            other.replace('\u{7}', "\t"),
            "upload_volumes 1, classify 1 of 32 entries, light_volume 1",
        ),
        (
            "smoke.raw",
            "\u{11}".repeat(1000),
            "upload_volumes 1 of 1000 voxels, classify 2 of 96 entries, light_volume 2",
        ),
    ] {
        let ran = stage.save_as(name, &text);
        if !ran.is(reruns) {
            complaints.push(format!("{name}: expected \"{reruns}\", ran \"{ran}\""));
        }
        let (shown, afresh) = (stage.shown(), stage.afresh());
        if shown != afresh {
            complaints.push(format!("{name}: the picture is off by {}", shown.difference(&afresh)));
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
