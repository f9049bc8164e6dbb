//! The words and brackets of a RON text, as far as it takes to step over comments and to say which bracket is at fault.

use std::ops::Range;

/// The places of everything that is neither white space nor comment: texts in quotes, words with numbers, single signs.
pub(super) fn tokens(text: &str) -> Tokens<'_> {
    Tokens { text, at: 0 }
}

pub(super) struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl Iterator for Tokens<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        loop {
            let rest = &self.text[self.at..];
            let first = rest.chars().next()?;
            let start = self.at;
            if first.is_whitespace() {
                self.at += first.len_utf8();
            } else if rest.starts_with("//") {
                self.at += rest.find('\n').unwrap_or(rest.len());
            } else if rest.starts_with("/*") {
                self.at += block_comment_length(rest);
            } else {
                self.at += token_length(rest, first);
                return Some(start..self.at);
            }
        }
    }
}

/// The text without the comments and white space around it.
pub(super) fn without_comments_around(text: &str) -> &str {
    let mut tokens = tokens(text);
    let Some(first) = tokens.next() else { return &text[text.len()..] };
    let end = tokens.last().map_or(first.end, |last| last.end);
    &text[first.start..end]
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

/// The longest character in quotes: `'\u{10FFFF}'`.
const LONGEST_CHARACTER: usize = 12;

fn token_length(rest: &str, first: char) -> usize {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-');
    match first {
        '"' => quoted_length(rest, '"').unwrap_or(rest.len()),
        '\'' => {
            let near = &rest[..rest.floor_char_boundary(LONGEST_CHARACTER)];
            quoted_length(near, '\'').unwrap_or(1)
        }
        first if is_word(first) => {
            let word = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            match &rest[..word] {
                "r" | "br" => word + raw_length(&rest[word..]),
                "b" if rest[word..].starts_with('"') => {
                    quoted_length(&rest[word..], '"').map_or(rest.len(), |length| word + length)
                }
                _ => word,
            }
        }
        other => other.len_utf8(),
    }
}

/// Length of what begins with a quotation mark, up to the one that ends it.
fn quoted_length(text: &str, quote: char) -> Option<usize> {
    let mut letters = text.char_indices().skip(1);
    while let Some((at, letter)) = letters.next() {
        if letter == '\\' {
            letters.next();
        } else if letter == quote {
            return Some(at + letter.len_utf8());
        }
    }
    None
}

/// Length of the `#"…"#` of a raw text, or none where it is something else.
fn raw_length(text: &str) -> usize {
    let hashes = text.bytes().take_while(|byte| *byte == b'#').count();
    if !text[hashes..].starts_with('"') {
        return 0;
    }
    let end = format!("\"{}", "#".repeat(hashes));
    let inside = hashes + 1;
    text[inside..].find(&end).map_or(text.len(), |length| inside + length + end.len())
}

/// A bracket that does not fit.
pub(super) struct Unbalanced {
    /// The bracket at fault.
    pub at: usize,
    /// The open bracket that it meets, if there is one.
    pub open: Option<usize>,
}

/// The first bracket that closes nothing or another kind; or else the last that is never closed.
pub(super) fn unbalanced(text: &str) -> Option<Unbalanced> {
    let mut open = Vec::new();
    for token in tokens(text) {
        let wanted = match text.as_bytes()[token.start] {
            b'(' | b'[' | b'{' => {
                open.push(token.start);
                continue;
            }
            b')' => b'(',
            b']' => b'[',
            b'}' => b'{',
            _ => continue,
        };
        match open.pop() {
            Some(start) if text.as_bytes()[start] == wanted => {}
            open => return Some(Unbalanced { at: token.start, open }),
        }
    }
    open.pop().map(|open| Unbalanced { at: text.len(), open: Some(open) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_in_quotes_and_comments_do_not_count() {
        let text = r##"( a: "(\"(", b: r#"(")"#, c: '(', /* ( /* ( */ */ d: 1 // (
        )"##;
        assert!(unbalanced(text).is_none());
        let words: Vec<_> = tokens("r1: -1.5e-3,").map(|token| &"r1: -1.5e-3,"[token]).collect();
        assert_eq!(words, ["r1", ":", "-1.5e-3", ","]);
    }

    #[test]
    fn comments_around_a_value_go_and_those_inside_stay() {
        assert_eq!(without_comments_around("/* a */ ( 1 /* b */ ) // c"), "( 1 /* b */ )");
        assert_eq!(without_comments_around("\"x//y\" /* z */"), "\"x//y\"");
        assert_eq!(without_comments_around(" // only\n"), "");
        assert_eq!(without_comments_around("é//"), "é");
    }

    #[test]
    fn the_bracket_at_fault_is_found() {
        let found = |text: &str| unbalanced(text).map(|found| (found.at, found.open));
        assert_eq!(found("(()"), Some((3, Some(0))));
        assert_eq!(found("([)]"), Some((2, Some(1))));
        assert_eq!(found("())"), Some((2, None)));
    }
}
