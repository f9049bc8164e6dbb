//! RON text taken apart one level at a time, every part with its place.
//!
//! The `ron` crate parses; parts that are not looked at yet stay raw text (`ron::value::RawValue`), which borrows from the file, so
//! the place of a part is the difference of two addresses. Each part can then be read as the type that its place in the scene asks
//! for, and a mistake in one of them does not hide those in the others.

use ron::value::RawValue;
use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, EnumAccess, MapAccess, SeqAccess, VariantAccess, Visitor,
};
use std::fmt;
use std::ops::Range;

/// A stretch of the text of a file that holds one RON value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<'a> {
    whole: &'a str,
    /// The value, without white space around it.
    pub text: &'a str,
}

/// A named part: a field of a struct or an entry of a map.
pub(super) struct Named<'a> {
    /// The name, as a part of its own.
    pub name: Part<'a>,
    /// What stands behind the colon.
    pub value: Part<'a>,
}

/// What stands behind the name of an enum's variant.
pub(super) enum Payload<'a> {
    Unit,
    Values(Vec<Part<'a>>),
    Fields(Vec<Named<'a>>),
}

/// The shape that a variant's payload is read in.
#[derive(Clone, Copy)]
pub(super) enum Shape {
    Unit,
    Tuple(usize),
    Struct,
}

/// A place at which the text is not what RON, or the shape asked for, wants.
pub(super) struct Misfit {
    pub bytes: Range<usize>,
    pub message: String,
}

impl<'a> Part<'a> {
    /// The whole text of a file.
    pub fn whole(text: &'a str) -> Self {
        Self { whole: text, text }
    }

    /// Where the part is in its file.
    pub fn bytes(&self) -> Range<usize> {
        let start = self.text.as_ptr() as usize - self.whole.as_ptr() as usize;
        start..start + self.text.len()
    }

    /// The same without the comments and white space around it.
    pub fn trimmed(&self) -> Self {
        self.sub(self.text)
    }

    /// Part of the same file.
    fn sub(&self, text: &'a str) -> Self {
        Self { whole: self.whole, text: strip_comments(text) }
    }

    /// Reads the part with a seed of serde's.
    pub fn read<S: DeserializeSeed<'a>>(&self, seed: S) -> Result<S::Value, Misfit> {
        self.parse(|ron| seed.deserialize(ron))
    }

    fn parse<T>(
        &self,
        read: impl FnOnce(&mut ron::Deserializer<'a>) -> Result<T, ron::Error>,
    ) -> Result<T, Misfit> {
        let mut ron = ron::Deserializer::from_str(self.text).map_err(|error| self.misfit(&error))?;
        let value = read(&mut ron).map_err(|error| ron.span_error(error));
        let value = value.and_then(|value| ron.end().map(|()| value).map_err(|error| ron.span_error(error)));
        value.map_err(|error| self.misfit(&error))
    }

    fn misfit(&self, error: &ron::error::SpannedError) -> Misfit {
        let start = offset(self.text, error.span.start);
        let end = offset(self.text, error.span.end).clamp(start, self.text.len());
        let base = self.bytes().start;
        Misfit {
            bytes: base + start..base + end.max((start + 1).min(self.text.len())),
            message: error.code.to_string(),
        }
    }

    /// The parts of `(name: value, …)`.
    pub fn fields(&self) -> Result<Vec<Named<'a>>, Misfit> {
        self.parse(|ron| ron.deserialize_struct("", &[], FieldsVisitor)).map(|fields| self.named(fields))
    }

    /// The parts of `{key: value, …}`.
    pub fn entries(&self) -> Result<Vec<Named<'a>>, Misfit> {
        self.parse(|ron| ron.deserialize_map(EntriesVisitor)).map(|entries| self.named(entries))
    }

    /// The parts of `[value, …]`.
    pub fn elements(&self) -> Result<Vec<Part<'a>>, Misfit> {
        self.parse(|ron| ron.deserialize_seq(ValuesVisitor)).map(|values| self.subs(values))
    }

    /// The parts of `(value, …)`.
    pub fn tuple(&self, length: usize) -> Result<Vec<Part<'a>>, Misfit> {
        self.parse(|ron| ron.deserialize_tuple(length, ValuesVisitor)).map(|values| self.subs(values))
    }

    /// The inside of `Some(value)`, or nothing for `None`.
    pub fn option(&self) -> Result<Option<Part<'a>>, Misfit> {
        self.parse(|ron| ron.deserialize_option(OptionVisitor))
            .map(|value| value.map(|value| self.sub(value)))
    }

    /// The word that the part begins with, if it does: the name of a variant.
    pub fn word(&self) -> Option<Part<'a>> {
        let end = self.text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(self.text.len());
        let starts_well = self.text.starts_with(|c: char| c.is_alphabetic() || c == '_');
        starts_well.then(|| Part { whole: self.whole, text: &self.text[..end] })
    }

    /// What stands behind the name of a variant, read in the shape that the variant has.
    pub fn payload(&self, shape: Shape) -> Result<Payload<'a>, Misfit> {
        let payload = self.parse(|ron| ron.deserialize_enum("", &[], PayloadVisitor(shape)))?;
        Ok(match payload {
            RawPayload::Unit => Payload::Unit,
            RawPayload::Values(values) => Payload::Values(self.subs(values)),
            RawPayload::Fields(fields) => Payload::Fields(self.named(fields)),
        })
    }

    fn subs(&self, values: Vec<&'a str>) -> Vec<Part<'a>> {
        values.into_iter().map(|value| self.sub(value)).collect()
    }

    fn named(&self, pairs: Vec<(&'a str, &'a str)>) -> Vec<Named<'a>> {
        pairs
            .into_iter()
            .map(|(name, value)| Named { name: self.sub(name), value: self.sub(value) })
            .collect()
    }
}

/// Raw values keep the comments in front of and behind them; a place should not.
fn strip_comments(text: &str) -> &str {
    let mut text = text.trim();
    loop {
        if let Some(rest) = text.strip_prefix("//") {
            text = rest.split_once('\n').map_or("", |(_, rest)| rest).trim_start();
        } else if text.starts_with("/*") {
            text = text[block_comment_length(text)..].trim_start();
        } else {
            return strip_comments_behind(text);
        }
    }
}

/// Block comments nest in RON.
fn block_comment_length(text: &str) -> usize {
    let (mut depth, mut at) = (0usize, 0);
    while at < text.len() {
        let rest = &text.as_bytes()[at..];
        if rest.starts_with(b"/*") {
            depth += 1;
            at += 2;
        } else if rest.starts_with(b"*/") {
            depth -= 1;
            at += 2;
            if depth == 0 {
                return at;
            }
        } else {
            at += 1;
        }
    }
    text.len()
}

/// Cuts comments off the end: where the value alone reads as RON, the rest was comment.
fn strip_comments_behind(text: &str) -> &str {
    let last_line = text.rsplit('\n').next().unwrap_or(text);
    if !last_line.contains("//") && !text.ends_with("*/") {
        return text;
    }
    let ends = text.match_indices('/').map(|(at, _)| text[..at].trim_end());
    ends.filter(|end| !end.is_empty()).find(|end| RawValue::from_ron(end).is_ok()).unwrap_or(text)
}

/// Byte offset of a position that counts lines and characters from 1.
fn offset(text: &str, position: ron::error::Position) -> usize {
    let line_start = match position.line {
        0 | 1 => 0,
        line => text.match_indices('\n').nth(line - 2).map_or(text.len(), |(newline, _)| newline + 1),
    };
    let rest = &text[line_start..];
    line_start + rest.char_indices().nth(position.col.saturating_sub(1)).map_or(rest.len(), |(byte, _)| byte)
}

enum RawPayload<'a> {
    Unit,
    Values(Vec<&'a str>),
    Fields(Vec<(&'a str, &'a str)>),
}

/// Collects what stands between brackets as raw text.
struct FieldsVisitor;
struct EntriesVisitor;
struct ValuesVisitor;
struct OptionVisitor;
struct PayloadVisitor(Shape);

/// A field's name, borrowed from the text.
struct Identifier;

impl<'de> DeserializeSeed<'de> for Identifier {
    type Value = &'de str;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<&'de str, D::Error> {
        deserializer.deserialize_identifier(self)
    }
}

impl<'de> Visitor<'de> for Identifier {
    type Value = &'de str;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_borrowed_str<E>(self, name: &'de str) -> Result<&'de str, E> {
        Ok(name)
    }
}

impl<'de> Visitor<'de> for FieldsVisitor {
    type Value = Vec<(&'de str, &'de str)>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`(name: value, …)`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut fields = Vec::new();
        while let Some(name) = map.next_key_seed(Identifier)? {
            fields.push((name, map.next_value::<&RawValue>()?.get_ron()));
        }
        Ok(fields)
    }
}

impl<'de> Visitor<'de> for EntriesVisitor {
    type Value = Vec<(&'de str, &'de str)>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`{\"name\": value, …}`")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::new();
        while let Some(key) = map.next_key::<&RawValue>()? {
            entries.push((key.get_ron(), map.next_value::<&RawValue>()?.get_ron()));
        }
        Ok(entries)
    }
}

impl<'de> Visitor<'de> for ValuesVisitor {
    type Value = Vec<&'de str>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of values")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = seq.next_element::<&RawValue>()? {
            values.push(value.get_ron());
        }
        Ok(values)
    }
}

impl<'de> Visitor<'de> for OptionVisitor {
    type Value = Option<&'de str>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("`Some(value)` or `None`")
    }

    fn visit_none<E>(self) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        <&RawValue>::deserialize(deserializer).map(|value| Some(value.get_ron()))
    }
}

impl<'de> Visitor<'de> for PayloadVisitor {
    type Value = RawPayload<'de>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a variant")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<Self::Value, A::Error> {
        let (_, rest) = access.variant_seed(Identifier)?;
        match self.0 {
            Shape::Unit => rest.unit_variant().map(|()| RawPayload::Unit),
            Shape::Tuple(1) => {
                rest.newtype_variant::<&RawValue>().map(|value| RawPayload::Values(vec![value.get_ron()]))
            }
            Shape::Tuple(length) => rest.tuple_variant(length, ValuesVisitor).map(RawPayload::Values),
            Shape::Struct => rest.struct_variant(&[], FieldsVisitor).map(RawPayload::Fields),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_know_their_place() {
        let text = "( // head\n  a: 1.5, /* b /* nested */ */ b: (2, 3), // tail\n)";
        let fields = Part::whole(text).fields().unwrap_or_else(|misfit| panic!("{}", misfit.message));
        let values: Vec<_> =
            fields.iter().map(|field| (field.name.text, &text[field.value.bytes()])).collect();
        assert_eq!(values, [("a", "1.5"), ("b", "(2, 3)")]);
    }

    #[test]
    fn a_comment_behind_a_value_is_not_part_of_it() {
        let text = "{\"a\": 1 // one\n, \"b\": \"x//y\" /* two */}";
        let entries = Part::whole(text).entries().unwrap_or_else(|misfit| panic!("{}", misfit.message));
        let values: Vec<_> = entries.iter().map(|entry| (entry.name.text, entry.value.text)).collect();
        assert_eq!(values, [("\"a\"", "1"), ("\"b\"", "\"x//y\"")]);
    }
}
