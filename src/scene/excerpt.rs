//! The few lines of a text that a problem is shown with.
//!
//! What the printer of diagnostics gets is a text of its own, made of at most three clipped lines, so that neither the length of a line nor
//! what stands in it matters to it.

use super::problem::SourceFile;
use crate::plain;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::ops::Range;

/// Where on a clipped line what it is about begins, at most.
const BEFORE: usize = 120;

/// Characters in front of what a clipped line is about.
const LEAD: usize = 40;

/// Columns from one stop of the tabulator to the next.
const TAB: usize = 4;

/// Lines of a file, with the stretches of them that are labelled.
#[derive(Debug)]
pub(super) struct Excerpt {
    name: String,
    text: String,
    chunks: Vec<Chunk>,
    /// The labels in the text, that of the place itself first.
    labels: Vec<Range<usize>>,
    /// Line and column in the file of the place itself, counted from 0.
    at: (usize, usize),
}

/// Lines that follow each other.
#[derive(Debug)]
struct Chunk {
    bytes: Range<usize>,
    /// The first line's number in the file, from 0.
    first: usize,
    lines: usize,
}

impl Excerpt {
    /// The lines around `label`, or those of both labels.
    pub fn new(file: &SourceFile, label: &Range<usize>, other: Option<&Range<usize>>) -> Self {
        let (line, column) = file.line_column(label.start);
        let name = plain::line(&file.path().display().to_string()).into_owned();
        let mut excerpt = Self {
            name,
            text: String::new(),
            chunks: Vec::new(),
            labels: vec![0..0; 1 + usize::from(other.is_some())],
            at: (line - 1, column - 1),
        };
        let labels: Vec<Range<usize>> = [label].into_iter().chain(other).cloned().collect();
        for (first, last) in shown_lines(file, &labels) {
            excerpt.push(file.text(), first, last, &labels);
        }
        excerpt
    }

    /// The labels in [`Self`] as a source, that of the place itself first.
    pub fn labels(&self) -> &[Range<usize>] {
        &self.labels
    }

    fn push(&mut self, text: &str, first: Line, last: Line, labels: &[Range<usize>]) {
        let start = self.text.len();
        let mut line = first;
        loop {
            let about = labels.iter().map(|label| label.start).find(|start| line.holds(*start));
            let written = Written::new(text, &line, about.unwrap_or(line.start), labels);
            for (label, shown) in labels.iter().zip(&mut self.labels) {
                let end = self.text.len() + written.place(label.end);
                if line.holds(label.start) {
                    *shown = self.text.len() + written.place(label.start)..end;
                } else if first.start <= label.start && line.start < label.end && label.end <= last.end + 1 {
                    shown.end = end;
                }
            }
            self.text.push_str(&written.text);
            self.text.push('\n');
            match line.next(text) {
                Some(next) if line.number < last.number => line = next,
                _ => break,
            }
        }
        let lines = line.number - first.number + 1;
        self.chunks.push(Chunk { bytes: start..self.text.len(), first: first.number, lines });
    }
}

/// A line of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    number: usize,
    /// Where it begins, and where it ends, without what ends it.
    start: usize,
    end: usize,
}

impl Line {
    fn of(file: &SourceFile, byte: usize) -> Self {
        let (number, start) = file.line_start(byte);
        Self { number, start, end: end_of_line(file.text(), start.max(byte)) }
    }

    fn next(&self, text: &str) -> Option<Self> {
        let start = self.end + 1;
        (start < text.len()).then(|| Self { number: self.number + 1, start, end: end_of_line(text, start) })
    }

    fn holds(&self, byte: usize) -> bool {
        (self.start..=self.end).contains(&byte)
    }
}

fn end_of_line(text: &str, from: usize) -> usize {
    let from = text.ceil_char_boundary(from);
    text[from..].find('\n').map_or(text.len(), |newline| from + newline)
}

/// The first and last lines of what is shown: all that fits of one label with what stands around it, or the lines of two.
fn shown_lines(file: &SourceFile, labels: &[Range<usize>]) -> Vec<(Line, Line)> {
    let text = file.text();
    let mut spans: Vec<(Line, Line)> = labels
        .iter()
        .map(|label| {
            let first = Line::of(file, label.start);
            let last = Line::of(file, label.end.max(label.start + 1) - 1);
            // A label over many lines is shown where it begins.
            (first, if last.number - first.number < plain::LINES { last } else { first })
        })
        .collect();
    spans.sort_unstable_by_key(|(first, _)| first.number);
    if let [(first, _), (second, last)] = spans[..] {
        let last = if last.number < first.number + plain::LINES { last } else { second };
        if last.number < first.number + plain::LINES {
            return vec![(first, last)];
        }
        // Lines of chunks that touch would be taken for one.
        return vec![(first, first), (second, second)];
    }
    let [(mut first, mut last)] = spans[..] else { return spans };
    if last.number - first.number + 1 < plain::LINES && first.start > 0 {
        first = Line::of(file, first.start - 1);
    }
    if last.number - first.number + 1 < plain::LINES
        && let Some(next) = last.next(text)
    {
        last = next;
    }
    vec![(first, last)]
}

/// A line as it is shown.
struct Written {
    text: String,
    /// Where it begins in the file's text.
    from: usize,
    /// Places of the file's text that are wanted, as they are in this one, with their columns.
    places: Vec<(usize, usize, usize)>,
    /// Whether there is more of the line.
    is_cut: bool,
}

impl Written {
    /// The line, as far as there is room, with the place `about` in it.
    fn new(text: &str, line: &Line, about: usize, labels: &[Range<usize>]) -> Self {
        let whole = Self::from(text, line, line.start, labels);
        let column = whole.places.iter().find(|(place, ..)| *place >= about).map(|(.., column)| *column);
        if !whole.is_cut || column.is_some_and(|column| column <= BEFORE) {
            return whole;
        }
        let about = text.floor_char_boundary(about);
        let lead = text[line.start..about].char_indices().rev().take(LEAD).last();
        Self::from(text, line, lead.map_or(about, |(at, _)| line.start + at), labels)
    }

    fn from(text: &str, line: &Line, from: usize, labels: &[Range<usize>]) -> Self {
        let mut written = Self { text: String::new(), from, places: Vec::new(), is_cut: false };
        let is_whole = from == line.start;
        let mut columns = 0;
        if !is_whole {
            written.text.push('…');
            columns += 1;
        }
        let shown = &text[from..line.end];
        let shown = shown.strip_suffix('\r').unwrap_or(shown);
        let mut is_indent = is_whole;
        for (at, letter) in shown.char_indices() {
            is_indent &= matches!(letter, ' ' | '\t');
            let wide = if letter == '\t' && is_indent { TAB - columns % TAB } else { 1 };
            if labels.iter().any(|label| [label.start, label.end].contains(&(from + at))) {
                written.places.push((from + at, written.text.len(), columns));
            }
            let has_more = at + letter.len_utf8() < shown.len();
            if columns + wide + usize::from(has_more) > plain::LINE {
                written.text.push('…');
                written.is_cut = true;
                return written;
            }
            match letter {
                '\t' => written.text.extend(std::iter::repeat_n(' ', wide)),
                // The mark that the file begins with says nothing.
                '\u{feff}' if from + at == 0 => continue,
                letter => written.text.push(plain::letter(letter)),
            }
            columns += wide;
        }
        written.places.push((line.end, written.text.len(), columns));
        written
    }

    /// Where a wanted place is; its end, where that is not shown.
    fn place(&self, at: usize) -> usize {
        if at < self.from {
            return 0;
        }
        let known = self.places.iter().find(|(place, ..)| *place >= at);
        known.map_or(self.text.len(), |(_, shown, _)| *shown)
    }
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let end = span.offset() + span.len();
        let around = |chunk: &&Chunk| chunk.bytes.start <= span.offset() && end <= chunk.bytes.end;
        let chunk = self.chunks.iter().find(around).ok_or(MietteError::OutOfBounds)?;
        // Without lines around it, it is asked where the place is.
        let is_place = before == 0 && after == 0 && self.labels[0].start == span.offset();
        let (line, column) = if is_place { self.at } else { (chunk.first, 0) };
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            &self.text.as_bytes()[chunk.bytes.clone()],
            chunk.bytes.clone().into(),
            line,
            column,
            chunk.lines,
        )))
    }
}
