//! What the words of an NRRD header stand for.

use std::path::Path;

use glam::DVec3;

use super::{
    Packing, SourceError,
    axes::{Direction, WorldOf},
    header::Field,
};
use crate::sources::{stored::StoredFormat, text::numbers};

/// Type of a sample.
pub(super) fn sample_format(path: &Path, field: &Field) -> Result<StoredFormat, SourceError> {
    Ok(match field.value.to_lowercase().as_str() {
        "signed char" | "int8" | "int8_t" => StoredFormat::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => StoredFormat::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
            StoredFormat::I16
        }
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => StoredFormat::U16,
        "int" | "signed int" | "int32" | "int32_t" => StoredFormat::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => StoredFormat::U32,
        "longlong"
        | "long long"
        | "long long int"
        | "signed long long"
        | "signed long long int"
        | "int64"
        | "int64_t" => StoredFormat::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
            StoredFormat::U64
        }
        "float" => StoredFormat::F32,
        "double" => StoredFormat::F64,
        _ => return Err(field.error(path, "expected int8 to uint64, float or double")),
    })
}

/// How samples are packed.
pub(super) fn packing(path: &Path, field: &Field) -> Result<Packing, SourceError> {
    Ok(match field.value.to_lowercase().as_str() {
        "raw" => Packing::Plain,
        "gzip" | "gz" => Packing::Gzip,
        "txt" | "text" | "ascii" => Packing::Text,
        "hex" => Packing::Hex,
        "bzip2" | "bz2" => Packing::Bzip2,
        _ => return Err(field.error(path, "expected raw, gzip, bzip2, ascii or hex")),
    })
}

/// What the world of a file is.
pub(super) fn world_of(space: &str) -> WorldOf {
    let space = space.to_lowercase();
    let space = space.strip_suffix("-time").unwrap_or(&space);
    match space {
        "ras" | "rast" | "right-anterior-superior" => WorldOf::Patient(DVec3::ONE),
        "las" | "last" | "left-anterior-superior" => WorldOf::Patient(DVec3::new(-1.0, 1.0, 1.0)),
        "lps" | "lpst" | "left-posterior-superior" => WorldOf::Patient(DVec3::new(-1.0, -1.0, 1.0)),
        "3d-left-handed" => WorldOf::LeftHanded,
        _ => WorldOf::Other,
    }
}

/// Millimetres of a unit of length.
pub(in crate::sources) fn millimetres(unit: &str) -> Option<f64> {
    Some(match unit.to_lowercase().as_str() {
        "km" | "kilometer" | "kilometre" => 1e6,
        "m" | "meter" | "metre" | "meters" | "metres" => 1e3,
        "cm" | "centimeter" | "centimetre" => 10.0,
        "mm" | "millimeter" | "millimetre" | "millimeters" | "millimetres" => 1.0,
        "um" | "µm" | "μm" | "micron" | "microns" | "micrometer" | "micrometre" => 1e-3,
        "nm" | "nanometer" | "nanometre" => 1e-6,
        "å" | "angstrom" | "angstroms" => 1e-7,
        "pm" | "picometer" | "picometre" => 1e-9,
        "in" | "inch" | "inches" => 25.4,
        _ => return None,
    })
}

/// Vectors, or `none`; `None` if anything else is there. A vector of NaN stands for `none`, and so does one that is 0 in space and
/// has a component beyond it, of time.
pub(super) fn vectors(text: &str) -> Option<Vec<Direction>> {
    let mut vectors = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            vectors.push(Direction::None);
            rest = after.trim_start();
            continue;
        }
        let (vector, after) = rest.strip_prefix('(')?.split_once(')')?;
        let components: Vec<f64> = numbers(&vector.replace(',', " "))?;
        if !(1..=8).contains(&components.len()) {
            return None;
        }
        let component = |axis: usize| components.get(axis).copied().unwrap_or(0.0);
        let along = DVec3::new(component(0), component(1), component(2));
        let is_beyond = along == DVec3::ZERO && components.iter().skip(3).any(|component| *component != 0.0);
        let is_none = is_beyond || components.iter().all(|component| component.is_nan());
        vectors.push(if is_none { Direction::None } else { Direction::Along(along) });
        rest = after.trim_start();
    }
    Some(vectors)
}
