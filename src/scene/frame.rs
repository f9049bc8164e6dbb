//! Where the parts of a scene file are, down to its entities. Taking a long text apart costs most of the time of reading it, and need not be
//! done again for an edit within one entity.

use super::parts::{Named, Part};
use super::problem::SourceFile;
use std::ops::Range;
use std::sync::Arc;

/// The outer parts of a file.
#[derive(Clone)]
pub(super) struct Frame {
    file: Arc<SourceFile>,
    /// All but comments around it.
    whole: Range<usize>,
    /// Names and values of the head.
    fields: Vec<(Range<usize>, Range<usize>)>,
    /// What the head has in `entities`.
    entries: Vec<Entry>,
}

#[derive(Clone)]
struct Entry {
    /// The name without quotes.
    name: String,
    key: Range<usize>,
    value: Range<usize>,
}

impl Frame {
    /// Keeps where the parts of a file are.
    pub fn new<'a>(
        file: &Arc<SourceFile>,
        whole: &Part,
        fields: &[Named],
        entries: impl IntoIterator<Item = (&'a str, &'a Named<'a>)>,
    ) -> Self {
        let entry = |(name, parts): (&str, &Named)| Entry {
            name: name.to_owned(),
            key: parts.name.bytes(),
            value: parts.value.bytes(),
        };
        Self {
            file: file.clone(),
            whole: whole.bytes(),
            fields: fields.iter().map(|field| (field.name.bytes(), field.value.bytes())).collect(),
            entries: entries.into_iter().map(entry).collect(),
        }
    }

    /// The frame of another version of the file, if the two differ only within one entity, and that is whole in both.
    pub fn moved(&self, file: &Arc<SourceFile>) -> Option<Self> {
        let (old, new) = (self.file.text().as_bytes(), file.text().as_bytes());
        let before = common(old.iter(), new.iter());
        if before == old.len() && before == new.len() {
            return Some(Self { file: file.clone(), ..self.clone() });
        }
        let shorter = old.len().min(new.len()) - before;
        let after = common(old.iter().rev().take(shorter), new.iter().rev().take(shorter));
        let change = before..old.len() - after;
        let index = self.entries.partition_point(|entry| entry.value.start < change.start).checked_sub(1)?;
        let value = &self.entries[index].value;
        // Both parentheses of the entity are still there.
        if change.end >= value.end {
            return None;
        }
        let moved = |at: usize| if at < change.end { at } else { at + new.len() - old.len() };
        let range = |range: &Range<usize>| moved(range.start)..moved(range.end);
        // A text that is whole by itself ends no comment, text or bracket around it, and begins none.
        let part = Part::within(file.text(), range(value))?;
        if !part.text.starts_with('(') || part.fields().is_err() {
            return None;
        }
        let entry = |entry: &Entry| Entry {
            name: entry.name.clone(),
            key: range(&entry.key),
            value: range(&entry.value),
        };
        Some(Self {
            file: file.clone(),
            whole: range(&self.whole),
            fields: self.fields.iter().map(|(name, value)| (range(name), range(value))).collect(),
            entries: self.entries.iter().map(entry).collect(),
        })
    }

    /// All but comments around it.
    pub fn whole(&self) -> Option<Part<'_>> {
        Part::within(self.file.text(), self.whole.clone())
    }

    /// The fields of the head.
    pub fn fields(&self) -> Option<Vec<Named<'_>>> {
        self.fields.iter().map(|(name, value)| self.named(name, value)).collect()
    }

    /// The entities with their names.
    pub fn entries(&self) -> Option<Vec<(String, Named<'_>)>> {
        let entry = |entry: &Entry| Some((entry.name.clone(), self.named(&entry.key, &entry.value)?));
        self.entries.iter().map(entry).collect()
    }

    fn named(&self, name: &Range<usize>, value: &Range<usize>) -> Option<Named<'_>> {
        let part = |bytes: &Range<usize>| Part::within(self.file.text(), bytes.clone());
        Some(Named { name: part(name)?, value: part(value)? })
    }
}

/// How many bytes are equal from the beginning.
fn common<'a>(a: impl Iterator<Item = &'a u8>, b: impl Iterator<Item = &'a u8>) -> usize {
    a.zip(b).take_while(|(a, b)| a == b).count()
}
