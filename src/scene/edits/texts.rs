//! What the files would say: their own text, changed where the draft differs and nowhere else.

use super::EditError;
use super::draft::{Draft, DraftComponent, DraftEntity};
use super::shared::{own_file, shared};
use crate::scene::document::{SETTINGS, SceneDocument, SceneEntity};
use crate::scene::layout::{Item, Written};
use crate::scene::parts::{Named, Part};
use crate::scene::patch::{Change, Patcher, Splice, spliced};
use crate::scene::path::same;
use crate::scene::problem::SourceFile;
use crate::scene::write::{WriteError, quoted};
use bevy_reflect::TypeRegistry;
use bevy_reflect::structs::Struct;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A file that the draft changes.
pub(super) struct Changed {
    /// As it was read, under the path that the scene has for it.
    pub before: Arc<SourceFile>,
    /// Its new text.
    pub text: String,
}

/// The files that the draft changes.
pub(super) fn texts(
    base: &SceneDocument,
    draft: &Draft,
    registry: &TypeRegistry,
) -> Result<Vec<Changed>, EditError> {
    let mut files: BTreeMap<PathBuf, Sheet> = BTreeMap::new();
    for (name, entity) in &draft.entities {
        let Some(written) = entity.origin.as_ref().and_then(|origin| base.entity(origin)) else { continue };
        let sheet = sheet(&mut files, &written.place.file, registry);
        let part = written.place_of("");
        let text = sheet.entity(&Part::at(&part), written, entity)?;
        sheet.splices.push((part.bytes, text));
        if *name != written.name {
            sheet.splices.push((written.place.bytes.clone(), quoted(name)));
        }
    }
    for written in draft.removed.iter().filter_map(|name| base.entity(name)) {
        sheet(&mut files, &written.place.file, registry).removed.push(written.name.clone());
    }
    for (path, file) in &draft.files {
        for used in shared(base, path, file.type_id) {
            let sheet = sheet(&mut files, &used.place.file, registry);
            if sheet.splices.is_empty() {
                let (part, old) = (Part::at(&used.place), &used.component.value);
                let text =
                    sheet.patcher.value(&part, old.as_partial_reflect(), file.value.as_partial_reflect())?;
                sheet.splices.push((used.place.bytes.clone(), text));
            }
        }
    }
    let main = base.head_place("").ok_or(EditError::NoScene)?;
    let sheet = sheet(&mut files, &main.file, registry);
    sheet.added = draft.entities.iter().filter(|(_, entity)| entity.origin.is_none()).collect();
    sheet.settings(base, draft)?;
    let changed =
        files.into_values().map(|sheet| Ok(Changed { before: sheet.file.clone(), text: sheet.text(base)? }));
    let mut changed = changed.collect::<Result<Vec<_>, EditError>>()?;
    changed.retain(|file| file.before.text() != file.text);
    Ok(changed)
}

/// A file, and what is to be changed in it.
struct Sheet<'a> {
    file: Arc<SourceFile>,
    patcher: Patcher<'a>,
    splices: Vec<Splice>,
    /// Settings that are not written yet.
    inserted: Vec<Item>,
    removed: Vec<String>,
    added: Vec<(&'a String, &'a DraftEntity)>,
}

fn sheet<'f, 'a>(
    files: &'f mut BTreeMap<PathBuf, Sheet<'a>>,
    file: &Arc<SourceFile>,
    registry: &'a TypeRegistry,
) -> &'f mut Sheet<'a> {
    files.entry(file.path().to_owned()).or_insert_with(|| Sheet {
        file: file.clone(),
        patcher: Patcher::new(registry, file.text()),
        splices: Vec::new(),
        inserted: Vec::new(),
        removed: Vec::new(),
        added: Vec::new(),
    })
}

impl Sheet<'_> {
    /// The components of an entity that is written in the file.
    fn entity(&self, part: &Part, written: &SceneEntity, now: &DraftEntity) -> Result<String, EditError> {
        let Ok(fields) = part.fields() else { return Err(EditError::NoScene) };
        let (mut splices, mut changes) = (Vec::new(), Vec::new());
        for (at, Named { name, value }) in fields.iter().enumerate().rev() {
            let old = written.components.iter().find(|old| old.name == name.text);
            let new = now.component(name.text);
            let (Some(old), Some(new)) = (old, new) else {
                changes.push(Change::Remove(at));
                continue;
            };
            let text = match (&new.file, own_file(written, &old.name)) {
                (Some(new), Some(old)) if *new == old => continue,
                (None, None) => self.patcher.value(
                    value,
                    old.value.as_partial_reflect(),
                    new.value.as_partial_reflect(),
                )?,
                _ => self.patcher.laid_out(value, &component(&self.patcher, new)?.value),
            };
            splices.push((value.bytes(), text));
        }
        let mut count = fields.len() - changes.len();
        for new in &now.components {
            if !fields.iter().any(|field| field.name.text == new.name) {
                changes.push(Change::Insert(count, component(&self.patcher, new)?));
                count += 1;
            }
        }
        Ok(self.patcher.group(part, splices, changes))
    }

    /// The head of the scene.
    fn settings(&mut self, base: &SceneDocument, draft: &Draft) -> Result<(), EditError> {
        let Some(settings) = &draft.settings else { return Ok(()) };
        for name in SETTINGS {
            let (Some(old), Some(new)) = (base.settings.field(name), settings.field(name)) else { continue };
            match base.head_place(name) {
                Some(place) => {
                    self.splices.push((place.bytes.clone(), self.patcher.value(&Part::at(place), old, new)?));
                }
                None if same(old, new) => {}
                None => self.inserted.push(self.patcher.item(name, new)?),
            }
        }
        Ok(())
    }

    /// The text with all of it done.
    fn text(mut self, base: &SceneDocument) -> Result<String, EditError> {
        let file = self.file.clone();
        let whole = Part::whole(file.text());
        if self.inserted.is_empty() && self.removed.is_empty() && self.added.is_empty() {
            return Ok(spliced(file.text(), self.splices));
        }
        let Ok(fields) = whole.fields() else { return Err(EditError::NoScene) };
        let mut changes = Vec::new();
        match fields.iter().find(|field| field.name.text == "entities") {
            Some(field) => {
                let bytes = field.value.bytes();
                let is_within = |splice: &Splice| bytes.start <= splice.0.start && splice.0.end <= bytes.end;
                let (within, outside) = self.splices.drain(..).partition(is_within);
                self.splices = outside;
                let text = self.entities(&field.value, within)?;
                self.splices.push((bytes, text));
            }
            None if self.added.is_empty() => {}
            None => {
                let items = self.new_entities()?;
                let value = Written::Group { open: "{".into(), items, close: '}', spaced: true };
                changes.push(Change::Insert(fields.len(), Item { name: Some("entities".into()), value }));
            }
        }
        // Settings stand together, in front of what is long.
        let last = fields.iter().rposition(|field| SETTINGS.contains(&field.name.text));
        let front = last.map_or(0, |last| last + 1);
        let settings = self.inserted.drain(..).enumerate();
        changes.extend(settings.map(|(at, item)| Change::Insert(front + at, item)));
        let head = base.head_place("").filter(|place| place.file.path() == file.path());
        let head = head.map_or(whole.trimmed(), Part::at);
        let text = self.patcher.group(&head, std::mem::take(&mut self.splices), changes);
        Ok(spliced(file.text(), vec![(head.bytes(), text)]))
    }

    fn entities(&self, part: &Part, splices: Vec<Splice>) -> Result<String, EditError> {
        let Ok(entries) = part.entries() else { return Err(EditError::NoScene) };
        let is_removed = |entry: &Named| {
            let name = ron::from_str::<String>(entry.name.text);
            name.is_ok_and(|name| self.removed.contains(&name))
        };
        let removed: Vec<usize> = (0..entries.len()).filter(|at| is_removed(&entries[*at])).collect();
        let left = entries.len() - removed.len();
        let removals = removed.into_iter().rev().map(Change::Remove);
        let additions = self.new_entities()?.into_iter().enumerate();
        let additions = additions.map(|(at, item)| Change::Insert(left + at, item));
        Ok(self.patcher.group(part, splices, removals.chain(additions).collect()))
    }

    fn new_entities(&self) -> Result<Vec<Item>, WriteError> {
        let entity = |(name, entity): &(&String, &DraftEntity)| {
            let items = entity.components.iter().map(|new| component(&self.patcher, new));
            let items = items.collect::<Result<_, _>>()?;
            let value = Written::Group { open: "(".into(), items, close: ')', spaced: true };
            Ok(Item { name: Some(quoted(name)), value })
        };
        self.added.iter().map(entity).collect()
    }
}

/// A component that is not written yet.
fn component(patcher: &Patcher, new: &DraftComponent) -> Result<Item, WriteError> {
    match &new.file {
        Some(file) => {
            let value = Written::Word(format!("File({})", quoted(file.written())));
            Ok(Item { name: Some(new.name.clone()), value })
        }
        None => patcher.item(new.name.clone(), new.value.as_partial_reflect()),
    }
}
