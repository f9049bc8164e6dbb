//! RON text taken apart one level at a time, every part with its place.
//!
//! The `ron` crate parses; parts that are not looked at yet stay raw text (`ron::value::RawValue`), which borrows from the file, so
//! the place of a part is the difference of two addresses. Each part can then be read as the type that its place in the scene asks
//! for, and a mistake in one of them does not hide those in the others.

use super::problem::{BYTE_ORDER_MARK, Place};
use super::tokens::{tokens, unbalanced, without_comments_around};
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
    /// The value of the first field, which stands alone and without its name.
    Led(Part<'a>),
}

/// The shape that a variant's payload is read in.
#[derive(Clone, Copy)]
pub(super) enum Shape {
    Unit,
    Tuple(usize),
    Struct,
    /// A struct whose first field may stand without its name, if it stands alone.
    LedStruct,
}

/// A place at which the text is not what RON, or the shape asked for, wants.
pub(super) struct Misfit {
    pub bytes: Range<usize>,
    pub message: String,
    pub help: Option<String>,
    /// A second place that matters, and what it is.
    pub other: Option<(Range<usize>, String)>,
    /// Whether a bracket is at fault, whatever shape was asked for.
    pub is_bracket: bool,
}

impl<'a> Part<'a> {
    /// The whole text of a file, without the byte order mark that editors put in front of it.
    pub fn whole(text: &'a str) -> Self {
        Self { whole: text, text: text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text) }
    }

    /// The part at these bytes of a file.
    pub fn within(whole: &'a str, bytes: Range<usize>) -> Option<Self> {
        Some(Self { whole, text: whole.get(bytes)? })
    }

    /// What stands at a place.
    pub fn at(place: &'a Place) -> Self {
        let whole = place.file.text();
        Self { whole, text: &whole[place.bytes.clone()] }
    }

    /// The whole text of the file.
    pub fn file(&self) -> &'a str {
        self.whole
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
        Self { whole: self.whole, text: without_comments_around(text) }
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

    /// What ron says about the text, in words for whoever wrote it.
    fn misfit(&self, error: &ron::error::SpannedError) -> Misfit {
        let base = self.bytes().start;
        let start = offset(self.text, error.span.start);
        let token = tokens(&self.text[start..])
            .next()
            // The end is what was found, wherever the parser began to look.
            .filter(|_| error.code != ron::Error::Eof)
            .map(|token| start + token.start..start + token.end);
        let hides_brackets =
            matches!(error.code, ron::Error::ExpectedStringEnd | ron::Error::UnclosedBlockComment);
        if let Some(mut misfit) = self.bracket_misfit(token.as_ref()).filter(|_| !hides_brackets) {
            misfit.bytes = base + misfit.bytes.start..base + misfit.bytes.end;
            misfit.other = misfit.other.map(|(open, label)| (base + open.start..base + open.end, label));
            return misfit;
        }
        let bytes = if hides_brackets { start..self.text.len() } else { token.unwrap_or(start..start) };
        let line = self.text[bytes.clone()].lines().next().unwrap_or_default().len();
        let found = match &self.text[bytes.start..bytes.start + line] {
            "" => "nothing more".into(),
            text => format!("`{text}`"),
        };
        let (message, help) = explain(&error.code, &found);
        let last = self.text[..start].char_indices().last().map_or(0, |(at, _)| at);
        let bytes = if line == 0 { last..start } else { bytes.start..bytes.start + line };
        let bytes = base + bytes.start..base + bytes.end;
        Misfit { bytes, message, help: help.map(str::to_owned), other: None, is_bracket: false }
    }

    /// A bracket at fault, if that is what stopped the parser at `token`.
    fn bracket_misfit(&self, token: Option<&Range<usize>>) -> Option<Misfit> {
        let fault = unbalanced(self.text)?;
        if token.is_some_and(|token| token.start < fault.at) {
            return None;
        }
        let bracket = |at: usize| &self.text[at..at + 1];
        let closing = |at: usize| match bracket(at) {
            "(" => ")",
            "[" => "]",
            _ => "}",
        };
        let no_other = |bytes, message: String, help: String| Misfit {
            bytes,
            message,
            help: Some(help),
            other: None,
            is_bracket: true,
        };
        Some(match fault.open {
            None => no_other(
                fault.at..fault.at + 1,
                format!("`{}` closes nothing", bracket(fault.at)),
                "take it away, or open a bracket before it".into(),
            ),
            Some(open) if fault.at == self.text.len() => no_other(
                open..open + 1,
                format!("`{}` is never closed", bracket(open)),
                format!("write `{}` where what it opens ends", closing(open)),
            ),
            Some(open) => Misfit {
                other: Some((open..open + 1, "opened here".into())),
                ..no_other(
                    fault.at..fault.at + 1,
                    format!("expected `{}`, found `{}`", closing(open), bracket(fault.at)),
                    format!("close the `{}` before it", bracket(open)),
                )
            },
        })
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

    /// The parts of a struct: `(name: value, …)`, or `Shorthand(value)` where it has a shorthand for its first field.
    pub fn struct_payload(&self, shorthand: Option<&str>) -> Result<Payload<'a>, Misfit> {
        let is_short = self.word().is_some_and(|word| Some(word.text) == shorthand);
        match is_short.then(|| self.led()).flatten() {
            Some(first) => Ok(Payload::Led(first)),
            None => self.fields().map(Payload::Fields),
        }
    }

    /// What stands behind the name of a variant, read in the shape that the variant has.
    pub fn payload(&self, shape: Shape) -> Result<Payload<'a>, Misfit> {
        if let Shape::LedStruct = shape
            && let Some(first) = self.led()
        {
            return Ok(Payload::Led(first));
        }
        let payload = self.parse(|ron| ron.deserialize_enum("", &[], PayloadVisitor(shape)))?;
        Ok(match payload {
            RawPayload::Unit => Payload::Unit,
            RawPayload::Values(values) => Payload::Values(self.subs(values)),
            RawPayload::Fields(fields) => Payload::Fields(self.named(fields)),
        })
    }

    /// The value of `Variant(value)`; none where a name stands in front of it, or the text is otherwise not of this form.
    fn led(&self) -> Option<Part<'a>> {
        let text = |token: &Range<usize>| &self.text[token.clone()];
        let mut tokens = tokens(self.text).skip(usize::from(self.word().is_some()));
        tokens.next().filter(|token| text(token) == "(" && token.start > 0)?;
        let inside: Vec<Range<usize>> = tokens.collect();
        let (last, inside) = inside.split_last()?;
        // A comma may stand behind it.
        let inside = inside
            .strip_suffix(std::slice::from_ref(inside.last()?))
            .filter(|_| text(&inside[inside.len() - 1]) == ",")
            .unwrap_or(inside);
        let is_named = inside.get(1).is_some_and(|second| text(second) == ":");
        if text(last) != ")" || is_named {
            return None;
        }
        let mut depth = 0_usize;
        for token in inside {
            match text(token) {
                "," | ")" if depth == 0 => return None,
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth = depth.checked_sub(1)?,
                _ => {}
            }
        }
        Some(self.sub(&self.text[inside.first()?.start..inside.last()?.end]))
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

/// What is wrong, and how to mend it.
fn explain(error: &ron::Error, found: &str) -> (String, Option<&'static str>) {
    use ron::Error;
    let expected = |what: &str| format!("expected {what}, found {found}");
    match error {
        Error::ExpectedComma => (expected("`,`"), Some("a comma separates fields, entries and values")),
        Error::ExpectedMapColon => {
            (expected("`:` and a value"), Some("a name is followed by its value, `name: value`"))
        }
        Error::ExpectedIdentifier => {
            (expected("the name of a field"), Some("fields are written `name: value`"))
        }
        Error::ExpectedString => (expected("text in quotes"), None),
        Error::ExpectedStringEnd => {
            ("the text that begins here never ends".into(), Some("close it with `\"`"))
        }
        Error::UnclosedBlockComment => {
            ("the comment that begins here never ends".into(), Some("close it with `*/`"))
        }
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => (expected("`(`"), None),
        Error::ExpectedStructLikeEnd => (expected("`)`"), None),
        Error::ExpectedOptionEnd => (
            expected("`)`"),
            Some("`Some` holds one value: write `Some((name: value, …))`, or leave `Some` away"),
        ),
        Error::ExpectedArray => (expected("`[`"), None),
        Error::ExpectedArrayEnd => (expected("`]`"), None),
        Error::ExpectedMap => (expected("`{`"), None),
        Error::ExpectedMapEnd => (expected("`}`"), None),
        Error::ExpectedOption => (expected("`Some(value)` or `None`"), None),
        Error::TrailingCharacters => (expected("nothing more"), None),
        Error::UnexpectedChar(_) | Error::Eof => (expected("a value"), None),
        Error::ExceededRecursionLimit => (
            "brackets are nested more than 128 deep".into(),
            Some("a scene needs fewer than ten; is one opened too often?"),
        ),
        other => (sentence(&other.to_string()), None),
    }
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_lowercase().chain(letters).collect()).unwrap_or_default()
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

/// Parts that a bracket may hold.
const MOST_PARTS: usize = 1_000_000;

/// An error where there are as many parts already as there may be: each takes several times the memory of its text.
fn room<E: serde::de::Error>(parts: usize) -> Result<(), E> {
    match parts < MOST_PARTS {
        true => Ok(()),
        false => Err(E::custom(format_args!("expected at most {MOST_PARTS} parts in a bracket, found more"))),
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
            room(fields.len())?;
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
            room(entries.len())?;
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
            room(values.len())?;
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
            Shape::Struct | Shape::LedStruct => {
                rest.struct_variant(&[], FieldsVisitor).map(RawPayload::Fields)
            }
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
    fn a_first_value_may_stand_without_its_name() {
        let led = |text: &'static str| Part::whole(text).led().map(|first| first.text);
        assert_eq!(led("File(\"a, (b).nii\")"), Some("\"a, (b).nii\""));
        assert_eq!(led("File(/* x */ [(1, 2)], // y\n)"), Some("[(1, 2)]"));
        for other in
            ["File", "File()", "File(path: \"a\")", "File(\"a\", b: 1)", "File(1, 2)", "(1)", "File(\"a\")x"]
        {
            assert_eq!(led(other), None, "{other}");
        }
    }

    #[test]
    fn a_comment_behind_a_value_is_not_part_of_it() {
        let text = "{\"a\": 1 // one\n, \"b\": \"x//y\" /* two */}";
        let entries = Part::whole(text).entries().unwrap_or_else(|misfit| panic!("{}", misfit.message));
        let values: Vec<_> = entries.iter().map(|entry| (entry.name.text, entry.value.text)).collect();
        assert_eq!(values, [("\"a\"", "1"), ("\"b\"", "\"x//y\"")]);
    }
}
