//! What stands around the picture in the window: panels on `&mut World`, with no window and no GPU, so that tests click on them.
//!
//! [`panels`] lays everything out. What concerns the selected entity stands in [`Sections`], to which plugins add their own. What the panels
//! cannot do themselves, such as moving the camera, they hand back as [`Command`]s.

mod axes;
mod command;
mod entities;
mod log;
mod panels;
mod picture;
mod problems;
mod report;
mod sections;
mod shading;
mod shortcuts;
mod state;
mod status;
mod toolbar;

pub use command::{Axis, Command, PictureFile};
pub use log::{Level, Line, Log};
pub use panels::{Laid, panels};
pub use problems::SceneProblems;
pub use sections::{Section, Sections};
pub use state::{OpenPanels, Selection, Shown, Totals, init};
