//! The texts of a scene's files.

use super::names::nearest_file;
use super::problem::{Place, Problem, SourceFile};
use super::write::quoted;
use crate::regular_file::{self, Unopened};
use crate::sources::seems::{HEAD, READ_HERE, Seems, seems};
use crate::sources::{Searched, trail};
use std::io;
use std::path::Path;
use std::sync::Arc;

/// A scene is written by hand; what is larger is not one.
const MAX_BYTES: u64 = 64 << 20;

/// Reads the text of a file. `wanted`, "a scene", is what it should be, and `is_seen` whether problems are shown with lines of it.
pub(super) fn read_text(path: &Path, wanted: &str, is_seen: bool) -> Result<Arc<SourceFile>, Box<Problem>> {
    trail::note(path);
    let bytes = regular_file::read(path, MAX_BYTES).map_err(|error| Box::new(unopened(path, error)))?;
    if let Some(problem) = unusual_encoding(path, &bytes) {
        return Err(Box::new(problem));
    }
    if bytes.len() as u64 > MAX_BYTES {
        let what = seems(path, &bytes[..HEAD]).words();
        let message =
            format!("{} is {what} of more than {MAX_BYTES} bytes, too long for {wanted}", path.display());
        return Err(Box::new(Problem::error(message).help(READ_HERE)));
    }
    match String::from_utf8(bytes) {
        Ok(text) if is_seen => Ok(SourceFile::new(path, text)),
        Ok(text) => Ok(SourceFile::unseen(path, text)),
        Err(error) => Err(Box::new(not_utf_8(path, wanted, &error))),
    }
}

fn unopened(path: &Path, error: Unopened) -> Problem {
    match error {
        Unopened::NotAFile(found) => {
            let problem = Problem::error(format!("{}: expected a file, found {found}", path.display()));
            problem.help(match found {
                "a folder" => "name a file in it".to_owned(),
                _ => format!(
                    "files are read more than once, and watched: write what comes out of {found} into one"
                ),
            })
        }
        Unopened::Io(error) if error.kind() == io::ErrorKind::NotFound => not_found(path),
        Unopened::Io(error) => Problem::error(format!("cannot read {}: {error}", path.display())),
    }
}

fn not_found(path: &Path) -> Problem {
    let searched = Searched::of(path);
    let help = match (nearest_file(path), &searched) {
        (Some(near), _) => format!("did you mean `{near}`?"),
        (None, Searched::NoFolder(_)) => "check the path".into(),
        (None, _) => "check the path and the folder it is relative to".into(),
    };
    Problem::error(format!("there is no file {}{searched}", path.display())).help(help)
}

/// Text in units of more than a byte, which Windows writes.
fn unusual_encoding(path: &Path, bytes: &[u8]) -> Option<Problem> {
    let name = match bytes {
        [0xff, 0xfe, 0, 0, ..] | [0, 0, 0xfe, 0xff, ..] => "UTF-32",
        [0xff, 0xfe, ..] => "UTF-16LE",
        [0xfe, 0xff, ..] => "UTF-16BE",
        _ => without_mark(bytes)?,
    };
    let problem = Problem::error(format!("{} is {name} text; UTF-8 is read", path.display()));
    Some(problem.help(convert(path, name)))
}

/// Letters of the Latin alphabet have a zero on one side in UTF-16.
fn without_mark(bytes: &[u8]) -> Option<&'static str> {
    let (units, _) = bytes[..bytes.len().min(HEAD)].as_chunks::<2>();
    let is_plain = |byte: &u8| (b' '..=b'~').contains(byte) || b"\t\r\n".contains(byte);
    let share = |count: usize| count >= 2 && count * 4 >= units.len() * 3;
    if share(units.iter().filter(|[low, high]| is_plain(low) && *high == 0).count()) {
        return Some("UTF-16LE");
    }
    share(units.iter().filter(|[high, low]| is_plain(low) && *high == 0).count()).then_some("UTF-16BE")
}

fn convert(path: &Path, encoding: &str) -> String {
    let name = path.file_name().unwrap_or_default().display();
    format!("save it as UTF-8, or convert it: `iconv -f {encoding} -t UTF-8 {name} > utf8.ron`")
}

fn not_utf_8(path: &Path, wanted: &str, error: &std::string::FromUtf8Error) -> Problem {
    let head = &error.as_bytes()[..error.as_bytes().len().min(HEAD)];
    match seems(path, head) {
        Seems::Other("binary data") if is_latin(head) => {}
        Seems::Text => {}
        other => return no_text(path, wanted, other),
    }
    let start = error.utf8_error().valid_up_to();
    // Its bytes are not to be seen: what they say in another encoding is not known.
    let file = SourceFile::unseen(path, String::from_utf8_lossy(error.as_bytes()).as_ref());
    let bytes = start..start + char::REPLACEMENT_CHARACTER.len_utf8();
    let problem = Problem::error(format!("{} is not UTF-8 text", path.display()));
    problem.help(convert(path, "WINDOWS-1252")).at(Place { file, bytes })
}

/// Whether it can be text of one byte a letter.
fn is_latin(head: &[u8]) -> bool {
    head.iter().all(|byte| !byte.is_ascii_control() || byte.is_ascii_whitespace())
}

/// What is wrong with a file that is not what was `wanted` of it, as far as its beginning tells.
pub(super) fn no_text(path: &Path, wanted: &str, seems: Seems) -> Problem {
    let problem = Problem::error(format!("{} is {}, not {wanted}", path.display(), seems.words()));
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    match seems {
        _ if wanted != SCENE => problem,
        Seems::Mesh(_) => problem.help(format!("a scene with it: {}", scene_with("Mesh", &name))),
        Seems::Volume(_) => problem.help(format!("a scene with it: {}", scene_with("Volume", &name))),
        _ => problem.help(READ_HERE),
    }
}

fn scene_with(component: &str, name: &str) -> String {
    format!("`( entities: {{ \"it\": ( {component}: File({}) ) }} )`", quoted(name))
}

/// What files are called in messages that should be one of a scene, or of a component.
pub(super) const SCENE: &str = "a scene";
pub(super) const COMPONENT: &str = "a component";

/// The problem with a text that is no RON, if that is not what it was meant to be either.
pub(super) fn stranger(file: &SourceFile, wanted: &str) -> Option<Problem> {
    let bytes = file.text().as_bytes();
    let seems = seems(file.path(), &bytes[..bytes.len().min(HEAD)]);
    let is_named_so = file.path().extension().is_some_and(|ending| ending.eq_ignore_ascii_case("ron"));
    let text = file.text().trim_start_matches('\u{feff}').trim_start();
    let begins_so = text.starts_with(['(', '{', '[', '"', '/']) || text.starts_with("#![");
    let is_meant = seems == Seems::Text && (is_named_so || begins_so);
    (!is_meant).then(|| no_text(file.path(), wanted, seems))
}
