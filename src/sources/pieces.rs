//! Samples that lie in several files, one after the other.

use std::path::PathBuf;

use super::{
    SourceError, file,
    stored::Stored,
    stream::{SampleStream, Surplus},
};

/// The most files that one volume may lie in.
pub(super) const MAX_FILES: usize = 1 << 16;

/// Reads `whole` from files of equally many of the `all` samples that are there. `place` says where in its file each piece
/// begins.
pub(super) fn read(
    whole: &SampleStream,
    all: u64,
    files: &[PathBuf],
    notes: &mut Vec<String>,
    place: impl Fn(&mut SampleStream) -> Result<(), SourceError>,
) -> Result<Stored, SourceError> {
    let count = files.len() as u64;
    if count == 0 || !all.is_multiple_of(count) {
        return Err(SourceError::Unsupported {
            path: whole.path.to_owned(),
            found: format!("{} do not divide by {count} data files", whole.what),
            mend: "correct the list of files or the size".to_owned(),
        });
    }
    let in_each = all / count;
    let mut joined = whole.format.none();
    for (index, path) in files.iter().enumerate() {
        let mut piece = SampleStream { path, ..whole.clone() };
        if count > 1 {
            piece.pick = whole.pick.part(index as u64 * in_each);
            piece.samples = piece.pick.count(in_each);
            piece.what = format!("one of {count} equal parts of {}", whole.what);
        }
        if piece.samples == 0 {
            continue;
        }
        place(&mut piece)?;
        let (file, file_bytes) = file::open(path)?;
        if count == 1 {
            return piece.read(file, file_bytes, notes);
        }
        piece.surplus = if piece.pick.is_all() { Surplus::Refuse } else { Surplus::Ignore };
        let samples = piece.read(file, file_bytes, notes)?;
        append(&mut joined, samples).ok_or_else(|| whole.out_of_memory())?;
    }
    Ok(joined)
}

/// Adds samples of the same type; `None` if there is no memory for them.
pub(super) fn append(all: &mut Stored, more: Stored) -> Option<()> {
    macro_rules! append {
        ($($variant:ident)*) => {
            match (all, more) {
                $((Stored::$variant(all), Stored::$variant(more)) => {
                    all.try_reserve(more.len()).ok()?;
                    all.extend(more);
                })*
                _ => return None,
            }
        };
    }
    append!(U8 I8 U16 I16 U32 I32 U64 I64 F32 F64);
    Some(())
}

/// Some samples of all, from `start`.
pub(super) fn slice(all: &Stored, start: usize, count: usize) -> Option<Stored> {
    macro_rules! slice {
        ($($variant:ident)*) => {
            match all { $(Stored::$variant(all) => Stored::$variant(all.get(start..start.checked_add(count)?)?.to_vec()),)* }
        };
    }
    Some(slice!(U8 I8 U16 I16 U32 I32 U64 I64 F32 F64))
}

/// The names that `slice%03d.raw 1 60 1` stands for, and what follows; `None` if it stands for itself.
pub(super) fn numbered(text: &str) -> Option<(Vec<String>, Option<&str>)> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let (&pattern, rest) = words.split_first()?;
    let (before, directive) = pattern.split_once('%')?;
    let (width, after) = directive.split_once('d')?;
    let zeros = width.starts_with('0');
    let width: usize = if width.is_empty() { 0 } else { width.parse().ok().filter(|width| *width <= 20)? };
    let [first, last, step]: [i64; 3] =
        rest.get(..3)?.iter().map(|word| word.parse().ok()).collect::<Option<Vec<i64>>>()?.try_into().ok()?;
    let count = last.checked_sub(first)?.checked_div(step)?;
    let count = usize::try_from(count).ok()?.checked_add(1)?;
    let name = |index: usize| {
        let number = first.saturating_add(step.saturating_mul(index as i64));
        if zeros {
            format!("{before}{number:0width$}{after}")
        } else {
            format!("{before}{number:width$}{after}")
        }
    };
    // One too many is refused by who asked.
    Some(((0..count.min(MAX_FILES)).map(name).collect(), rest.get(3).copied()))
}
