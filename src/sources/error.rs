//! Why a file could not be read: who, what was expected, what was found, how to mend it.

use std::{
    fmt, io,
    path::{Path, PathBuf},
};

use glam::Vec3;

/// Why a file gave no mesh or volume.
///
/// The text is complete in itself: causes are part of it rather than chained.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The path leads nowhere.
    #[error("{path}: no such file{}{}", .searched, mend_not_found(.near.as_deref(), .searched))]
    NotFound {
        /// The path asked for.
        path: PathBuf,
        /// Where it was looked for, if the path alone does not say that.
        searched: Searched,
        /// The file of that folder with the nearest name, if one is near.
        near: Option<String>,
    },
    /// The operating system refused to open or read it.
    #[error("{path}: cannot be read: {cause}; check its permissions and the disk it is on")]
    Io {
        /// The path asked for.
        path: PathBuf,
        /// What the operating system says.
        cause: io::Error,
    },
    /// A folder, a pipe or a device.
    #[error("{path}: expected a file, found {found}; name a file")]
    NotAFile {
        /// The path asked for.
        path: PathBuf,
        /// "a folder", "a pipe".
        found: &'static str,
    },
    /// More than a reader accepts.
    #[error("{path}: {bytes} bytes; at most {limit} are read; {mend}")]
    TooLarge {
        /// The path asked for.
        path: PathBuf,
        /// The file's length.
        bytes: u64,
        /// The reader's limit, in bytes.
        limit: u64,
        /// What to do about it.
        mend: &'static str,
    },
    /// The machine has no room for what the file holds.
    #[error("{path}: no memory for its {bytes} bytes; close other programs, or use a smaller version of it")]
    OutOfMemory {
        /// The path asked for.
        path: PathBuf,
        /// The bytes asked of the allocator.
        bytes: u64,
    },
    /// Not the text this reader reads.
    #[error("{path}: expected {expected}, found {found}; {mend}")]
    Encoding {
        /// The path asked for.
        path: PathBuf,
        /// What the reader reads.
        expected: &'static str,
        /// What the file begins with.
        found: &'static str,
        /// What to do about it.
        mend: &'static str,
    },
    /// A line of a text file that cannot be understood.
    #[error("{path}:{line}: {problem}")]
    Line {
        /// The path asked for.
        path: PathBuf,
        /// The line, counted from 1; of a continued line, its first.
        line: u64,
        /// What was expected, what was found, how to mend it.
        problem: String,
    },
    /// A field of a header that cannot be understood.
    #[error("{path}: {field}: {problem}")]
    Field {
        /// The path asked for.
        path: PathBuf,
        /// The field, by the name its format gives it.
        field: String,
        /// What was expected, what was found, how to mend it.
        problem: String,
    },
    /// A file that is whole, but not of a kind that is read.
    #[error("{path}: {found}; {mend}")]
    Unsupported {
        /// The path asked for.
        path: PathBuf,
        /// What it is or has that is not read.
        found: String,
        /// What to do about it.
        mend: String,
    },
    /// An entry or a component that a file does not have.
    #[error("{path}: {what} is {asked}, but {}", mend_no_such_part(.what, *.count))]
    NoSuchPart {
        /// The path asked for.
        path: PathBuf,
        /// The field that asks for it: `index` or `component`.
        what: &'static str,
        /// Which one is asked for, counted from 0.
        asked: u64,
        /// How many there are.
        count: u64,
    },
    /// A mesh file without a surface.
    #[error("{path}: no triangles: found {found}; export the mesh with its faces")]
    NoTriangles {
        /// The path asked for.
        path: PathBuf,
        /// What it has instead.
        found: String,
    },
    /// A mesh of more vertices or triangles than 32-bit indices reach.
    #[error("{path}: more triangles than 32-bit indices reach ({limit}); split or decimate the mesh")]
    TooManyTriangles {
        /// The path asked for.
        path: PathBuf,
        /// How many are allowed.
        limit: u64,
    },
    /// A volume whose file is not as long as its layout says.
    #[error("{path}: {found}; {expected} ({difference}: {mend})")]
    Length {
        /// The path asked for.
        path: PathBuf,
        /// How long it is: `262143 bytes`.
        found: String,
        /// How long it should be: `64 x 64 x 64 U8 voxels need 262144`.
        expected: String,
        /// `1 fewer than expected`.
        difference: String,
        /// What to do about it.
        mend: String,
    },
    /// A packed file that cannot be unpacked.
    #[error("{path}: {problem} after {unpacked} unpacked bytes; {mend}")]
    Packed {
        /// The path asked for.
        path: PathBuf,
        /// How many bytes came out before.
        unpacked: u64,
        /// What is wrong with it.
        problem: String,
        /// What to do about it.
        mend: &'static str,
    },
    /// A volume layout that no file can have.
    #[error("{path}: {problem}")]
    Layout {
        /// The path asked for.
        path: PathBuf,
        /// What is wrong with the layout.
        problem: LayoutError,
    },
}

/// Why a volume cannot have this shape.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// A side without voxels.
    #[error("size {} x {} x {}: every side needs at least 1 voxel", .size[0], .size[1], .size[2])]
    EmptySide {
        /// Voxels along x, y, z.
        size: [u32; 3],
    },
    /// Voxels without an extent.
    #[error("spacing {} x {} x {} mm: every component must be finite and greater than 0; use 1 where it is unknown", .spacing.x, .spacing.y, .spacing.z)]
    Spacing {
        /// Distance of voxel centres along x, y, z, in mm.
        spacing: Vec3,
    },
    /// More than a volume may have.
    #[error("{} x {} x {} voxels of {bytes_per_voxel} bytes exceed the limit of {limit} bytes; is the size right? otherwise crop or downsample the volume", .size[0], .size[1], .size[2])]
    TooLarge {
        /// Voxels along x, y, z.
        size: [u32; 3],
        /// Bytes of one voxel.
        bytes_per_voxel: u64,
        /// The limit, in bytes.
        limit: u64,
    },
    /// A header longer than any volume.
    #[error(
        "skip_bytes {skip_bytes} exceeds the limit of {limit} bytes; it counts the bytes in front of the first voxel"
    )]
    Skip {
        /// Bytes in front of the first voxel.
        skip_bytes: u64,
        /// The limit, in bytes.
        limit: u64,
    },
    /// Samples that do not fill the size.
    #[error("{samples} samples; {} x {} x {} voxels need {}", .size[0], .size[1], .size[2], .size.iter().map(|&n| u128::from(n)).product::<u128>())]
    SampleCount {
        /// Voxels along x, y, z.
        size: [u32; 3],
        /// How many samples there are.
        samples: usize,
    },
}

/// Where a file was looked for that is not there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Searched {
    /// Where its path, which begins at the root, says.
    Absolute,
    /// In this folder.
    In(PathBuf),
    /// In a folder that is not there either: the first of those on the way that is missing.
    NoFolder(PathBuf),
}

impl Searched {
    /// Where a path leads, seen from the folder that the program runs in.
    pub(crate) fn of(path: &Path) -> Self {
        let Ok(absolute) = std::path::absolute(path) else { return Self::Absolute };
        let missing = absolute.ancestors().skip(1).take_while(|folder| !folder.exists()).last();
        match (missing, absolute.parent()) {
            (Some(missing), _) => Self::NoFolder(missing.to_owned()),
            (None, Some(folder)) if path.is_relative() => Self::In(folder.to_owned()),
            _ => Self::Absolute,
        }
    }
}

impl fmt::Display for Searched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absolute => Ok(()),
            Self::In(folder) => write!(f, " in {}", folder.display()),
            Self::NoFolder(missing) => write!(f, ": there is no folder {}", missing.display()),
        }
    }
}

fn mend_not_found(near: Option<&str>, searched: &Searched) -> String {
    match (near, searched) {
        (Some(name), _) => format!("; did you mean `{name}`?"),
        (None, Searched::NoFolder(_)) => "; check the path".to_owned(),
        (None, _) => "; check the path and the folder it is relative to".to_owned(),
    }
}

fn mend_no_such_part(what: &str, count: u64) -> String {
    let last = count.saturating_sub(1);
    match (what, count) {
        (_, 0) => "the file holds none".to_owned(),
        ("component", 1) => "each voxel has a single number, 0".to_owned(),
        ("component", _) => format!("the {count} numbers of a voxel are 0 to {last}"),
        (_, 1) => "it holds a single volume, 0".to_owned(),
        _ => format!("its {count} volumes are 0 to {last}"),
    }
}
