//! Transfer functions in files of their own.

use crate::components::{Auto, Classification, LabelColour, TransferFunction};
use crate::scene::{Problem, read_component};
use crate::whole_file::Staged;
use bevy_reflect::TypeRegistry;
use glam::Vec3;
use std::any::TypeId;
use std::fmt::Write as _;

use std::path::{Path, PathBuf};

/// Why a transfer function could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TransferFunctionFileError {
    /// The file is no transfer function, or cannot be read.
    #[error("{}", listed(.problems))]
    Read {
        /// Everything that is wrong with it, with places.
        problems: Vec<Problem>,
    },
    /// The file cannot be written; what was there before still is.
    #[error("cannot write {}: {source}; check the folder and its permissions", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

fn listed(problems: &[Problem]) -> String {
    let lines = problems.iter().map(|problem| match &problem.help {
        Some(help) => format!("{problem}; {help}"),
        None => problem.to_string(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Reads a transfer function from a file that holds nothing else.
///
/// # Errors
///
/// Everything that is wrong with the file, with places.
pub fn read_transfer_function(
    path: &Path,
    registry: &TypeRegistry,
) -> Result<TransferFunction, TransferFunctionFileError> {
    let fail = |problems| TransferFunctionFileError::Read { problems };
    let value = read_component(path, TypeId::of::<TransferFunction>(), registry).map_err(fail)?;
    value
        .take()
        .map_err(|_| fail(vec![Problem::error(format!("{} is no transfer function", path.display()))]))
}

/// Writes a transfer function into a file, which is there with all of it or as it was before.
///
/// # Errors
///
/// If the file cannot be written.
pub fn write_transfer_function(
    path: &Path,
    function: &TransferFunction,
) -> Result<(), TransferFunctionFileError> {
    let fail = |source| TransferFunctionFileError::Write { path: path.to_owned(), source };
    let staged = Staged::write(path, in_ron(function).as_bytes()).and_then(Staged::synced);
    staged.and_then(Staged::commit).map_err(fail)
}

/// A transfer function as a person would write it: a line for each point, and nothing that is a default.
pub(super) fn in_ron(function: &TransferFunction) -> String {
    let mut text = String::from("(\n");
    // Writing into a String does not fail.
    let mut field = |name: &str, value: &str| {
        let _ = writeln!(text, "    {name}: {value},");
    };
    if let Auto::Value(domain) = function.domain {
        field("domain", &format!("({:?}, {:?})", domain.x, domain.y));
    }
    let points =
        function.points.iter().map(|point| format!("({:?}, {}, {:?})", point.0, rgb(point.1), point.2));
    let iso = function.iso.iter().map(|iso| {
        let (value, width, absorption) = (iso.value, iso.width, iso.absorption);
        format!("(value: {value:?}, width: {width:?}, color: {}, absorption: {absorption:?})", rgb(iso.color))
    });
    let labels = function.labels.iter().map(|label| {
        let LabelColour { value, color, opacity, name } = label;
        format!("(value: {value}, color: {}, opacity: {opacity:?}, name: {name:?})", rgb(*color))
    });
    let lists =
        [("points", points.collect::<Vec<_>>()), ("iso", iso.collect()), ("labels", labels.collect())];
    for (name, lines) in lists {
        if !lines.is_empty() {
            field(name, &format!("[\n        {},\n    ]", lines.join(",\n        ")));
        }
    }
    let default = TransferFunction::default();
    if function.entries != default.entries {
        field("entries", &function.entries.to_string());
    }
    if function.classification != Classification::Post {
        field("classification", &format!("{:?}", function.classification));
    }
    if let Auto::Value(length) = function.opacity_length {
        field("opacity_length", &format!("{length:?}"));
    }
    text.push_str(")\n");
    text
}

fn rgb(colour: Vec3) -> String {
    format!("({:?}, {:?}, {:?})", colour.x, colour.y, colour.z)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may panic")]
mod tests {
    use super::*;
    use crate::components::{ControlPoint, IsoValue};
    use glam::Vec2;

    fn registry() -> TypeRegistry {
        let mut registry = TypeRegistry::new();
        registry.register::<TransferFunction>();
        registry
    }

    #[test]
    fn what_is_written_reads_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("function.ron");
        let numbers = [0.1, 1e-7, 3.0e8, 0.333_333_34, 1.0];
        let points = numbers.iter().map(|n: &f32| ControlPoint(n.min(1.0), Vec3::splat(*n), n.min(0.5)));
        let mut points: Vec<_> = points.collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let iso = vec![IsoValue { value: -12.5, width: 0.0, ..Default::default() }];
        let whole = TransferFunction {
            preset: None,
            domain: Auto::Value(Vec2::new(-1e6, 1e-3)),
            points,
            iso,
            labels: Vec::new(),
            entries: 256,
            classification: Classification::PreIntegrated,
            opacity_length: Auto::Value(0.25),
        };
        let label = |value, name: &str| LabelColour {
            value,
            color: Vec3::new(0.1, 1e-7, 2.0),
            opacity: 0.25,
            name: name.into(),
        };
        let labels = vec![label(-7, ""), label(65_535, "a \"name\"\nof two \\ lines, ü")];
        let labelled = TransferFunction { labels, ..Default::default() };
        for function in [TransferFunction::default(), whole, labelled] {
            write_transfer_function(&path, &function).unwrap();
            assert_eq!(read_transfer_function(&path, &registry()).unwrap(), function);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("function.ron");
        std::fs::write(&path, "(\n    points: [(0.0, (0.0, 0.0, 0.0), 2.0)],\n    entrys: 3,\n)").unwrap();
        let error = read_transfer_function(&path, &registry()).unwrap_err().to_string();
        assert!(error.contains("function.ron:2:") && error.contains("function.ron:3:"), "{error}");
        let missing = read_transfer_function(&folder.path().join("none.ron"), &registry()).unwrap_err();
        assert!(missing.to_string().contains("there is no file"), "{missing}");
        let nowhere = folder.path().join("no folder/function.ron");
        let error = write_transfer_function(&nowhere, &TransferFunction::default()).unwrap_err().to_string();
        assert!(error.contains("no folder") && error.contains("check the folder"), "{error}");
    }

    #[test]
    fn the_presets_that_are_shipped_can_be_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/transfer_functions");
        let mut read = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            read_transfer_function(&entry.unwrap().path(), &registry()).unwrap();
            read += 1;
        }
        assert!(read >= 4);
    }
}
