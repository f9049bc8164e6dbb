//! The arrays of a legacy VTK file: where their data begin, and how to get over them.

use super::{SourceError, choice::Described, expected};
use crate::sources::{stored::StoredFormat, text::HeaderLines};

/// Bytes of one text in a binary file, and lines of one in any.
const MAX_TEXTS: u64 = 1 << 20;

/// What the values of an array belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Of {
    Points,
    Cells,
}

/// An array of numbers.
#[derive(Debug, Clone)]
pub(super) struct Array {
    /// What the file calls it.
    pub name: String,
    /// How one number is stored.
    pub format: StoredFormat,
    /// Numbers of each point or cell.
    pub components: u64,
    /// What it belongs to.
    pub of: Of,
    /// Where its data begin.
    pub offset: u64,
    /// Whether the file says that these are colours.
    pub says_colour: bool,
    /// The table of colours that it names.
    pub table: Option<String>,
}

impl Described for Array {
    fn name(&self) -> &str {
        &self.name
    }

    fn components(&self) -> u64 {
        self.components
    }

    /// Bytes, three or four of them, are taken for colours, as VTK draws them.
    fn is_colour(&self) -> bool {
        matches!(self.components, 3 | 4) && (self.says_colour || self.format == StoredFormat::U8)
    }
}

/// A table of colours: four numbers each.
#[derive(Debug, Clone)]
pub(super) struct Table {
    pub name: String,
    pub colours: u64,
    pub offset: u64,
}

/// The lines of a file, from one array to the next.
pub(super) struct Scan<'a, 'p> {
    pub lines: &'a mut HeaderLines<'p>,
    pub is_text: bool,
}

/// How the elements of an array are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Element {
    Number(StoredFormat),
    Bit,
    Text,
}

impl Scan<'_, '_> {
    /// An attribute of `count` points or cells, from the line that names it; `None` if it is one of which nothing is kept.
    pub fn attribute(
        &mut self,
        keyword: &str,
        rest: &str,
        of: Of,
        count: u64,
    ) -> Result<Vec<Array>, SourceError> {
        let words: Vec<&str> = rest.split_whitespace().collect();
        let word = |index: usize| words.get(index).copied().unwrap_or("");
        let (kind, components) = match keyword {
            "SCALARS" => (word(1), words.get(2).copied().unwrap_or("1")),
            "COLOR_SCALARS" if self.is_text => ("float", word(1)),
            "COLOR_SCALARS" => ("unsigned_char", word(1)),
            "VECTORS" | "NORMALS" => (word(1), "3"),
            "TENSORS" => (word(1), "9"),
            "TENSORS6" => (word(1), "6"),
            "TEXTURE_COORDINATES" => (word(2), word(1)),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => (word(1), "1"),
            _ => return Err(expected(self.lines, "an array of numbers", keyword)),
        };
        let (element, components) = (self.element(kind)?, self.count("numbers of each point", components)?);
        let table = if keyword == "SCALARS" { Some(self.table_name()?) } else { None };
        let array = self.array(word(0), element, components, of);
        self.skip(word(0), element, components.saturating_mul(count))?;
        let says_colour = keyword == "COLOR_SCALARS";
        Ok(array.map(|array| Array { says_colour, table, ..array }).into_iter().collect())
    }

    /// The arrays of a `FIELD name arrays` that have values for each of `count` points or cells; `None` if they belong to neither.
    pub fn field(&mut self, rest: &str, of: Option<(Of, u64)>) -> Result<Vec<Array>, SourceError> {
        let arrays =
            self.count("arrays after FIELD and its name", rest.split_whitespace().last().unwrap_or(""))?;
        let mut kept = Vec::new();
        for _ in 0..arrays {
            let line = self
                .line()?
                .ok_or_else(|| self.lines.error("the file ends within a FIELD; is it cut off?"))?;
            let words: Vec<&str> = line.split_whitespace().collect();
            let &[name, components, tuples, kind] = &words[..] else {
                return Err(expected(
                    self.lines,
                    "`name components tuples type` of an array of a FIELD",
                    &line,
                ));
            };
            let (components, tuples) = (self.count("components", components)?, self.count("tuples", tuples)?);
            let element = self.element(kind)?;
            if let Some((of, _)) = of.filter(|(_, count)| *count == tuples && components > 0) {
                kept.extend(self.array(name, element, components, of));
            }
            self.skip(name, element, components.saturating_mul(tuples))?;
        }
        Ok(kept)
    }

    /// Goes over numbers of a type; where they begin, and what that type is.
    pub fn numbers(
        &mut self,
        name: &str,
        kind: &str,
        count: u64,
    ) -> Result<(StoredFormat, u64), SourceError> {
        let Element::Number(format) = self.element(kind)? else {
            return Err(expected(self.lines, "coordinates of a type of numbers", kind));
        };
        let offset = self.lines.offset;
        self.skip(name, Element::Number(format), count)?;
        Ok((format, offset))
    }

    /// A table of colours, from `name size`.
    pub fn table(&mut self, rest: &str) -> Result<Table, SourceError> {
        let (name, colours) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let colours = self.count("colours", colours.trim())?;
        let table = Table { name: name.to_owned(), colours, offset: self.lines.offset };
        let format = if self.is_text { StoredFormat::F32 } else { StoredFormat::U8 };
        self.skip(name, Element::Number(format), colours.saturating_mul(4))?;
        Ok(table)
    }

    /// The next line that is not empty and tells of no array; `None` at the end.
    pub fn line(&mut self) -> Result<Option<String>, SourceError> {
        while let Some(line) = self.lines.next()? {
            let word = line.trim();
            if word.eq_ignore_ascii_case("METADATA") {
                // Up to an empty line.
                while self.lines.next()?.is_some_and(|line| !line.trim().is_empty()) {}
            } else if !word.is_empty() {
                return Ok(Some(word.to_owned()));
            }
        }
        Ok(None)
    }

    /// A count that is written.
    pub fn count(&self, what: &str, word: &str) -> Result<u64, SourceError> {
        word.parse().map_err(|_| expected(self.lines, &format!("a count of {what}"), word))
    }

    fn array(&self, name: &str, element: Element, components: u64, of: Of) -> Option<Array> {
        let Element::Number(format) = element else { return None };
        let offset = self.lines.offset;
        let array =
            Array { name: decoded(name), format, components, of, offset, says_colour: false, table: None };
        (components > 0).then_some(array)
    }

    fn table_name(&mut self) -> Result<String, SourceError> {
        let line = self.lines.next()?.unwrap_or_default();
        let mut words = line.split_whitespace();
        if !words.next().is_some_and(|word| word.eq_ignore_ascii_case("LOOKUP_TABLE")) {
            return Err(expected(self.lines, "`LOOKUP_TABLE default`", &line));
        }
        Ok(words.next().unwrap_or("default").to_owned())
    }

    /// Goes over the data of an array. The file may end in it: who reads it says so.
    fn skip(&mut self, name: &str, element: Element, count: u64) -> Result<(), SourceError> {
        match element {
            Element::Text => self.skip_texts(name, count),
            _ if self.is_text => self.lines.skip_words(count).map(|_| ()),
            Element::Bit => self.lines.skip_bytes(count.div_ceil(8)).and_then(|there| self.end_if(!there)),
            Element::Number(format) => {
                let there = self.lines.skip_bytes(count.saturating_mul(format.bytes()))?;
                self.end_if(!there)
            }
        }
    }

    fn end_if(&mut self, is_short: bool) -> Result<(), SourceError> {
        if is_short { self.lines.skip_to_end() } else { Ok(()) }
    }

    /// Texts are a line each, or in binary files have their length in front, in one, two, four or eight bytes.
    fn skip_texts(&mut self, name: &str, count: u64) -> Result<(), SourceError> {
        if count > MAX_TEXTS {
            return Err(expected(
                self.lines,
                &format!("at most {MAX_TEXTS} texts in `{name}`"),
                &count.to_string(),
            ));
        }
        for _ in 0..count {
            if self.is_text {
                self.lines.next()?;
                continue;
            }
            let Some(first) = self.lines.byte()? else { return Ok(()) };
            let more = [7, 3, 1, 0][usize::from(first >> 6)];
            let mut length = u64::from(first & 0x3f);
            for _ in 0..more {
                length = length << 8 | u64::from(self.lines.byte()?.unwrap_or(0));
            }
            if !self.lines.skip_bytes(length)? {
                return self.lines.skip_to_end();
            }
        }
        Ok(())
    }

    fn element(&self, kind: &str) -> Result<Element, SourceError> {
        Ok(Element::Number(match kind.to_lowercase().as_str() {
            "unsigned_char" | "vtktypeuint8" => StoredFormat::U8,
            "char" | "signed_char" | "vtktypeint8" => StoredFormat::I8,
            "unsigned_short" | "vtktypeuint16" => StoredFormat::U16,
            "short" | "vtktypeint16" => StoredFormat::I16,
            "unsigned_int" | "vtktypeuint32" => StoredFormat::U32,
            "int" | "vtkidtype" | "vtktypeint32" => StoredFormat::I32,
            "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" => StoredFormat::U64,
            "long" | "long_long" | "vtktypeint64" => StoredFormat::I64,
            "float" | "vtktypefloat32" => StoredFormat::F32,
            "double" | "vtktypefloat64" => StoredFormat::F64,
            "bit" => return Ok(Element::Bit),
            "string" | "utf8_string" => return Ok(Element::Text),
            found => {
                return Err(expected(
                    self.lines,
                    "a type from char to unsigned_long, float or double",
                    found,
                ));
            }
        }))
    }
}

/// A name in which VTK writes what it cannot as `%20`.
fn decoded(name: &str) -> String {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let digits =
            after.get(..2).filter(|_| first == b'%').and_then(|digits| std::str::from_utf8(digits).ok());
        let byte = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(byte.unwrap_or(first));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
