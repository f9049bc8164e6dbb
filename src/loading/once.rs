//! What many components ask for is read once.

use crate::sources::SourceError;
use crate::sources::trail::{self, Trail};
use std::collections::HashMap;
use std::fmt::Debug;

/// Reads for components, each time that they differ from all before.
pub(super) struct Once<Source, Loaded> {
    read: fn(&Source) -> Result<Loaded, SourceError>,
    /// By the component as it prints itself: numbers that print alike are alike.
    known: HashMap<String, (Result<Loaded, SourceError>, Trail)>,
}

impl<Source: Debug, Loaded> Once<Source, Loaded> {
    pub fn new(read: fn(&Source) -> Result<Loaded, SourceError>) -> Self {
        Self { read, known: HashMap::new() }
    }

    /// What a component asks for, or why it is not to be had, and the files that were read.
    pub fn read(&mut self, source: &Source) -> &(Result<Loaded, SourceError>, Trail) {
        let read = self.read;
        self.known.entry(format!("{source:?}")).or_insert_with(|| trail::follow(|| read(source)))
    }
}
