//! What is wrong with a scene, where, and how to mend it.

use super::excerpt::Excerpt;
use crate::plain;
use bevy_ecs::prelude::{Commands, Component, Entity, Resource, World};
use miette::{Diagnostic, LabeledSpan, SourceCode};
use std::collections::BTreeMap;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// A text that problems point into.
#[derive(Debug)]
pub struct SourceFile {
    path: PathBuf,
    text: Arc<str>,
    /// Whether problems are shown with lines of it.
    is_shown: bool,
    /// What stands in front of each [`BLOCK`] of bytes.
    blocks: OnceLock<Vec<Block>>,
}

/// So many bytes are counted over to find a line and column.
const BLOCK: usize = 1024;

/// What stands in front of some place of a text.
#[derive(Clone, Copy, Debug, Default)]
struct Block {
    lines: usize,
    characters: usize,
    /// Where the last of the lines begins.
    line_start: usize,
}

/// What a text may begin with to say that it is one.
pub(super) const BYTE_ORDER_MARK: char = '\u{feff}';

impl SourceFile {
    /// The text of the file at `path`.
    pub fn new(path: impl Into<PathBuf>, text: impl Into<Arc<str>>) -> Arc<Self> {
        Arc::new(Self::of(path.into(), text.into(), true))
    }

    /// The same of a file of which no line is to be seen by whoever is told of its problems.
    pub(super) fn unseen(path: impl Into<PathBuf>, text: impl Into<Arc<str>>) -> Arc<Self> {
        Arc::new(Self::of(path.into(), text.into(), false))
    }

    fn of(path: PathBuf, text: Arc<str>, is_shown: bool) -> Self {
        Self { path, text, is_shown, blocks: OnceLock::new() }
    }

    /// Where the text came from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The text itself, with the byte order mark that it may begin with.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether problems may be shown with lines of it.
    pub(super) fn is_shown(&self) -> bool {
        self.is_shown
    }

    /// Line and column of a byte, both counted from 1, the column in characters.
    pub fn line_column(&self, byte: usize) -> (usize, usize) {
        let byte = self.text.floor_char_boundary(byte);
        let at = self.before(byte);
        let mut column = at.characters - self.before(at.line_start).characters;
        if at.line_start == 0 && byte > 0 && self.text.starts_with(BYTE_ORDER_MARK) {
            column -= 1;
        }
        (at.lines + 1, column + 1)
    }

    /// The number of the line that a byte is on, counted from 0, and where that begins.
    pub(super) fn line_start(&self, byte: usize) -> (usize, usize) {
        let at = self.before(byte.min(self.text.len()));
        (at.lines, at.line_start)
    }

    /// What stands in front of a byte.
    fn before(&self, byte: usize) -> Block {
        let bytes = self.text.as_bytes();
        let blocks = self.blocks.get_or_init(|| {
            let mut last = Block::default();
            let starts = (0..=bytes.len()).step_by(BLOCK);
            starts
                .map(|start| {
                    last = last.and(bytes, start.saturating_sub(BLOCK)..start);
                    last
                })
                .collect()
        });
        let block = byte / BLOCK;
        blocks[block].and(bytes, block * BLOCK..byte)
    }
}

impl Block {
    /// With more bytes.
    fn and(mut self, bytes: &[u8], more: Range<usize>) -> Self {
        for (at, byte) in more.clone().zip(&bytes[more]) {
            // The bytes of a character but its first begin with these bits.
            self.characters += usize::from(byte & 0b1100_0000 != 0b1000_0000);
            if *byte == b'\n' {
                self.lines += 1;
                self.line_start = at + 1;
            }
        }
        self
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

/// The same bytes of the very same text.
impl PartialEq for Place {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.file, &other.file) && self.bytes == other.bytes
    }
}

impl Eq for Place {}

impl Hash for Place {
    fn hash<H: Hasher>(&self, state: &mut H) {
        Arc::as_ptr(&self.file).hash(state);
        self.bytes.hash(state);
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.file.line_column(self.bytes.start);
        let path = self.file.path.display().to_string();
        write!(f, "{}:{line}:{column}", plain::line(&path))
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

    /// Takes out of the words what may be from a file whose text is not to be seen.
    pub(super) fn conceal(&mut self) {
        let Some(place) = self.place.as_ref().filter(|place| !place.file.is_shown) else { return };
        self.message = concealed(&self.message, &place.file.text);
        self.help = self.help.take().map(|help| concealed(&help, &place.file.text));
        self.label = concealed(&self.label, &place.file.text);
    }

    /// What was expected and what was found, as it can be shown: without what a terminal would obey, and without more of a file than one
    /// cares to read.
    pub fn shown_message(&self) -> String {
        plain::message(&self.message)
    }

    /// How to mend it, likewise.
    pub fn shown_help(&self) -> Option<String> {
        self.help.as_deref().map(plain::message)
    }

    /// The problem with the lines around it, as a person reads it in a terminal: at most three lines of at most 160 characters each.
    pub fn render(&self, handler: &miette::GraphicalReportHandler) -> String {
        let mut text = String::new();
        // A formatter that writes to a String cannot fail.
        let _ = handler.render_report(&mut text, &Report::of(self));
        text
    }
}

/// Texts longer than this are not searched for each word of a message.
const SEARCHED: usize = 1 << 16;

/// A message without what was found in a text, and without any word in quotes that may be from there.
fn concealed(message: &str, text: &str) -> String {
    let end = [", found ", " but found "].iter().filter_map(|found| message.find(found)).min();
    let mut left = message[..end.unwrap_or(message.len())].to_owned();
    for quote in ['`', '"'] {
        let may_be_from_there = |part: &str| {
            let part = part.trim_end_matches('…');
            text.len() > SEARCHED || (!part.is_empty() && text.contains(part))
        };
        let parts = left.split(quote).enumerate();
        let parts: Vec<&str> =
            parts.map(|(at, part)| if at % 2 == 1 && may_be_from_there(part) { "…" } else { part }).collect();
        left = parts.join(&quote.to_string());
    }
    left
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.shown_message()),
            None => f.write_str(&self.shown_message()),
        }
    }
}

impl std::error::Error for Problem {}

/// A problem as the printer of diagnostics takes it.
#[derive(Debug)]
struct Report<'p> {
    problem: &'p Problem,
    help: Option<String>,
    excerpt: Option<Excerpt>,
}

impl<'p> Report<'p> {
    fn of(problem: &'p Problem) -> Self {
        let place = problem.place.as_ref().filter(|place| place.file.is_shown);
        let excerpt = place.map(|place| {
            let other = problem.other.as_ref().filter(|(other, _)| Arc::ptr_eq(&other.file, &place.file));
            Excerpt::new(&place.file, &place.bytes, other.map(|(other, _)| &other.bytes))
        });
        Self { problem, help: problem.shown_help(), excerpt }
    }
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.problem.fmt(f)
    }
}

impl std::error::Error for Report<'_> {}

impl Diagnostic for Report<'_> {
    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.problem.severity {
            Severity::Note => miette::Severity::Advice,
            Severity::Error => miette::Severity::Error,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| excerpt as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let own = plain::piece(&self.problem.label).into_owned();
        let other = self.problem.other.as_ref().map(|(_, label)| plain::piece(label).into_owned());
        let mut labels = self.excerpt.as_ref()?.labels().iter().cloned();
        let first = labels.next().map(|bytes| LabeledSpan::new_primary_with_span(Some(own), bytes));
        let second = labels.next().map(|bytes| LabeledSpan::new_with_span(other, bytes));
        Some(Box::new(first.into_iter().chain(second)))
    }
}

/// Problems that are told in full at once.
pub(crate) const MOST_TOLD: usize = 50;

/// "and 9,950 more", where there are more problems than are told.
pub(crate) fn more(problems: usize) -> Option<String> {
    let more = problems.checked_sub(MOST_TOLD).filter(|more| *more > 0)?;
    Some(format!("and {} more", grouped(more)))
}

/// A number with its digits in groups of three.
pub(crate) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let is_start = |at: usize| at > 0 && (digits.len() - at).is_multiple_of(3);
    digits
        .char_indices()
        .flat_map(|(at, digit)| is_start(at).then_some(',').into_iter().chain([digit]))
        .collect()
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
