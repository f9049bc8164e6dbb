//! Tables of edits and of what they make again, and how they are tried out.

use crate::fields;
use crate::seen::{Ran, Shown};
use crate::signs::Signs;
use crate::stage::{Stage, changed, read, text};
use std::collections::BTreeSet;
use std::fs;
use tyndall::prelude::*;
use tyndall::scene::SceneDocument;

/// Edits of one scene.
#[derive(Clone, Copy)]
pub struct Table {
    pub name: &'static str,
    pub scene: &'static str,
    /// Which value, what it becomes, and which passes that runs, as [`Ran::is`] has it.
    pub rows: &'static [(&'static str, &'static str, &'static str)],
}

impl Table {
    /// The fields that the rows change.
    pub fn covered(&self) -> BTreeSet<String> {
        let mut app = App::new();
        app.add_plugins((TyndallPlugins, Signs));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.ron");
        fs::write(&path, self.scene).unwrap();
        let base = read(&app, &path, &[]);
        let of_row = |(field, value, _): &(&str, &str, &str)| {
            let edited = read(&app, &path, &[(field, value)]);
            let components = changed(&base, &edited).into_iter().filter_map(|(name, component)| {
                let before = base.entity(&name)?.component(component)?;
                let after = edited.entity(&name)?.component(component)?;
                Some(fields::differences(before, after))
            });
            let head = fields::differences(&base.settings, &edited.settings);
            let all: BTreeSet<String> = components.flatten().chain(head).collect();
            assert!(!all.is_empty(), "{}: {field} is {value} already", self.name);
            all
        };
        self.rows.iter().flat_map(of_row).collect()
    }

    /// Tries every row, and fails with all that do not hold.
    pub fn hold(&self) {
        let mut stage = Stage::open(self.scene);
        let (base, as_before) = (stage.read(&[]), stage.shown());
        let mut complaints = Vec::new();
        for (field, value, reruns) in self.rows {
            let edited = stage.read(&[(field, value)]);
            let commented = stage.read(&[(field, &format!("{value} /* again */"))]);
            let (base, as_before, edited) = (&base, &as_before, &edited);
            let trial = Trial { base, as_before, edited, commented: Some(&commented), reruns, back: None };
            complaints.extend(trial.complaints(&mut stage).map(|what| format!("{field} = {value}, {what}")));
        }
        assert!(complaints.is_empty(), "{}:\n{}", self.name, complaints.join("\n"));
    }
}

/// An edit that is tried out.
pub struct Trial<'a> {
    pub base: &'a SceneDocument,
    pub as_before: &'a Shown,
    pub edited: &'a SceneDocument,
    /// The same in other words.
    pub commented: Option<&'a SceneDocument>,
    /// What it makes again, and what taking it back does.
    pub reruns: &'a str,
    pub back: Option<&'a str>,
}

impl Trial<'_> {
    /// What does not hold of it: in the scene's file and back, by hand and back.
    pub fn complaints(&self, stage: &mut Stage) -> impl Iterator<Item = String> {
        let Self { base, as_before, edited, commented, reruns, back } = *self;
        let mut complaints = Vec::new();
        let mut expect = |when: &str, ran: Ran, expected: &str| {
            if !ran.is(expected) {
                complaints.push(format!("{when}: expected \"{expected}\", ran \"{ran}\""));
            }
        };
        expect("in the file", stage.save(text(edited)), reruns);
        let afresh = stage.afresh();
        let mut pictures = vec![("in the file", stage.shown(), &afresh)];
        if let Some(commented) = commented {
            expect("again in the file", stage.save(text(commented)), "");
        }
        let ran = stage.save(text(base));
        back.inspect(|back| expect("back in the file", ran, back));
        pictures.push(("back in the file", stage.shown(), as_before));
        expect("by hand", stage.write(base, edited), reruns);
        pictures.push(("by hand", stage.shown(), &afresh));
        expect("again by hand", stage.touch(&changed(base, edited)), "");
        let ran = stage.write(edited, base);
        back.inspect(|back| expect("back by hand", ran, back));
        pictures.push(("back by hand", stage.shown(), as_before));
        for (when, shown, expected) in pictures.iter().filter(|(_, shown, expected)| shown != *expected) {
            complaints.push(format!("{when}: the picture is off by {}", shown.difference(expected)));
        }
        complaints.into_iter()
    }
}
