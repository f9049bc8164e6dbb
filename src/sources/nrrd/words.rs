//! What the words of an NRRD header stand for.

use std::path::Path;

use glam::DVec3;

use super::{Packing, SourceError, header::Field, unsupported};
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
        "bzip2" | "bz2" => {
            let mend = "pack it with gzip: `unu save -f nrrd -e gzip -i IN -o OUT`";
            return Err(unsupported(path, "its encoding, bzip2, is not read".to_owned(), mend));
        }
        _ => return Err(field.error(path, "expected raw, gzip, ascii or hex")),
    })
}

/// Factors from an anatomical world to right, anterior, superior.
pub(super) fn anatomical(space: &str) -> Option<DVec3> {
    match space.to_lowercase().as_str() {
        "ras" | "right-anterior-superior" | "rast" | "right-anterior-superior-time" => Some(DVec3::ONE),
        "las" | "left-anterior-superior" | "last" | "left-anterior-superior-time" => {
            Some(DVec3::new(-1.0, 1.0, 1.0))
        }
        "lps" | "left-posterior-superior" | "lpst" | "left-posterior-superior-time" => {
            Some(DVec3::new(-1.0, -1.0, 1.0))
        }
        _ => None,
    }
}

/// Vectors of up to three components, or `none`; `None` if anything else is there.
pub(super) fn vectors(text: &str) -> Option<Vec<Option<DVec3>>> {
    let mut vectors = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            vectors.push(None);
            rest = after.trim_start();
            continue;
        }
        let (vector, after) = rest.strip_prefix('(')?.split_once(')')?;
        let components: Vec<f64> = numbers(&vector.replace(',', " "))?;
        let component = |axis: usize| components.get(axis).copied().unwrap_or(0.0);
        if !(1..=3).contains(&components.len()) {
            return None;
        }
        vectors.push(Some(DVec3::new(component(0), component(1), component(2))));
        rest = after.trim_start();
    }
    Some(vectors)
}
