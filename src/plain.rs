//! Text from files and names as it can be shown: in a terminal, where control characters would be obeyed, and in few words.

use std::borrow::Cow;

/// The most characters of a line of a file that are ever shown.
pub(crate) const LINE: usize = 160;

/// The most lines of a file that are ever shown at once.
pub(crate) const LINES: usize = 3;

/// Characters of a name or of another piece of a file in the middle of a sentence.
const PIECE: usize = 60;

/// Characters of what a message has between two `` ` ``, which need not come from a file.
const QUOTE: usize = LINE;

/// Lines of a message that has several, such as those of compilers.
const MESSAGE_LINES: usize = 16;

/// What stands for a character that is not to reach a terminal: one that it would obey, or that hides or reorders what stands around it.
pub(crate) fn letter(letter: char) -> char {
    match letter {
        '\u{0}'..='\u{1f}' => char::from_u32(0x2400 + letter as u32).unwrap_or('\u{fffd}'),
        '\u{7f}' => '\u{2421}',
        '\u{80}'..='\u{9f}'
        | '\u{61c}'
        | '\u{200b}'
        | '\u{200e}'
        | '\u{200f}'
        | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{2069}'
        | '\u{feff}'
        | '\u{fff9}'..='\u{fffb}'
        | '\u{e0000}'..='\u{e007f}' => '\u{fffd}',
        other => other,
    }
}

/// A text of several lines without what a terminal would obey.
pub(crate) fn lines(text: &str) -> Cow<'_, str> {
    cleaned(text, |letter| letter == '\n')
}

/// The same on one line.
pub(crate) fn line(text: &str) -> Cow<'_, str> {
    cleaned(text, |_| false)
}

fn cleaned(text: &str, stays: impl Fn(char) -> bool) -> Cow<'_, str> {
    let is_clean = |c: char| stays(c) || letter(c) == c;
    match text.chars().all(is_clean) {
        true => Cow::Borrowed(text),
        false => text.chars().map(|c| if stays(c) { c } else { letter(c) }).collect::<String>().into(),
    }
}

/// A name, or another piece of a file, to stand in the middle of a sentence: on one line, and not long.
pub(crate) fn piece(text: &str) -> Cow<'_, str> {
    clipped(line(text), PIECE)
}

/// At most so many characters of a text.
fn clipped(text: Cow<'_, str>, most: usize) -> Cow<'_, str> {
    match text.char_indices().nth(most) {
        None => text,
        Some(_) => {
            let kept = text.char_indices().nth(most - 1).map_or(0, |(at, _)| at);
            format!("{}…", &text[..kept]).into()
        }
    }
}

/// A message as it can be shown: what it quotes between `` ` `` is clipped, and no more of it comes from a file than [`LINES`] of [`LINE`]
/// characters, whatever was put into it.
pub(crate) fn message(text: &str) -> String {
    let mut shown: Vec<Cow<str>> = text.lines().take(MESSAGE_LINES).map(Cow::Borrowed).collect();
    let most = if shown.len() > 1 { LINE } else { LINE * LINES };
    for line in &mut shown {
        *line = clipped(Cow::Owned(quotes_clipped(&cleaned(line, |_| false))), most);
    }
    if text.lines().nth(MESSAGE_LINES).is_some() {
        shown.push("…".into());
    }
    shown.join("\n")
}

/// Every piece between two `` ` `` clipped.
fn quotes_clipped(text: &str) -> String {
    let mut parts: Vec<Cow<str>> = text.split('`').map(Cow::Borrowed).collect();
    // Where the last one is not closed, it is no quotation.
    let closed = if parts.len().is_multiple_of(2) { parts.len() - 1 } else { parts.len() };
    for part in parts[..closed].iter_mut().skip(1).step_by(2) {
        *part = clipped(std::mem::take(part), QUOTE);
    }
    parts.join("`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_made_visible() {
        assert_eq!(
            line("a\u{1b}[31mb\tc\nd\u{7f}\u{9b}\u{202e}\u{feff}e"),
            "a␛[31mb␉c␊d␡\u{fffd}\u{fffd}\u{fffd}e"
        );
        assert_eq!(lines("a\r\nb"), "a␍\nb");
        assert!(matches!(line("ä – ok"), Cow::Borrowed(_)));
    }

    #[test]
    fn pieces_and_messages_have_an_end() {
        assert_eq!(piece(&"x".repeat(PIECE)), "x".repeat(PIECE));
        assert_eq!(piece(&"ß".repeat(PIECE + 1)), format!("{}…", "ß".repeat(PIECE - 1)));
        let long = message(&format!("there is no `{}`, is there?", "y".repeat(9999)));
        assert!(long.ends_with("y…`, is there?") && long.chars().count() < 190, "{long}");
        assert_eq!(message(&"z".repeat(9999)).chars().count(), LINE * LINES);
        let compiler = message(&"error `\n".repeat(100));
        assert_eq!((compiler.lines().count(), compiler.lines().next()), (MESSAGE_LINES + 1, Some("error `")));
        assert_eq!(message("a `b` c"), "a `b` c");
    }
}
