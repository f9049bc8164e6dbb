//! RON text made of parts: on one line where it fits, else a line for each; and items put into, or taken out of, brackets in a text
//! that is there, in the style of their neighbours.

use super::tokens::tokens;
use std::ops::Range;

/// Columns that a line written by the program has at most, where it can be broken.
const LINE: usize = 120;

/// A value in RON, not yet laid out.
#[derive(Clone, Debug)]
pub(super) enum Written {
    /// What stands on one line.
    Word(String),
    /// Items between brackets.
    Group {
        /// The opening bracket, with the name in front of it if it has one.
        open: String,
        items: Vec<Item>,
        close: char,
        /// Whether there is a space inside the brackets, as around the components of an entity.
        spaced: bool,
    },
}

/// One of several values in brackets.
#[derive(Clone, Debug)]
pub(super) struct Item {
    /// The name of a field, or an entry's key.
    pub name: Option<String>,
    pub value: Written,
}

/// How a file breaks its lines.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Style {
    /// What a line is indented by within brackets.
    step: String,
    newline: &'static str,
}

/// Where text is to stand: what its line is indented by, and the column it starts at.
#[derive(Clone, Debug)]
pub(super) struct Cursor {
    indent: String,
    column: usize,
}

impl Style {
    /// The style of a text.
    pub fn of(text: &str) -> Self {
        let newline = if text.contains("\r\n") { "\r\n" } else { "\n" };
        let is_code = |line: &&str| !line.trim_start().starts_with(['/', '*']) && !line.trim().is_empty();
        let first = text.lines().filter(is_code).map(indent_of).find(|indent| !indent.is_empty());
        Self { step: first.unwrap_or("    ").to_owned(), newline }
    }
}

impl Cursor {
    /// The place of a byte in a text whose beginning stands at `start`.
    pub fn at(text: &str, byte: usize, start: &Self) -> Self {
        match text[..byte].rfind('\n') {
            Some(newline) => Self {
                indent: indent_of(&text[newline + 1..]).to_owned(),
                column: text[newline + 1..byte].chars().count(),
            },
            None => {
                Self { indent: start.indent.clone(), column: start.column + text[..byte].chars().count() }
            }
        }
    }

    /// The beginning of a file.
    pub fn start() -> Self {
        Self { indent: String::new(), column: 0 }
    }
}

fn indent_of(line: &str) -> &str {
    &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
}

impl Item {
    fn line(&self) -> String {
        match &self.name {
            Some(name) => format!("{name}: {}", self.value.line()),
            None => self.value.line(),
        }
    }

    fn lay_out(&self, style: &Style, cursor: &Cursor) -> String {
        let name = self.name.as_ref().map_or(String::new(), |name| format!("{name}: "));
        let column = cursor.column + name.chars().count();
        name + &self.value.lay_out(style, &Cursor { column, ..cursor.clone() })
    }
}

impl Written {
    /// All of it on one line.
    pub fn line(&self) -> String {
        match self {
            Self::Word(word) => word.clone(),
            Self::Group { open, items, close, spaced } => {
                let items: Vec<String> = items.iter().map(Item::line).collect();
                let space = if *spaced && !items.is_empty() { " " } else { "" };
                format!("{open}{space}{}{space}{close}", items.join(", "))
            }
        }
    }

    /// On one line if there is room, else broken at the outermost brackets, and within them where there is none either.
    pub fn lay_out(&self, style: &Style, cursor: &Cursor) -> String {
        let line = self.line();
        match self {
            // One column is for the comma behind it.
            Self::Group { open, items, close, .. }
                if cursor.column + line.chars().count() + 1 > LINE && !items.is_empty() =>
            {
                let indent = format!("{}{}", cursor.indent, style.step);
                let inner = Cursor { column: indent.chars().count(), indent };
                let mut text = open.clone();
                for item in items {
                    text += &format!("{}{}{},", style.newline, inner.indent, item.lay_out(style, &inner));
                }
                text + style.newline + &cursor.indent + &close.to_string()
            }
            _ => line,
        }
    }
}

/// Brackets in a text, and the items between them.
#[derive(Debug)]
struct Brackets {
    /// The byte behind the opening one.
    inside: usize,
    /// The closing one.
    close: usize,
    items: Vec<Stretch>,
}

/// The bytes of an item, and the comma behind it.
#[derive(Debug)]
struct Stretch {
    bytes: Range<usize>,
    comma: Option<usize>,
}

/// The first brackets of a text.
fn brackets(text: &str) -> Option<Brackets> {
    let sign = |token: &Range<usize>| text.as_bytes()[token.start];
    let mut tokens = tokens(text).peekable();
    // `#![enable(…)]` at the head of a file.
    while tokens.peek().is_some_and(|token| sign(token) == b'#') {
        tokens.find(|token| sign(token) == b']');
    }
    let open = tokens.find(|token| b"([{}])".contains(&sign(token)))?;
    let mut found = Brackets { inside: open.end, close: open.start, items: Vec::new() };
    let mut depth = if b"([{".contains(&sign(&open)) { 1 } else { return None };
    let mut item: Option<Range<usize>> = None;
    for token in tokens {
        match sign(&token) {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth -= 1,
            b',' if depth == 1 => {
                let comma = Some(token.start);
                found.items.extend(item.take().map(|bytes| Stretch { bytes, comma }));
                continue;
            }
            _ => {}
        }
        if depth == 0 {
            found.items.extend(item.map(|bytes| Stretch { bytes, comma: None }));
            return Some(Brackets { close: token.start, ..found });
        }
        item = Some(item.map_or(token.start, |item| item.start)..token.end);
    }
    None
}

/// Puts an item into the first brackets of `text`, so that it is item `index`, in the style of those around it. `start` is where the text
/// stands in its file. Whether there are such brackets.
pub(super) fn insert(text: &mut String, index: usize, item: &Item, style: &Style, start: &Cursor) -> bool {
    let Some(found) = brackets(text) else { return false };
    let Some(first) = found.items.first() else {
        insert_first(text, &found, item, style, start);
        return true;
    };
    let index = index.min(found.items.len());
    let has_own_lines = text[found.inside..first.bytes.start].contains('\n');
    let cursor = Cursor::at(text, found.items[index.max(1) - 1].bytes.start, start);
    let indent = cursor.indent.clone();
    let below = |item: &Item| {
        let column = indent.chars().count();
        format!("{}{indent}{}", style.newline, item.lay_out(style, &Cursor { column, ..cursor.clone() }))
    };
    if index == 0 {
        match has_own_lines.then(|| end_of_line(text, found.inside)).flatten() {
            Some(end) => text.insert_str(end, &format!("{},", below(item))),
            None => text.insert_str(first.bytes.start, &format!("{}, ", item.line())),
        }
        return true;
    }
    let before = &found.items[index - 1];
    let behind = before.comma.map_or(before.bytes.end, |comma| comma + 1);
    let comma = if before.comma.is_some() { "," } else { "" };
    let (at, new) = match has_own_lines.then(|| end_of_line(text, behind)).flatten() {
        Some(end) => (end, format!("{}{comma}", below(item))),
        // The closing bracket stands behind the last item, or the next item on its line.
        None if has_own_lines && index == found.items.len() => (behind, format!("{}{comma}", below(item))),
        None => (behind, format!(" {}{comma}", item.line())),
    };
    text.insert_str(at, &new);
    if before.comma.is_none() {
        text.insert(before.bytes.end, ',');
    }
    true
}

/// Puts an item between brackets that hold none.
fn insert_first(text: &mut String, found: &Brackets, item: &Item, style: &Style, start: &Cursor) {
    let inner = &text[found.inside..found.close];
    let cursor = Cursor::at(text, found.inside, start);
    if inner.trim().is_empty() && !inner.contains('\n') {
        let new = item.lay_out(style, &cursor);
        let space = if inner.is_empty() { "" } else { " " };
        text.replace_range(found.inside..found.close, &format!("{space}{new}{space}"));
        return;
    }
    let indent = format!("{}{}", cursor.indent, style.step);
    let new = item.lay_out(style, &Cursor { column: indent.chars().count(), indent: indent.clone() });
    let at = found.inside + inner.trim_end().len();
    let new = format!("{}{indent}{new},", style.newline);
    match inner[inner.trim_end().len()..].contains('\n') {
        true => text.insert_str(at, &new),
        false => text.replace_range(at..found.close, &format!("{new}{}{}", style.newline, cursor.indent)),
    }
}

/// The end of the line, its break not included, where nothing but white space and comments stands between `from` and it.
fn end_of_line(text: &str, from: usize) -> Option<usize> {
    let end = from + text[from..].find('\n')?;
    let end = if text[..end].ends_with('\r') { end - 1 } else { end };
    // A comment that goes on in the next line has no end here.
    let is_closed = text[from..end].matches("/*").count() == text[from..end].matches("*/").count();
    let is_bare = tokens(&text[from..end]).next().is_none();
    (is_bare && is_closed).then_some(end)
}

/// Takes item `index` out of the first brackets of `text`, with the comma that goes with it and the line that it leaves empty; comments
/// outside of it stay. Whether it is there.
pub(super) fn remove(text: &mut String, index: usize) -> bool {
    let Some(found) = brackets(text) else { return false };
    let Some(item) = found.items.get(index) else { return false };
    let Some(comma) = item.comma else {
        remove_last(text, &found);
        return true;
    };
    let line_start = found.inside.max(text[..item.bytes.start].rfind('\n').map_or(0, |newline| newline + 1));
    let starts_line =
        text[line_start..item.bytes.start].trim().is_empty() && text[..line_start].ends_with('\n');
    let rest = &text[comma + 1..];
    let line_end = rest.find('\n').map(|newline| comma + 2 + newline);
    let ends_line = line_end.is_some_and(|end| text[comma + 1..end].trim().is_empty());
    let spaces = rest.len() - rest.trim_start_matches([' ', '\t']).len();
    let kept = text[item.bytes.end..comma].trim().to_owned();
    let (from, to) = match (starts_line && kept.is_empty(), line_end) {
        (true, Some(end)) if ends_line => (line_start, end),
        _ if ends_line => (line_start + text[line_start..item.bytes.start].trim_end().len(), comma + 1),
        _ => (item.bytes.start, comma + 1 + spaces),
    };
    let from = if kept.is_empty() { from } else { item.bytes.start };
    text.replace_range(from..to, &kept);
    true
}

/// Takes out the last item, which has no comma behind it.
fn remove_last(text: &mut String, found: &Brackets) {
    let Some((last, others)) = found.items.split_last() else { return };
    let (from, comma) = match others.last().and_then(|before| before.comma) {
        Some(comma) => (comma + 1, Some(comma)),
        None => (found.inside, None),
    };
    let gap = text[from..last.bytes.start].to_owned();
    let behind = &text[last.bytes.end..found.close];
    let to = match behind.trim().is_empty() && comma.is_none() && gap.trim().is_empty() {
        true => found.close,
        false => last.bytes.end,
    };
    let kept = if gap.trim().is_empty() { "" } else { gap.trim_end_matches([' ', '\t']) };
    let breaks_anyway = text[to..].trim_start_matches([' ', '\t', '\r']).starts_with('\n');
    let kept = if breaks_anyway { kept.trim_end() } else { kept }.to_owned();
    text.replace_range(from..to, &kept);
    if let Some(comma) = comma {
        text.remove(comma);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inserted(text: &str, index: usize) -> String {
        let mut text = text.to_owned();
        let item = Item { name: Some("n".into()), value: Written::Word("0".into()) };
        let style = Style::of(&text);
        assert!(insert(&mut text, index, &item, &style, &Cursor::start()));
        text
    }

    fn removed(text: &str, index: usize) -> String {
        let mut text = text.to_owned();
        assert!(remove(&mut text, index));
        text
    }

    #[test]
    fn a_new_item_follows_the_style_of_its_neighbours() {
        let cases = [
            ("()", 0, "(n: 0)"),
            ("A( )", 0, "A( n: 0 )"),
            ("(\n)", 0, "(\n    n: 0,\n)"),
            ("( /* c */ )", 0, "( /* c */\n    n: 0,\n)"),
            ("(a: 1)", 1, "(a: 1, n: 0)"),
            ("#![enable(implicit_some)] (a: 1)", 1, "#![enable(implicit_some)] (a: 1, n: 0)"),
            ("(a: 1,)", 1, "(a: 1, n: 0,)"),
            ("( a: 1 /* c */ )", 1, "( a: 1, n: 0 /* c */ )"),
            ("(a: 1)", 0, "(n: 0, a: 1)"),
            ("(a: (1, 2), b: [3])", 1, "(a: (1, 2), n: 0, b: [3])"),
            ("(\n  a: 1,\n)", 1, "(\n  a: 1,\n  n: 0,\n)"),
            ("(\n\ta: 1 // c\n)", 1, "(\n\ta: 1, // c\n\tn: 0\n)"),
            ("(\n  a: 1, b: 2, // c, )\n)", 2, "(\n  a: 1, b: 2, // c, )\n  n: 0,\n)"),
            ("(\n  a: 1, b: 2,\n)", 1, "(\n  a: 1, n: 0, b: 2,\n)"),
            ("( // c\n  a: 1,\n)", 0, "( // c\n  n: 0,\n  a: 1,\n)"),
            ("(\n  a: 1)", 1, "(\n  a: 1,\n  n: 0)"),
            ("(\r\n  a: 1,\r\n)", 1, "(\r\n  a: 1,\r\n  n: 0,\r\n)"),
            ("(\n  a: 1, /* c\n  d */ b: 2\n)", 1, "(\n  a: 1, n: 0, /* c\n  d */ b: 2\n)"),
        ];
        for (text, index, expected) in cases {
            assert_eq!(inserted(text, index), expected, "{text}");
        }
    }

    #[test]
    fn an_item_goes_with_its_comma_and_comments_around_it_stay() {
        let cases = [
            ("(a: 1)", 0, "()"),
            ("( a: 1, )", 0, "( )"),
            ("( a: 1 )", 0, "()"),
            ("(a: 1, b: 2)", 0, "(b: 2)"),
            ("(a: 1, b: 2)", 1, "(a: 1)"),
            ("(a: 1, /* c */ b: 2 )", 1, "(a: 1 /* c */ )"),
            ("(\n  a: 1,\n  b: 2,\n)", 0, "(\n  b: 2,\n)"),
            ("(\n  a: 1,\n  b: 2,\n)", 1, "(\n  a: 1,\n)"),
            ("(\n  a: 1,\n  b: 2\n)", 1, "(\n  a: 1\n)"),
            ("(\n  // c\n  a: 1, // d\n  b: 2,\n)", 0, "(\n  // c\n  // d\n  b: 2,\n)"),
            ("(\n  a: 1, // c\n  b: 2\n)", 1, "(\n  a: 1 // c\n)"),
            ("(\n  a: 1, // c\n  b: 2 )", 1, "(\n  a: 1 // c\n )"),
            ("(\n  a: 1, b: 2,\n  c: 3,\n)", 1, "(\n  a: 1,\n  c: 3,\n)"),
            ("(a: 1 /* c */, b: 2)", 0, "(/* c */b: 2)"),
            ("(\n  a: (\n    1,\n  ),\n  b: 2,\n)", 0, "(\n  b: 2,\n)"),
        ];
        for (text, index, expected) in cases {
            assert_eq!(removed(text, index), expected, "{text}");
        }
    }

    #[test]
    fn what_is_not_there_is_neither_removed_nor_filled() {
        for text in ["", "a", "(", "(a: 1", ")", "]"] {
            assert!(!remove(&mut text.to_owned(), 0), "{text}");
            let item = Item { name: None, value: Written::Word("0".into()) };
            assert!(!insert(&mut text.to_owned(), 0, &item, &Style::of(text), &Cursor::start()), "{text}");
        }
    }

    #[test]
    fn long_values_are_broken_from_the_outside() {
        let word = |length| Item { name: Some("n".into()), value: Written::Word("0".repeat(length)) };
        let group = |items| Written::Group { open: "A(".into(), items, close: ')', spaced: false };
        let inner = Item { name: None, value: group(vec![word(50), word(30)]) };
        let text = group(vec![inner, word(60)]).lay_out(&Style::of(""), &Cursor::start());
        let expected = format!(
            "A(\n    A(n: {}, n: {}),\n    n: {},\n)",
            "0".repeat(50),
            "0".repeat(30),
            "0".repeat(60)
        );
        assert_eq!(text, expected);
    }
}
