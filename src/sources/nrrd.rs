//! NRRD: a text header, then samples, in the same file or others (<https://teem.sourceforge.net/nrrd/format.html>).
//!
//! No crate of the registry was found that reads it and is under a licence allowed here; see [`super::self_describing`].

mod axes;
mod header;
mod segments;
mod words;

use std::{
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
};

use super::{
    Selection, SourceError,
    beside::beside,
    colour, file, pieces,
    shape::choose,
    stored::Scaling,
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    volume::{Endian, VolumeData},
};
use header::{DataFile, Header};
pub(super) use words::millimetres;

/// Lines that `line skip` may have, and bytes in them.
const MAX_SKIPPED_LINES: u64 = 1 << 20;
const MAX_SKIPPED_BYTES: u64 = 1 << 26;

/// Reads a volume of an attached (.nrrd) or detached (.nhdr) NRRD file.
///
/// # Errors
///
/// If a line of the header is wrong or missing, the file has no such volume or component, or the data are not there.
pub(super) fn read(path: &Path, selection: &Selection) -> Result<VolumeData, SourceError> {
    let mut notes = Vec::new();
    let header = Header::read(path)?;
    let (format, sides) = (header.format, axes::sides(&header.axes));
    let is_colour = axes::is_colour(&header.axes, &sides) && colour::can_be(format);
    let chosen = choose(path, &sides, selection, is_colour, &mut notes)?;
    let grid = axes::grid(path, &header, &sides, chosen.bytes(format), &mut notes)?;
    if format.bytes() > 1 && header.endian.is_none() && header.packing != Packing::Text {
        return Err(header.missing("endian", "`endian: little` or `endian: big`"));
    }
    let files: Vec<PathBuf> = match &header.data {
        DataFile::Attached => vec![path.to_owned()],
        DataFile::Files(names) => beside(path, names, &mut notes),
    };
    let stream = SampleStream {
        path,
        what: chosen.what(&grid, format),
        samples: grid.samples() * chosen.per_voxel(),
        pick: chosen.pick.clone(),
        format,
        endian: header.endian.unwrap_or_default(),
        packing: header.packing,
        offset: 0,
        skip: 0,
        surplus: Surplus::Note,
        mend: &mend_by_header,
        hint: "",
    };
    let attached_at = matches!(header.data, DataFile::Attached).then_some(header.data_offset);
    let in_each = chosen.all / files.len().max(1) as u64;
    let stored = pieces::read(&stream, chosen.all, &files, &mut notes, |stream| {
        stream.offset = attached_at.unwrap_or(0);
        place(stream, &header, in_each)
    })?;
    let mut volume = chosen.volume(&grid, path, stored, &Scaling::NONE, notes)?;
    volume.labels = header.segments.labels(selection.index);
    Ok(volume)
}

/// Sets where in its file of so many samples a stream begins.
fn place(stream: &mut SampleStream, header: &Header, samples: u64) -> Result<(), SourceError> {
    let (mut file, file_bytes) = file::open(stream.path)?;
    if header.line_skip > 0 {
        use std::io::{Read, Seek, SeekFrom};
        let io_error = |cause| file::io_error(stream.path, cause);
        file.seek(SeekFrom::Start(stream.offset)).map_err(io_error)?;
        let mut reader = BufReader::new(file).take(MAX_SKIPPED_BYTES);
        for _ in 0..header.line_skip.min(MAX_SKIPPED_LINES) {
            stream.offset += reader.skip_until(b'\n').map_err(io_error)? as u64;
        }
    }
    match u64::try_from(header.byte_skip) {
        // A packed file's bytes are skipped once they are out, others in the file.
        Ok(skip) if matches!(stream.packing, Packing::Plain | Packing::Text) => {
            stream.offset = stream.offset.saturating_add(skip);
        }
        Ok(skip) => stream.skip = skip,
        Err(_) => {
            let needed = samples.saturating_mul(stream.format.bytes());
            stream.offset = file_bytes.saturating_sub(needed).max(stream.offset);
        }
    }
    Ok(())
}

fn unsupported(path: &Path, found: String, mend: &str) -> SourceError {
    SourceError::Unsupported { path: path.to_owned(), found, mend: mend.to_owned() }
}

#[cfg(test)]
mod tests;
