//! NRRD: a text header, then samples, in the same file or others (<https://teem.sourceforge.net/nrrd/format.html>).
//!
//! No crate of the registry was found that reads it and is under a licence allowed here; see [`super::self_describing`].

mod header;
mod words;

use std::{
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
};

use glam::DVec3;

use super::{
    Selection, SourceError, file,
    grid::Grid,
    pieces,
    stored::Scaling,
    stream::{Packing, SampleStream, Surplus, mend_by_header},
    volume::{Endian, VolumeData},
};
use header::{Axis, DataFile, Header};

/// Lines that `line skip` may have, and bytes in them.
const MAX_SKIPPED_LINES: u64 = 1 << 20;
const MAX_SKIPPED_BYTES: u64 = 1 << 26;

/// Reads an attached (.nrrd) or detached (.nhdr) NRRD file of up to three axes that count.
///
/// # Errors
///
/// If a line of the header is wrong or missing, its encoding is bzip2, more than one number stands at a place, or the data are
/// not there.
pub(super) fn read(path: &Path, _selection: &Selection) -> Result<VolumeData, SourceError> {
    let mut notes = Vec::new();
    let header = Header::read(path)?;
    let (axes, is_part) = spatial(path, header.axes.clone(), &mut notes)?;
    let size: Vec<u64> = axes.iter().map(|axis| axis.size).collect();
    let (directions, anatomical) = directions(&axes, &header);
    let bytes = header.format.bytes();
    let grid = Grid::new(path, &size, &directions, anatomical, bytes)?;
    if bytes > 1 && header.endian.is_none() && header.packing != Packing::Text {
        return Err(header.missing("endian", "`endian: little` or `endian: big`"));
    }
    let files: Vec<PathBuf> = match &header.data {
        DataFile::Attached => vec![path.to_owned()],
        DataFile::Files(files) => files.clone(),
    };
    if is_part && files.len() > 1 {
        let found = "its data files hold more than one volume".to_owned();
        return Err(unsupported(path, found, "list those of one volume only"));
    }
    let stream = SampleStream {
        path,
        what: grid.what(bytes),
        samples: grid.samples(),
        format: header.format,
        endian: header.endian.unwrap_or_default(),
        packing: header.packing,
        offset: 0,
        skip: 0,
        surplus: if is_part { Surplus::Ignore } else { Surplus::Note },
        mend: &mend_by_header,
        hint: "",
    };
    let attached_at = matches!(header.data, DataFile::Attached).then_some(header.data_offset);
    let stored = pieces::read(&stream, &files, &mut notes, |stream| {
        stream.offset = attached_at.unwrap_or(0);
        place(stream, &header)
    })?;
    grid.volume(path, stored, &Scaling::NONE, notes)
}

/// Sets where in its file a stream begins.
fn place(stream: &mut SampleStream, header: &Header) -> Result<(), SourceError> {
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
        // A packed file's bytes are skipped once they are out, a plain one's in the file, where its length is known.
        Ok(skip) if stream.packing == Packing::Plain => stream.offset = stream.offset.saturating_add(skip),
        Ok(skip) => stream.skip = skip,
        Err(_) => {
            let needed = stream.samples * stream.format.bytes();
            stream.offset = file_bytes.saturating_sub(needed).max(stream.offset);
        }
    }
    Ok(())
}

/// The axes that are space, and whether the samples are only the first of several such volumes.
fn spatial(path: &Path, axes: Vec<Axis>, notes: &mut Vec<String>) -> Result<(Vec<Axis>, bool), SourceError> {
    let several = |axis: &Axis| axis.size != 1;
    let mut axes: Vec<Axis> = axes.into_iter().filter(|axis| axis.is_space || several(axis)).collect();
    while axes.len() > 3 && axes.iter().any(|axis| axis.size == 1) {
        axes.retain({
            let mut left = axes.len() - 3;
            move |axis| {
                let drop = left > 0 && axis.size == 1;
                left -= usize::from(drop);
                !drop
            }
        });
    }
    let mut is_part = false;
    while let Some(last) = axes.last().filter(|axis| axes.len() > 3 || !axis.is_space) {
        if axes.len() == 1 {
            break;
        }
        notes.push(format!(
            "only the first of the {} entries of axis {} ({}) is read",
            last.size, last.number, last.kind
        ));
        is_part = true;
        axes.pop();
    }
    match axes.iter().find(|axis| !axis.is_space && axes.len() > 1) {
        Some(axis) => {
            let found = format!("{} numbers at each place (axis {}, {})", axis.size, axis.number, axis.kind);
            let mend = format!("choose one: `unu slice -a {} -p 0 -i IN -o OUT`", axis.number - 1);
            Err(unsupported(path, found, &mend))
        }
        None => Ok((axes, is_part)),
    }
}

/// How far and where each axis goes, and whether that is right, anterior, superior.
fn directions(axes: &[Axis], header: &Header) -> (Vec<DVec3>, bool) {
    if axes.iter().all(|axis| axis.direction.is_some()) {
        let directions = axes.iter().filter_map(|axis| axis.direction);
        let to_ras = header.space.unwrap_or(DVec3::ONE);
        return (directions.map(|axis| axis * to_ras * header.millimetres).collect(), header.space.is_some());
    }
    let units = [DVec3::X, DVec3::Y, DVec3::Z];
    let spacing = |(axis, unit): (&Axis, DVec3)| unit * axis.spacing.unwrap_or(1.0) * header.millimetres;
    (axes.iter().zip(units).map(spacing).collect(), false)
}

fn unsupported(path: &Path, found: String, mend: &str) -> SourceError {
    SourceError::Unsupported { path: path.to_owned(), found, mend: mend.to_owned() }
}

#[cfg(test)]
mod tests;
