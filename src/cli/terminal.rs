//! All that the command line prints.
//!
//! Standard output or error may be closed by who reads them, as `head` does, or lie on a disk that is full. Names come from files, and may
//! hold what a terminal would obey. Nothing of this is to make a program end with a panic.

use super::exit::Failure;
use crate::plain;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether something that a person was to read could not be written, other than because nobody reads any more.
static IS_LOST: AtomicBool = AtomicBool::new(false);

/// Writes data to standard output.
pub(super) fn data(text: &str) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    let written = output.write_all(plain::lines(text).as_bytes()).and_then(|()| output.flush());
    written.map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Failure::Unread,
        _ => Failure::Machine(format!("cannot write to standard output: {error}")),
    })
}

/// Writes JSON to standard output, with nothing in it that a terminal would obey.
pub(super) fn json(value: &serde_json::Value) -> Result<(), Failure> {
    let escaped = |letter: char| match letter {
        '\n' => "\n".to_owned(),
        // Such letters occur in texts only, where they may be written so.
        letter if plain::letter(letter) != letter => {
            letter.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")).collect()
        }
        letter => letter.to_string(),
    };
    let text = format!("{value:#}\n");
    let is_plain = |letter: char| letter == '\n' || plain::letter(letter) == letter;
    match text.chars().all(is_plain) {
        true => data(&text),
        false => data(&text.chars().map(escaped).collect::<String>()),
    }
}

/// Writes a line, or several, for a person to standard error.
pub(super) fn tell(text: impl Display) {
    styled(&plain::lines(&text.to_string()));
}

/// The same of what has colours, and nothing else that a terminal would obey.
pub(super) fn styled(text: &str) {
    let mut output = io::stderr().lock();
    let written = output.write_all(text.as_bytes()).and_then(|()| output.write_all(b"\n"));
    if written.is_err_and(|error| error.kind() != ErrorKind::BrokenPipe) {
        IS_LOST.store(true, Ordering::Relaxed);
    }
}

/// Whether something that a person was to read is lost, because the disk is full for example.
pub(super) fn is_lost() -> bool {
    IS_LOST.load(Ordering::Relaxed)
}

/// Has what the libraries log written as all else is.
pub(super) fn log_to(logger: &mut env_logger::Builder) {
    logger.format(|output, record| {
        let style = output.default_level_style(record.level());
        let (level, target, text) = (record.level(), record.target(), record.args().to_string());
        writeln!(output, "[{style}{level}{style:#} {target}] {}", plain::lines(&text))
    });
}
