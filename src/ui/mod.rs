//! What stands around the picture in the window: panels on `&mut World`, with no window and no GPU, so that tests click on them.
//!
//! [`panels`] lays everything out. What concerns the selected entity stands in [`Sections`], to which plugins add their own. What the panels
//! cannot do themselves, such as moving the camera, they hand back as [`Command`]s. [`inspect`], [`TransferFunctionEditor`] and
//! [`light_direction`] are widgets on plain data, for any program with egui: they say what a person changed.

mod axes;
mod colour;
mod command;
mod conflicts;
pub(crate) mod edit;
mod edited;
mod entities;
mod icons;
mod inspect;
mod inspector;
mod leaving;
mod light_direction;
mod log;
mod number;
mod opening;
mod panels;
mod picture;
mod problems;
mod recovered;
mod report;
mod rows;
mod sections;
mod shading;
mod shortcuts;
mod state;
mod status;
mod toolbar;
mod transfer_function;

pub use command::{Axis, Command, PictureFile};
pub use edited::{EditError, Edited};
pub use inspect::SceneFolder;
pub use inspector::{InspectorContext, inspect};
pub(crate) use leaving::Leaving;
pub use light_direction::{LightDirection, light_direction};
pub use log::{Level, Line, Log};
pub(crate) use opening::Chooser;
pub use opening::Recent;
pub use panels::{Laid, panels};
pub use problems::SceneProblems;
pub use recovered::Recovered;
pub use sections::{Section, Sections};
pub use state::{LastReload, OpenPanels, Selection, Shown, Totals, init};
pub use transfer_function::{
    Preset, TransferFunctionData, TransferFunctionEditor, TransferFunctionFileError, read_transfer_function,
    write_transfer_function,
};
