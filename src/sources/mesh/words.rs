//! Numbers and names as notes and errors print them.

/// The most characters of a file that are quoted.
const MAX_QUOTED: usize = 40;

/// `1 face`, `2 faces`, `3 vertices`.
pub(in crate::sources) fn counted(count: u64, noun: &str) -> String {
    match (count, noun.strip_suffix("ex")) {
        (1, _) => format!("1 {noun}"),
        (_, Some(stem)) => format!("{count} {stem}ices"),
        (_, None) => format!("{count} {noun}s"),
    }
}

/// The beginning of what a file says, fit to print.
pub(in crate::sources) fn quoted(word: &str) -> String {
    let mut quoted: String = word.chars().take(MAX_QUOTED).flat_map(char::escape_default).collect();
    if word.chars().nth(MAX_QUOTED).is_some() {
        quoted.push_str("...");
    }
    quoted
}

/// `a`, `a and b`, `a, b and c`.
pub(in crate::sources) fn listed<T: AsRef<str>>(words: &[T]) -> String {
    match words {
        [] => String::new(),
        [word] => word.as_ref().to_owned(),
        [words @ .., last] => {
            let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
            format!("{} and {}", words.join(", "), last.as_ref())
        }
    }
}
