//! A scene that is edited again and again takes no more memory. Alone in its process, which is what is measured.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/files.rs"]
mod files;

use files::{Live, mark, scene};
use std::fs;
use tyndall::prelude::*;

/// Bytes of memory that this process has.
fn memory() -> usize {
    let text = fs::read_to_string("/proc/self/statm").unwrap();
    text.split_whitespace().nth(1).unwrap().parse::<usize>().unwrap() * 4096
}

#[test]
fn a_hundred_edits_take_no_memory() {
    let entity = |index: usize| {
        format!("\"ball {index}\": ( Mesh: Sphere(subdivisions: 0), Phong: File(\"look.ron\") ),\n")
    };
    let all: String = (0..1000).map(entity).collect();
    let text =
        |edit: usize| scene(&format!("{all}\"ball\": ( Mesh: Sphere(radius: {edit}.5, subdivisions: 0) ),"));
    let mut live = Live::open(&[("scene.ron", &text(0)), ("mark.ron", &mark(0.0)), ("look.ron", "()")]);
    let edit = |live: &mut Live, number: usize| {
        live.write("scene.ron", &text(number));
        live.until("the edit", |live| live.radius() == number as f32 + 0.5);
        live.write("look.ron", &format!("(shininess: {number}.5)"));
        live.until("the look", |live| live.get::<Phong>("ball 7").unwrap().shininess == number as f32 + 0.5);
        // As whoever draws does after each picture.
        std::mem::take(&mut *live.app.world_mut().resource_mut::<Report>());
    };
    (1..=30).for_each(|number| edit(&mut live, number));
    let (before, entities) = (memory(), live.app.world().entities().count_spawned());
    (31..=130).for_each(|number| edit(&mut live, number));
    assert_eq!(live.app.world().entities().count_spawned(), entities);
    let grown = memory().saturating_sub(before);
    // One text with its places and values is more than a megabyte.
    assert!(grown < 4 << 20, "{grown} bytes more after 100 edits");
}
