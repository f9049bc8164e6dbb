//! What each edit makes again: every field of every component that a scene can hold, and which passes run for it, of all that there are.
//!
//! The tables are in `dirty_rules/`, one for each scene. Each row is a value that is changed, in the scene's file and in the world by hand:
//! both run the same passes, equally often, and show what a program shows that starts with the scene as it is then. Saying the same again
//! runs nothing. A field without a row fails [`every_field_has_a_row`].
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "dirty_rules/as_found.rs"]
mod as_found;
#[path = "dirty_rules/data.rs"]
mod data;
#[path = "dirty_rules/fields.rs"]
mod fields;
#[path = "support/files.rs"]
mod files;
#[path = "dirty_rules/in_company.rs"]
mod in_company;
#[path = "dirty_rules/in_the_way.rs"]
mod in_the_way;
#[path = "dirty_rules/meshes.rs"]
mod meshes;
#[path = "dirty_rules/seen.rs"]
mod seen;
#[path = "dirty_rules/signs.rs"]
mod signs;
#[path = "dirty_rules/stage.rs"]
mod stage;
#[path = "dirty_rules/structure.rs"]
mod structure;
#[path = "dirty_rules/table.rs"]
mod table;
#[path = "dirty_rules/volumes.rs"]
mod volumes;

use stage::Stage;
use std::collections::BTreeSet;
use table::Table;
use tyndall_needs::needs;

const TABLES: [Table; 5] =
    [in_company::TABLE, in_the_way::TABLE, meshes::TABLE, volumes::TABLE, as_found::TABLE];

/// Fields without a row of their own: which series of a folder of DICOM files is read, of which the tables have none. Any other choice of what is
/// read of a file reads it again just so.
const WITHOUT_A_ROW: [&str; 2] = ["Volume.File.series.Some", "Volume.File.series.Some.0"];

#[test]
fn every_field_has_a_row() {
    let covered: BTreeSet<String> = TABLES.iter().flat_map(|table| table.covered()).collect();
    let missing: Vec<String> = fields::of_scenes()
        .into_iter()
        .filter(|path| !covered.contains(path) && !WITHOUT_A_ROW.contains(&path.as_str()))
        .collect();
    assert!(
        missing.is_empty(),
        "say in a table of tests/dirty_rules/ what changing these makes again:\n{}",
        missing.join("\n")
    );
}

#[needs(gpu)]
#[test]
fn meshes_and_volumes_in_company() {
    in_company::TABLE.hold();
}

#[needs(gpu)]
#[test]
fn meshes_and_volumes_in_the_way_of_light() {
    in_the_way::TABLE.hold();
}

#[needs(gpu)]
#[test]
fn what_is_opened_as_it_is_found() {
    as_found::TABLE.hold();
}

#[needs(gpu)]
#[test]
fn meshes_alone() {
    meshes::TABLE.hold();
}

#[needs(gpu)]
#[test]
fn volumes_alone() {
    volumes::TABLE.hold();
}

/// A system may write what is there already, and the clock of changes goes on.
#[needs(gpu)]
#[test]
fn writing_what_is_there_makes_nothing_again() {
    for table in TABLES {
        let mut stage = Stage::open(table.scene);
        let before = stage.shown();
        assert_eq!(stage.touch_everything().to_string(), "", "{}", table.name);
        assert!(stage.shown() == before, "{}", table.name);
    }
}
