//! What the program tells of itself and of what scenes are written with.

use super::Place;

#[test]
fn commands_are_told_of() {
    let place = Place::new();
    let all = place.run(0, &["help"]).data;
    for command in ["view", "render", "check", "info", "new", "help"] {
        assert!(all.contains(&format!("\n  {command} ")), "{command}: {all}");
    }
    let render = place.run(0, &["help", "render"]).data;
    assert!(render.contains("Usage: tyndall render") && render.contains("--transparent"), "{render}");
    assert_eq!(place.run(0, &["render", "--help"]).data, render);
}

#[test]
fn components_are_told_of() {
    let place = Place::new();
    let volume = place.run(0, &["help", "Volume"]).data;
    for words in [
        "A scalar field on a regular grid",
        // A table, laid out.
        "\n variant ",
        "───",
        // Code, as it stands.
        "\n    Volume: File(\"head.nii.gz\")\n",
        // From the fields.
        "spacing: (x, y, z)",
        "mm; above 0; default (1.0, 1.0, 1.0)",
        "size: (x, y, z) whole numbers",
        "must be written",
    ] {
        assert!(volume.contains(words), "`{words}` in:\n{volume}");
    }
    assert!(!volume.contains("|---"), "{volume}");
    for line in volume.lines() {
        assert!(line.chars().count() <= 100, "`{line}` is too long");
    }
    assert_eq!(place.run(0, &["help", "volume"]).data, volume);
    let camera = place.run(0, &["help", "viewcamera"]).data;
    for words in [
        "eye: (x, y, z)\n",
        "exposure: number\n",
        "EV; from -100 to 100; default 0.0",
        "Projection is one of",
        "degrees; from 0.01 to 179; default 45.0",
    ] {
        assert!(camera.contains(words), "`{words}` in:\n{camera}");
    }
    // Of a plugin.
    let turntable = place.run(0, &["help", "Turntable"]).data;
    assert!(turntable.starts_with("Turntable (of tyndall_turntable)\n\nTurns an entity."), "{turntable}");
    assert!(turntable.contains("degrees_per_second: number"), "{turntable}");
    // What stands in components, and in the head of a scene.
    assert!(place.run(0, &["help", "Projection"]).data.contains("Orthographic(…)"));
    assert!(place.run(0, &["help", "SceneSettings"]).data.contains("millimetres_per_unit"));
}

#[test]
fn every_component_has_a_line() {
    let place = Place::new();
    let all = place.run(0, &["help", "components"]).data;
    for (name, sentence) in [
        ("DirectionalLight", "Light from infinitely far away: parallel rays"),
        ("Volume", "A scalar field on a regular grid"),
        ("Turntable (of tyndall_turntable)", "Turns an entity"),
    ] {
        let line = all
            .lines()
            .find(|line| line.starts_with(&format!("{name} ")))
            .unwrap_or_else(|| panic!("{name}: {all}"));
        assert!(line.contains(sentence), "{line}");
    }
}

#[test]
fn a_topic_that_is_not_there_gets_a_suggestion() {
    let place = Place::new();
    place.run(2, &["help", "Volum"]).says("did you mean `Volume`?");
    place.run(2, &["help", "Sun"]).says("did you mean `DirectionalLight`?");
    place.run(2, &["help", "Colour"]).says("did you mean `Phong`?");
    place.run(2, &["help", "rendr"]).says("did you mean `render`?");
    place.run(2, &["help", "Xyzzy"]).says("`tyndall help components` lists all components");
}
