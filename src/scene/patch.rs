//! The text of a value becomes that of another, where the two differ and nowhere else.

use super::layout::{Cursor, Item, Style, Written, insert, remove};
use super::parts::{Named, Part, Payload, Shape};
use super::path::is_option;
use super::wanted::{is_led, shorthand};
use super::write::{WriteError, Writer, equal, is_there};
use crate::components::Untagged;
use bevy_reflect::enums::{Enum, EnumInfo, VariantInfo};
use bevy_reflect::list::List;
use bevy_reflect::{
    PartialReflect, ReflectDeserialize, ReflectRef, TypeInfo, TypeRegistration, TypeRegistry,
};
use std::ops::Range;

/// Changes texts of one file.
pub(super) struct Patcher<'r> {
    writer: Writer<'r>,
    style: Style,
}

/// A new text for some bytes of a file.
pub(super) type Splice = (Range<usize>, String);

/// What is to be done to the items of a pair of brackets, in this order, each by the index that it has then.
pub(super) enum Change {
    Insert(usize, Item),
    Remove(usize),
}

type Patched = Result<String, WriteError>;

impl<'r> Patcher<'r> {
    /// For the file with this text.
    pub fn new(registry: &'r TypeRegistry, file: &str) -> Self {
        Self { writer: Writer { registry, leaves_out_defaults: true }, style: Style::of(file) }
    }

    /// The text for `new`, made from `part`, which reads as `old`.
    pub fn value(&self, part: &Part, old: &dyn PartialReflect, new: &dyn PartialReflect) -> Patched {
        if equal(old, new, self.writer.registry) {
            return Ok(part.text.to_owned());
        }
        match self.within(part, old, new)? {
            Some(text) => Ok(text),
            None => Ok(self.laid_out(part, &self.writer.value(new)?)),
        }
    }

    /// The text for what comes in the place of `part`.
    pub fn laid_out(&self, part: &Part, value: &Written) -> String {
        value.lay_out(&self.style, &self.cursor(part))
    }

    /// A field or entry that is not there yet.
    pub fn item(&self, name: impl Into<String>, value: &dyn PartialReflect) -> Result<Item, WriteError> {
        Ok(Item { name: Some(name.into()), value: self.writer.value(value)? })
    }

    /// The text of brackets with some parts in them exchanged, and then some items put in or taken out.
    pub fn group(&self, part: &Part, mut splices: Vec<Splice>, changes: Vec<Change>) -> String {
        let (base, mut text) = (part.bytes().start, part.text.to_owned());
        splices.sort_by_key(|(bytes, _)| bytes.start);
        for (bytes, new) in splices.into_iter().rev() {
            text.replace_range(bytes.start - base..bytes.end - base, &new);
        }
        let start = self.cursor(part);
        for change in changes {
            match change {
                Change::Remove(index) => remove(&mut text, index),
                Change::Insert(index, item) => insert(&mut text, index, &item, &self.style, &start),
            };
        }
        text
    }

    fn cursor(&self, part: &Part) -> Cursor {
        Cursor::at(part.file(), part.bytes().start, &Cursor::start())
    }

    /// The text with a change somewhere in it; none where all of it is another.
    fn within(
        &self,
        part: &Part,
        old: &dyn PartialReflect,
        new: &dyn PartialReflect,
    ) -> Result<Option<String>, WriteError> {
        let registry = self.writer.registry;
        let registration = old.get_represented_type_info().and_then(|info| registry.get(info.type_id()));
        let Some(registration) = registration else { return Ok(None) };
        let is_leaf = registration.data::<ReflectDeserialize>().is_some();
        match (registration.type_info(), old.reflect_ref(), new.reflect_ref()) {
            // A vector: its numbers keep their digits where they stay.
            (TypeInfo::Struct(info), ReflectRef::Struct(old), ReflectRef::Struct(new)) if is_leaf => {
                let is_vector = info.type_path().starts_with("glam::");
                let Some(parts) = part.tuple(old.field_len()).ok().filter(|_| is_vector) else {
                    return Ok(None);
                };
                let pairs =
                    old.iter_fields().map(|(_, field)| field).zip(new.iter_fields().map(|(_, field)| field));
                self.values(part, &parts, pairs)
            }
            _ if is_leaf => Ok(None),
            (TypeInfo::Struct(info), ReflectRef::Struct(old), ReflectRef::Struct(new)) => {
                let (led, written) = match part.struct_payload(shorthand(info)) {
                    Ok(Payload::Led(first)) => (Some(first), Vec::new()),
                    Ok(Payload::Fields(written)) => (None, written),
                    _ => return Ok(None),
                };
                let mut names = info.iter().map(|known| known.name());
                let first = names.next().and_then(|first| new.field(first));
                // What stands alone without its name cannot have company, nor be nothing.
                let is_alone = || {
                    let mut pairs = names.map(|name| (old.field(name), new.field(name)));
                    pairs.all(|pair| matches!(pair, (Some(old), Some(new)) if equal(old, new, registry)))
                };
                if led.is_some() && !(first.is_some_and(is_there) && is_alone()) {
                    return Ok(None);
                }
                let known = info.iter().map(|known| known.name());
                self.fields(part, led, &written, known, |name| Some((old.field(name)?, new.field(name)?)))
                    .map(Some)
            }
            (_, ReflectRef::TupleStruct(old), ReflectRef::TupleStruct(new)) => {
                let Ok(parts) = part.tuple(old.field_len()) else { return Ok(None) };
                self.values(part, &parts, old.iter_fields().zip(new.iter_fields()))
            }
            (_, ReflectRef::Tuple(old), ReflectRef::Tuple(new)) => {
                let Ok(parts) = part.tuple(old.field_len()) else { return Ok(None) };
                self.values(part, &parts, old.iter_fields().zip(new.iter_fields()))
            }
            (_, ReflectRef::List(old), ReflectRef::List(new)) => self.list(part, old, new),
            (TypeInfo::Enum(info), ReflectRef::Enum(old), ReflectRef::Enum(new)) => {
                self.enumeration(part, info, registration, old, new)
            }
            _ => Ok(None),
        }
    }

    /// Values without names, as many as before.
    fn values<'v>(
        &self,
        part: &Part,
        parts: &[Part],
        pairs: impl Iterator<Item = (&'v dyn PartialReflect, &'v dyn PartialReflect)>,
    ) -> Result<Option<String>, WriteError> {
        let pairs: Vec<_> = pairs.collect();
        if pairs.len() != parts.len() {
            return Ok(None);
        }
        let splices =
            parts.iter().zip(pairs).map(|(part, (old, new))| Ok((part.bytes(), self.value(part, old, new)?)));
        Ok(Some(self.group(part, splices.collect::<Result<_, _>>()?, Vec::new())))
    }

    fn fields<'n, 'v>(
        &self,
        part: &Part,
        led: Option<Part>,
        written: &[Named],
        known: impl Iterator<Item = &'n str>,
        pair: impl Fn(&str) -> Option<(&'v dyn PartialReflect, &'v dyn PartialReflect)>,
    ) -> Patched {
        let (mut splices, mut changes) = (Vec::new(), Vec::new());
        let items = written.len() + usize::from(led.is_some());
        for (index, name) in known.enumerate() {
            let Some((old, new)) = pair(name) else { continue };
            if let Some(first) = led.filter(|_| index == 0) {
                splices.push((first.bytes(), self.value(&first, old, new)?));
                continue;
            }
            match written.iter().find(|written| written.name.text == name) {
                Some(Named { value, .. }) => splices.push((value.bytes(), self.value(value, old, new)?)),
                None if equal(old, new, self.writer.registry) => {}
                None => changes.push(Change::Insert(items + changes.len(), self.item(name, new)?)),
            }
        }
        Ok(self.group(part, splices, changes))
    }

    fn list(&self, part: &Part, old: &dyn List, new: &dyn List) -> Result<Option<String>, WriteError> {
        let Ok(parts) = part.elements() else { return Ok(None) };
        if parts.len() != old.len() {
            return Ok(None);
        }
        let (old, new): (Vec<_>, Vec<_>) = (old.iter().collect(), new.iter().collect());
        let (mut splices, mut changes) = (Vec::new(), Vec::new());
        // From the back, so that what is still to come keeps its index.
        for (old_at, new_at) in self.aligned(&old, &new).into_iter().rev() {
            match (new_at.len(), old_at.len()) {
                (1, 1) => {
                    let part = &parts[old_at.start];
                    splices.push((part.bytes(), self.value(part, old[old_at.start], new[new_at.start])?));
                }
                (1, 0) => {
                    let value = self.writer.value(new[new_at.start])?;
                    changes.push(Change::Insert(old_at.start, Item { name: None, value }));
                }
                _ => changes.push(Change::Remove(old_at.start)),
            }
        }
        Ok(Some(self.group(part, splices, changes)))
    }

    /// Which elements of two lists belong together: pairs of one each, and those that only one of them has.
    fn aligned(
        &self,
        old: &[&dyn PartialReflect],
        new: &[&dyn PartialReflect],
    ) -> Vec<(Range<usize>, Range<usize>)> {
        let registry = self.writer.registry;
        let common = common_subsequence(old.len(), new.len(), |a, b| equal(old[a], new[b], registry));
        let mut all = Vec::new();
        let (mut a, mut b) = (0, 0);
        for (next_a, next_b) in common.into_iter().chain([(old.len(), new.len())]) {
            // What stands between two that stayed became what stands there now, as far as that goes.
            while a < next_a || b < next_b {
                let (end_a, end_b) = (next_a.min(a + 1), next_b.min(b + 1));
                all.push((a..end_a, b..end_b));
                (a, b) = (end_a, end_b);
            }
            if next_a < old.len() && next_b < new.len() {
                (a, b) = (next_a + 1, next_b + 1);
            }
        }
        all
    }

    fn enumeration(
        &self,
        part: &Part,
        info: &EnumInfo,
        registration: &TypeRegistration,
        old: &dyn Enum,
        new: &dyn Enum,
    ) -> Result<Option<String>, WriteError> {
        if old.variant_name() != new.variant_name() {
            return Ok(None);
        }
        let inner = || old.field_at(0).zip(new.field_at(0));
        if info.has_attribute::<Untagged>() {
            let Some((old, new)) = inner() else { return Ok(None) };
            return self.value(part, old, new).map(Some);
        }
        if is_option(registration.type_info()) {
            let Some((old, new)) = inner() else { return Ok(None) };
            let tagged = part.word().is_some_and(|word| word.text.eq_ignore_ascii_case("some"));
            let held = if tagged { part.option().ok().flatten() } else { Some(*part) };
            let Some(held) = held else { return Ok(None) };
            let text = self.value(&held, old, new)?;
            return Ok(Some(self.group(part, vec![(held.bytes(), text)], Vec::new())));
        }
        match info.variant(old.variant_name()) {
            Some(VariantInfo::Struct(variant)) => {
                let shape = if is_led(variant) { Shape::LedStruct } else { Shape::Struct };
                let (led, written) = match part.payload(shape) {
                    Ok(Payload::Fields(written)) => (None, written),
                    Ok(Payload::Led(first)) => (Some(first), Vec::new()),
                    _ => return Ok(None),
                };
                let mut others =
                    variant.iter().skip(1).map(|known| (old.field(known.name()), new.field(known.name())));
                let is_alone = others.all(
                    |pair| matches!(pair, (Some(old), Some(new)) if equal(old, new, self.writer.registry)),
                );
                if led.is_some() && !is_alone {
                    return Ok(None);
                }
                let known = variant.iter().map(|known| known.name());
                let pair = |name: &str| Some((old.field(name)?, new.field(name)?));
                self.fields(part, led, &written, known, pair).map(Some)
            }
            Some(VariantInfo::Tuple(variant)) => match part.payload(Shape::Tuple(variant.field_len())) {
                Ok(Payload::Values(parts)) => {
                    let pairs = old.iter_fields().map(|field| field.value());
                    self.values(part, &parts, pairs.zip(new.iter_fields().map(|field| field.value())))
                }
                _ => Ok(None),
            },
            _ => Ok(None),
        }
    }
}

/// The most pairs that are compared to find what two lists have in common; beyond, only their beginnings and ends are.
const MOST_COMPARED: usize = 1 << 20;

/// Indices of a longest common subsequence of two lists.
fn common_subsequence(
    old: usize,
    new: usize,
    is_equal: impl Fn(usize, usize) -> bool,
) -> Vec<(usize, usize)> {
    let start = (0..old.min(new)).take_while(|at| is_equal(*at, *at)).count();
    let most = old.min(new) - start;
    let end = (0..most).take_while(|at| is_equal(old - 1 - at, new - 1 - at)).count();
    let (rows, columns) = (old - start - end, new - start - end);
    let mut common: Vec<_> = (0..start).map(|at| (at, at)).collect();
    if rows * columns <= MOST_COMPARED && rows * columns > 0 {
        // length[row][column]: what is common to the lists from there on.
        let mut length = vec![vec![0_u32; columns + 1]; rows + 1];
        for row in (0..rows).rev() {
            for column in (0..columns).rev() {
                length[row][column] = match is_equal(start + row, start + column) {
                    true => length[row + 1][column + 1] + 1,
                    false => length[row + 1][column].max(length[row][column + 1]),
                };
            }
        }
        let (mut row, mut column) = (0, 0);
        while row < rows && column < columns {
            if is_equal(start + row, start + column) {
                common.push((start + row, start + column));
                (row, column) = (row + 1, column + 1);
            } else if length[row + 1][column] >= length[row][column + 1] {
                row += 1;
            } else {
                column += 1;
            }
        }
    }
    common.extend((0..end).rev().map(|at| (old - 1 - at, new - 1 - at)));
    common
}

/// Changes a whole file in some places.
pub(super) fn spliced(text: &str, mut splices: Vec<Splice>) -> String {
    let mut text = text.to_owned();
    splices.sort_by_key(|(bytes, _)| bytes.start);
    for (bytes, new) in splices.into_iter().rev() {
        text.replace_range(bytes, &new);
    }
    text
}
