//! A component that the framework has never heard of works like its own.

use crate::panel::{Inspected, inspector_with, press, registry, set};
use bevy_reflect::{ReflectDeserialize, ReflectSerialize};
use egui::{Key, vec2};
use egui_kittest::{Harness, kittest::Queryable};
use std::collections::BTreeMap;
use tyndall::prelude::*;
use tyndall::ui::Edited;

/// A fog of bees.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, PartialEq)]
struct Swarm {
    /// How many bees there are.
    #[reflect(@Range::new(0.0, 1e6), @Unit("bees"))]
    bees: u64,
    /// How far they fly.
    #[reflect(@Range::positive(), @Unit("m"))]
    reach: f64,
    /// Whether they hum.
    hums: bool,
    /// What they are called.
    called: String,
    /// Where the hive is.
    hive: DVec3,
    /// The colour of their stripes.
    #[reflect(@Range::new(0.0, 1.0), @Rgb::Colour)]
    stripes: Vec3,
    /// What they do.
    mood: Mood,
    /// The weather, if there is any.
    weather: Option<Weather>,
    /// Who dances.
    dancers: Vec<Weather>,
    /// Lengths of their legs.
    legs: [f32; 3],
    /// Honey by flower.
    honey: BTreeMap<String, f32>,
    /// A type with a form of its own.
    code: Code,
}

impl Default for Swarm {
    fn default() -> Self {
        Self {
            bees: 40,
            reach: 3.5,
            hums: true,
            called: "Imme".into(),
            hive: DVec3::new(1.0, 2.0, 3.0),
            stripes: Vec3::new(1.0, 0.8, 0.0),
            mood: Mood::Calm,
            weather: None,
            dancers: vec![Weather { warmth: 1 }, Weather { warmth: 2 }],
            legs: [0.1, 0.2, 0.3],
            honey: BTreeMap::from([("lime".into(), 0.5)]),
            code: Code(7),
        }
    }
}

#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
enum Mood {
    /// They are at home.
    #[default]
    Calm,
    /// They are out.
    Busy {
        /// How fast they fly.
        #[reflect(default = "ten", @Range::new(1.0, 20.0), @Unit("m/s"))]
        speed: f32,
    },
    /// Two of them fight.
    Fight(i8, i8),
}

fn ten() -> f32 {
    10.0
}

#[derive(Reflect, Clone, Debug, Default, PartialEq)]
#[reflect(Default, PartialEq)]
struct Weather {
    /// How warm it is.
    #[reflect(@Range::new(-50.0, 50.0), @Unit("°C"))]
    warmth: i32,
}

#[derive(Reflect, Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[reflect(opaque)]
#[reflect(Clone, Default, PartialEq, Serialize, Deserialize)]
struct Code(u32);

fn swarm() -> Harness<'static, Inspected<Swarm>> {
    let mut registry = registry();
    registry.register::<Swarm>();
    inspector_with(Swarm::default(), registry, vec2(380.0, 900.0))
}

fn edited(harness: &Harness<Inspected<Swarm>>) -> Swarm {
    harness.state().edits.component.clone()
}

fn type_into(harness: &mut Harness<Inspected<Swarm>>, label: &str, text: &str) {
    harness.get_by_label(label).focus();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    harness.get_by_label(label).type_text(text);
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
}

#[test]
fn numbers_switches_and_vectors() {
    let mut harness = swarm();
    set(&mut harness, "Swarm.bees", 1234.4);
    set(&mut harness, "Swarm.reach", 0.25);
    set(&mut harness, "Swarm.hive y", -8.0);
    set(&mut harness, "Swarm.stripes blue", 0.5);
    press(&mut harness, "Swarm.hums");
    let swarm = edited(&harness);
    assert_eq!((swarm.bees, swarm.reach, swarm.hums), (1234, 0.25, false));
    assert_eq!((swarm.hive, swarm.stripes), (DVec3::new(1.0, -8.0, 3.0), Vec3::new(1.0, 0.8, 0.5)));
    // What a field does not allow is not taken.
    set(&mut harness, "Swarm.reach", 0.0);
    set(&mut harness, "Swarm.bees", 2e6);
    assert_eq!(edited(&harness).reach, 0.25);
    assert!(edited(&harness).bees <= 1_000_000);
}

#[test]
fn texts_and_what_can_only_be_written() {
    let mut harness = swarm();
    type_into(&mut harness, "Swarm.called", "Maya");
    type_into(&mut harness, "Swarm.code", "(42)");
    type_into(&mut harness, "Swarm.honey", "{\"clover\": 2.0}");
    let swarm = edited(&harness);
    assert_eq!((swarm.called.as_str(), swarm.code), ("Maya", Code(42)));
    assert_eq!(swarm.honey, BTreeMap::from([("clover".to_owned(), 2.0)]));
    let before = harness.state().edits.log.len();
    type_into(&mut harness, "Swarm.code", "many");
    assert_eq!(harness.state().edits.log.len(), before);
    harness.get_by_label_contains("cannot be read");
    // Escape leaves a text as it was.
    harness.get_by_label("Swarm.called").focus();
    harness.run();
    harness.get_by_label("Swarm.called").type_text("nobody");
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(edited(&harness).called, "Maya");
}

#[test]
fn variants_options_and_lists() {
    let mut harness = swarm();
    crate::panel::choose(&mut harness, "Swarm.mood", "Busy");
    assert_eq!(edited(&harness).mood, Mood::Busy { speed: 10.0 });
    set(&mut harness, "Swarm.mood.speed", 12.0);
    crate::panel::choose(&mut harness, "Swarm.mood", "Fight");
    assert_eq!(edited(&harness).mood, Mood::Fight(0, 0));
    set(&mut harness, "Swarm.mood.1", -3.0);
    assert_eq!(edited(&harness).mood, Mood::Fight(0, -3));
    press(&mut harness, "Swarm.weather is set");
    assert_eq!(edited(&harness).weather, Some(Weather::default()));
    set(&mut harness, "Swarm.weather.warmth", 25.0);
    assert_eq!(edited(&harness).weather, Some(Weather { warmth: 25 }));
    press(&mut harness, "Swarm.weather is set");
    assert_eq!(edited(&harness).weather, None);
    let dancers = |harness: &Harness<Inspected<Swarm>>| -> Vec<i32> {
        edited(harness).dancers.iter().map(|dancer| dancer.warmth).collect()
    };
    press(&mut harness, "Move Swarm.dancers[0] down");
    assert_eq!(dancers(&harness), [2, 1]);
    press(&mut harness, "Add to Swarm.dancers");
    assert_eq!(dancers(&harness), [2, 1, 1]);
    press(&mut harness, "Remove Swarm.dancers[1]");
    assert_eq!(dancers(&harness), [2, 1]);
    set(&mut harness, "Swarm.legs[1]", 0.9);
    assert_eq!(edited(&harness).legs, [0.1, 0.9, 0.3]);
    let log = &harness.state().edits.log;
    assert!(
        log.iter().any(|(path, _)| path == "weather.warmth") && log.iter().any(|(path, _)| path == "mood.1")
    );
    assert!(log.iter().all(|(_, finished)| *finished));
}

#[test]
fn what_is_not_the_default_can_be_made_so() {
    let mut harness = swarm();
    assert!(harness.query_by_label("Reset Swarm.reach").is_none());
    set(&mut harness, "Swarm.reach", 0.25);
    press(&mut harness, "Reset Swarm.reach");
    assert_eq!(edited(&harness), Swarm::default());
}

#[test]
fn an_edit_says_what_it_is() {
    let edit = Edited { path: "weather.warmth".into(), value: Box::new(3_i32), finished: true };
    let mut swarm = Swarm { weather: Some(Weather::default()), ..Default::default() };
    edit.apply(&mut swarm).unwrap();
    assert_eq!(swarm.weather, Some(Weather { warmth: 3 }));
    swarm.weather = None;
    assert!(edit.apply(&mut swarm).unwrap_err().to_string().contains("weather.warmth"));
}
