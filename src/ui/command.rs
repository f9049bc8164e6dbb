//! What panels ask for and cannot do themselves.

use bevy_ecs::prelude::Entity;
use glam::DVec2;
use std::path::PathBuf;

/// Something that a person asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// To turn the scene, by heights of the picture, y down.
    Orbit(DVec2),
    /// To move the scene across the view, likewise.
    Pan(DVec2),
    /// To show everything `1 / factor` times as large, around a place of the picture.
    Zoom {
        /// Factor on the distance from which the target is seen.
        factor: f64,
        /// From the middle of the picture, in half heights, y up.
        cursor: DVec2,
    },
    /// To bring an entity into the picture, or everything.
    Frame(Option<Entity>),
    /// To turn perspective into an orthographic view, or back.
    ToggleProjection,
    /// To look along an axis of the scene.
    LookAlong(Axis),
    /// To go back to the scene's own camera.
    ResetCamera,
    /// To write the picture into a file.
    Screenshot(PictureFile),
    /// To take the last edit back.
    Undo,
    /// To take the last undo back.
    Redo,
    /// To write edits to the files that they are of.
    Save,
    /// To write the scene into another file, and to follow that; one that is there already is replaced when it is asked for twice.
    SaveAs(PathBuf),
    /// To be asked for the file that the scene is to be written into.
    AskSaveAs,
    /// To show other files, or to be asked first where edits are not saved: a scene, or meshes, volumes and scenes together.
    Open(Vec<PathBuf>),
    /// To be asked for a file to open.
    AskOpen,
    /// To save and show other files, if all could be saved.
    SaveAndOpen(Vec<PathBuf>),
    /// To show other files, whatever is not saved.
    DiscardAndOpen(Vec<PathBuf>),
    /// To give the graphics device up and open another.
    ReopenDevice,
    /// To close the window, or to be asked first where edits are not saved.
    Quit,
    /// To save and close the window, if all could be saved.
    SaveAndQuit,
    /// To close the window, whatever is not saved.
    Discard,
    /// To take back edits that an earlier run could not save.
    Recover,
    /// To delete them.
    ForgetRecovered,
}

impl Command {
    /// Whether it is about what was changed in the scene, or may be lost.
    pub(crate) fn concerns_edits(&self) -> bool {
        matches!(self, Self::Undo | Self::Redo | Self::Recover | Self::ForgetRecovered)
            || self.concerns_files()
    }

    /// Whether it is about the files of the scene, or about leaving them.
    pub(crate) fn concerns_files(&self) -> bool {
        use Command::{
            AskOpen, AskSaveAs, Discard, DiscardAndOpen, Open, Quit, Save, SaveAndOpen, SaveAndQuit, SaveAs,
        };
        matches!(self, Save | SaveAs(_) | AskSaveAs | Open(_) | AskOpen | SaveAndOpen(_) | DiscardAndOpen(_))
            || matches!(self, Quit | SaveAndQuit | Discard)
    }
}

/// The side of the scene from which one looks along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// From +x.
    Right,
    /// From -x.
    Left,
    /// From +y.
    Above,
    /// From -y.
    Below,
    /// From +z.
    Front,
    /// From -z.
    Back,
}

impl Axis {
    /// All of them, with what a person calls them and the keys that stand for them.
    pub(super) const ALL: [(Self, &'static str, egui::Key); 6] = [
        (Self::Front, "Front (+z)", egui::Key::Num1),
        (Self::Back, "Back (-z)", egui::Key::Num2),
        (Self::Right, "Right (+x)", egui::Key::Num3),
        (Self::Left, "Left (-x)", egui::Key::Num4),
        (Self::Above, "Above (+y)", egui::Key::Num5),
        (Self::Below, "Below (-y)", egui::Key::Num6),
    ];
}

/// A kind of file that pictures are written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFile {
    /// As it is shown.
    Png,
    /// Linear radiance.
    Exr,
}
