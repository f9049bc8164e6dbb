//! What is wrong with a scene, where, and how to mend it.

use bevy_ecs::prelude::{Commands, Component, Entity, Resource, World};
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A text that problems point into.
#[derive(Debug)]
pub struct SourceFile {
    path: PathBuf,
    source: NamedSource<Arc<str>>,
}

impl SourceFile {
    /// The text of the file at `path`.
    pub fn new(path: impl Into<PathBuf>, text: impl Into<Arc<str>>) -> Arc<Self> {
        let path = path.into();
        Arc::new(Self { source: NamedSource::new(path.display().to_string(), text.into()), path })
    }

    /// Where the text came from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The text itself.
    pub fn text(&self) -> &str {
        self.source.inner()
    }

    /// Line and column of a byte, both counted from 1, the column in characters.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let before = &self.text()[..self.text().floor_char_boundary(byte)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
    }
}

/// A stretch of text in a file.
#[derive(Clone, Debug)]
pub struct Place {
    /// The file.
    pub file: Arc<SourceFile>,
    /// Bytes of its text.
    pub bytes: Range<usize>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.file.line_column(self.bytes.start);
        write!(f, "{}:{line}:{column}", self.file.path.display())
    }
}

/// How bad a problem is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Worth knowing; the picture is what the scene asks for.
    Note,
    /// The scene cannot be shown as written.
    Error,
}

/// One thing that is wrong, or worth knowing.
#[derive(Clone, Debug)]
pub struct Problem {
    /// How bad it is.
    pub severity: Severity,
    /// What was expected and what was found.
    pub message: String,
    /// What stands at the place.
    pub label: String,
    /// How to mend it.
    pub help: Option<String>,
    /// Where it is; none for what no text caused.
    pub place: Option<Place>,
    /// A second place that matters, and what it is.
    pub other: Option<(Place, String)>,
    /// The entity, and the path of the value in it, that the problem is about; for those found after the scene was read.
    pub subject: Option<(Entity, String)>,
}

impl Problem {
    /// An error without a place.
    pub fn error(message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            message: message.into(),
            label: "here".into(),
            help: None,
            place: None,
            other: None,
            subject: None,
        }
    }

    /// Something worth knowing.
    pub fn note(message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, ..Self::error(message) }
    }

    /// Says where.
    pub fn at(mut self, place: Place) -> Self {
        self.place = Some(place);
        self
    }

    /// Says where, if that is known.
    pub fn at_maybe(mut self, place: Option<Place>) -> Self {
        self.place = place;
        self
    }

    /// Says which value of which entity it is about; its place is looked up in the scene's document.
    pub fn on(mut self, entity: Entity, path: impl Into<String>) -> Self {
        self.subject = Some((entity, path.into()));
        self
    }

    /// Says what stands at the place.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Says how to mend it.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Whether it says the same about the same place.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        let same_place = match (&self.place, &other.place) {
            (Some(a), Some(b)) => Arc::ptr_eq(&a.file, &b.file) && a.bytes == b.bytes,
            (a, b) => a.is_none() && b.is_none(),
        };
        same_place && self.message == other.message
    }

    /// The problem with its text around it, as a person reads it in a terminal.
    pub fn render(&self, handler: &miette::GraphicalReportHandler) -> String {
        let mut text = String::new();
        // A formatter that writes to a String cannot fail.
        let _ = handler.render_report(&mut text, self);
        text
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Problem {}

impl Diagnostic for Problem {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.severity {
            Severity::Note => miette::Severity::Advice,
            Severity::Error => miette::Severity::Error,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place.as_ref().map(|place| &place.file.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref()?;
        let other = self.other.as_ref().filter(|(other, _)| Arc::ptr_eq(&other.file, &place.file));
        let first = LabeledSpan::new_primary_with_span(Some(self.label.clone()), place.bytes.clone());
        let second =
            other.map(|(other, label)| LabeledSpan::new_with_span(Some(label.clone()), other.bytes.clone()));
        Some(Box::new(std::iter::once(first).chain(second)))
    }
}

/// The problems of the scene's text, and those that the last update found with the world as a whole. What is wrong with an entity's own
/// files and sizes is in its [`EntityProblems`].
#[derive(Resource, Debug, Default)]
pub struct Problems(pub Vec<Problem>);

impl Problems {
    /// Whether any of them keeps the scene from being shown.
    pub fn has_errors(&self) -> bool {
        self.0.iter().any(|problem| problem.severity == Severity::Error)
    }

    /// Forgets what an update found: the next one finds it again where it is still so.
    pub(crate) fn forget_update(&mut self) {
        self.0.retain(|problem| problem.subject.is_none());
    }
}

/// What is wrong with an entity, by who found it. It stays until who found it looks again, so that a file which cannot be read is told
/// of for as long as that is so.
#[derive(Component, Clone, Debug, Default)]
pub struct EntityProblems(BTreeMap<&'static str, Vec<Problem>>);

impl EntityProblems {
    /// Replaces what `finder`, a system, found wrong with an entity earlier.
    pub fn set(commands: &mut Commands, entity: Entity, finder: &'static str, problems: Vec<Problem>) {
        commands.queue(move |world: &mut World| {
            let Ok(mut entity) = world.get_entity_mut(entity) else { return };
            let Some(mut all) = entity.get_mut::<Self>() else {
                if !problems.is_empty() {
                    entity.insert(Self(BTreeMap::from([(finder, problems)])));
                }
                return;
            };
            if !problems.is_empty() {
                all.0.insert(finder, problems);
            } else if all.0.contains_key(finder) {
                all.0.remove(finder);
            }
        });
    }

    /// All that is wrong with the entity.
    pub fn iter(&self) -> impl Iterator<Item = &Problem> {
        self.0.values().flatten()
    }
}
