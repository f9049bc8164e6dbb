//! Why an edit cannot be made, or not be saved.

use crate::scene::problem::Problem;
use crate::scene::write::WriteError;
use std::io;
use std::path::PathBuf;

/// Why a scene stays as it is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// There is no scene to edit: it had errors when it was last read.
    #[error("there is no scene to edit; mend the errors in its file first")]
    NoScene,
    /// No entity has this name.
    #[error("the scene has no entity `{entity}`; it may have been removed or renamed in its file")]
    NoEntity {
        /// The name.
        entity: String,
    },
    /// The entity has no such value.
    #[error("`{entity}` has no `{path}`; paths are written Component.field.2[3]")]
    NoValue {
        /// The entity, or what the head is called.
        entity: String,
        /// The path.
        path: String,
    },
    /// No component of scenes has this type or name.
    #[error("`{name}` is no component of scenes; its type must be registered and reflect `Component`")]
    NoComponent {
        /// The name, or the type.
        name: String,
    },
    /// A component is there already.
    #[error("`{entity}` has a `{component}` already; set that one")]
    ComponentTaken {
        /// The entity.
        entity: String,
        /// The component.
        component: String,
    },
    /// A value of another type was given.
    #[error("`{path}` is a `{expected}`, not a `{found}`")]
    WrongType {
        /// The path.
        path: String,
        /// The type of what is there.
        expected: String,
        /// The type that was given.
        found: String,
    },
    /// A name is an identity.
    #[error("there is an entity `{name}` already; choose another name")]
    NameTaken {
        /// The name.
        name: String,
    },
    /// The scene would have errors.
    #[error("{}", .0.first().map_or("the scene would have errors".into(), |problem| problem.message.clone()))]
    Invalid(Vec<Problem>),
    /// The value cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A type has no way to copy its values.
    #[error("`{type_path}` cannot be copied; derive `Clone` and reflect it")]
    Uncopyable {
        /// The type.
        type_path: String,
    },
    /// What an undo or redo would change has been changed otherwise since.
    #[error("{} was changed by somebody else since, so this step is left out", subject(.entity.as_deref(), .path))]
    Overtaken {
        /// The entity; none for the head.
        entity: Option<String>,
        /// The path in it.
        path: String,
    },
    /// No conflict has this number.
    #[error("this conflict is resolved already")]
    NoConflict,
}

fn subject(entity: Option<&str>, path: &str) -> String {
    match (entity, path) {
        (Some(entity), "") => format!("`{entity}`"),
        (Some(entity), path) => format!("`{entity}.{path}`"),
        (None, path) => format!("`{path}`"),
    }
}

/// Why nothing, or not all, was saved. What was not stays an unsaved edit.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// Files have changed in the same places.
    #[error(
        "{count} edits are of what was changed in the files too; choose for each which is to stay, then save again"
    )]
    Conflicts {
        /// How many there are.
        count: usize,
    },
    /// What is on disk now cannot be read, so edits cannot be put into it.
    #[error(
        "the files have errors since somebody else changed them; mend them, then save again: {}",
        .0.first().map_or(String::new(), ToString::to_string)
    )]
    Broken(Vec<Problem>),
    /// A file could not be written.
    #[error("cannot write {}: {source}; {}", path.display(), help(source.kind()))]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The scene is in no file yet.
    #[error("the scene is in no file yet; choose one with *Save as*")]
    Untitled,
    /// A file changed each time that it was to be written.
    #[error("the files are being changed all the time by somebody else; save again when that is over")]
    Busy,
    /// The texts to be saved could not be made.
    #[error(transparent)]
    Edit(#[from] EditError),
}

fn help(kind: io::ErrorKind) -> &'static str {
    match kind {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "free some space and save again",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "make the file and its folder writable and save again"
        }
        io::ErrorKind::AlreadyExists => "choose another name",
        _ => "the edits are kept; save again when that is mended",
    }
}
