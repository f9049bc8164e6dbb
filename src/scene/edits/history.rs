//! What was done, to be undone, and what was undone, to be done again.

use super::change::{Change, continues, joined};
use bevy_reflect::TypeRegistry;
use std::collections::VecDeque;

/// How many steps can be undone.
const MOST_STEPS: usize = 1000;

/// Changes that are done and undone together.
#[derive(Debug)]
pub(super) struct Step {
    pub changes: Vec<Change>,
    /// Whether a drag goes on in which it was made, so that the next one may join it.
    is_open: bool,
}

#[derive(Debug, Default)]
pub(super) struct History {
    done: VecDeque<Step>,
    undone: Vec<Step>,
    is_dragging: bool,
}

impl History {
    /// All changes until the end of the drag become one step, in which those of the same values are one change.
    pub fn begin_drag(&mut self) {
        self.end_drag();
        self.is_dragging = true;
    }

    pub fn end_drag(&mut self) {
        self.is_dragging = false;
        self.done.iter_mut().for_each(|step| step.is_open = false);
    }

    pub fn is_dragging(&self) -> bool {
        self.is_dragging
    }

    /// Keeps what was done. What was undone before cannot be done again.
    pub fn push(&mut self, changes: Vec<Change>, registry: &TypeRegistry) {
        self.undone.clear();
        let changes = match self.done.pop_back_if(|last| last.is_open) {
            Some(mut last) => {
                // A component that is written down by the first change of it comes before the changes themselves.
                let tail = last.changes.split_off(last.changes.len().saturating_sub(changes.len()));
                if continues(&tail, &changes) {
                    last.changes.extend(joined(tail, changes, registry));
                } else {
                    last.changes.extend(tail.into_iter().chain(changes));
                }
                last.changes
            }
            None => changes,
        };
        if changes.is_empty() {
            return;
        }
        if self.done.len() == MOST_STEPS {
            self.done.pop_front();
        }
        self.done.push_back(Step { changes, is_open: self.is_dragging });
    }

    pub fn take_done(&mut self) -> Option<Step> {
        self.done.pop_back()
    }

    pub fn take_undone(&mut self) -> Option<Step> {
        self.undone.pop()
    }

    pub fn put_done(&mut self, step: Step) {
        self.done.push_back(Step { is_open: false, ..step });
    }

    pub fn put_undone(&mut self, step: Step) {
        self.undone.push(Step { is_open: false, ..step });
    }

    /// What the next undo, or redo, is about.
    pub fn next(&self, redo: bool) -> Option<String> {
        let step = if redo { self.undone.last() } else { self.done.back() };
        let subject = step?.changes.first()?.subject();
        Some(match subject {
            (Some(entity), "") => entity.to_owned(),
            (Some(entity), path) => format!("{entity}.{path}"),
            (None, path) => path.to_owned(),
        })
    }
}
