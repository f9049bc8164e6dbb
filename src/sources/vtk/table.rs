//! Tables of colours as labels.

use std::path::Path;

use super::{Array, SourceError, StoredFormat, VolumeData, dataset::Dataset, run, stream_in};
use crate::sources::volume::{Label, Labels, Samples};

/// More colours than this make a scale, not labels.
const MAX_LABELS: u64 = 4096;

/// The labels of an array of whole numbers that count the colours of a table of the file; `None` if it names no table, or is none
/// of such numbers.
pub(super) fn labels(
    path: &Path,
    dataset: &Dataset,
    array: &Array,
    volume: &VolumeData,
    is_text: bool,
) -> Result<Option<Labels>, SourceError> {
    let named = |name: &String| dataset.tables.iter().find(|table| table.name == *name);
    let Some(table) = array.table.as_ref().and_then(named).filter(|table| table.colours <= MAX_LABELS) else {
        return Ok(None);
    };
    let is_whole = !matches!(volume.samples, Samples::F32(_) | Samples::Rgba8(_));
    if !is_whole || volume.range.0 < 0.0 || f64::from(volume.range.1) >= table.colours as f64 {
        return Ok(None);
    }
    let format = if is_text { StoredFormat::F32 } else { StoredFormat::U8 };
    let numbers = stream_in(&run(path, format, table.offset, table.colours * 4, is_text), &mut Vec::new())?;
    let whole = if is_text { 1.0 } else { 255.0 };
    let colour =
        |label: usize| [0, 1, 2, 3].map(|channel| (numbers.value(4 * label + channel) / whole) as f32);
    let label =
        |value: usize| Label { value: value as f32, name: String::new(), colour: Some(colour(value)) };
    Ok(Some(Labels { entries: (0..numbers.len() / 4).map(label).collect() }))
}
