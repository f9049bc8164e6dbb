//! What was told since the window opened.

use bevy_ecs::prelude::*;
use egui::{RichText, ScrollArea, Ui};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// How much a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Something was done.
    Info,
    /// Something deserves a look.
    Warning,
    /// Something failed.
    Error,
}

/// A line of the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// How much it matters.
    pub level: Level,
    /// What it says.
    pub text: String,
    /// How often it was said in a row.
    pub times: u32,
}

/// The lines told last. Clones share them, so that other threads can tell something too.
#[derive(Resource, Clone, Debug, Default)]
pub struct Log(Arc<Mutex<VecDeque<Line>>>);

/// Lines that are kept.
const CAPACITY: usize = 1000;

/// Bytes of a line that are kept.
const LONGEST: usize = 4000;

impl Log {
    /// Adds a line; the same one again is counted instead.
    pub fn tell(&self, level: Level, text: impl Into<String>) {
        let mut text: String = text.into();
        text.truncate(text.floor_char_boundary(LONGEST));
        let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match lines.back_mut().filter(|last| last.level == level && last.text == text) {
            Some(last) => last.times = last.times.saturating_add(1),
            None => lines.push_back(Line { level, text, times: 1 }),
        }
        while lines.len() > CAPACITY {
            lines.pop_front();
        }
    }

    /// All lines that are kept, the oldest first.
    pub fn lines(&self) -> Vec<Line> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().cloned().collect()
    }

    /// Forgets everything.
    pub fn clear(&self) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }
}

pub(super) fn show(ui: &mut Ui, world: &mut World) {
    let log = world.get_resource_or_init::<Log>().clone();
    let lines = log.lines();
    ui.horizontal(|ui| {
        ui.strong("Log");
        if ui.small_button("Copy").on_hover_text("Copy all lines to the clipboard").clicked() {
            let text: Vec<String> = lines.iter().map(written).collect();
            ui.copy_text(text.join("\n"));
        }
        if ui.small_button("Clear").on_hover_text("Forget all lines").clicked() {
            log.clear();
        }
    });
    ScrollArea::both().auto_shrink(false).stick_to_bottom(true).show(ui, |ui| {
        for line in &lines {
            ui.label(RichText::new(written(line)).monospace().color(colour(ui, line.level)));
        }
    });
}

fn written(line: &Line) -> String {
    match line.times {
        1 => line.text.clone(),
        times => format!("{} (x{times})", line.text),
    }
}

pub(super) fn colour(ui: &Ui, level: Level) -> egui::Color32 {
    match level {
        Level::Info => ui.visuals().text_color(),
        Level::Warning => ui.visuals().warn_fg_color,
        Level::Error => ui.visuals().error_fg_color,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_log_stays_within_bounds() {
        let log = Log::default();
        for number in 0..3000 {
            log.tell(Level::Info, format!("line {number}"));
        }
        let lines = log.lines();
        assert_eq!((lines.len(), lines[0].text.as_str()), (CAPACITY, "line 2000"));
        log.tell(Level::Info, "ß".repeat(LONGEST));
        assert_eq!(log.lines()[CAPACITY - 1].text.len(), LONGEST);
        log.clear();
        assert_eq!(log.lines(), []);
    }

    #[test]
    fn what_is_said_again_is_counted() {
        let log = Log::default();
        for _ in 0..1000 {
            log.tell(Level::Error, "the same");
        }
        log.tell(Level::Info, "the same");
        let lines = log.lines();
        assert_eq!(lines.iter().map(|line| line.times).collect::<Vec<_>>(), [1000, 1]);
        assert_eq!(written(&lines[0]), "the same (x1000)");
    }
}
