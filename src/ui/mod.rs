//! Panels: widgets on plain data that know neither window nor GPU, and say what a person changed.

mod colour;
mod edited;
mod icons;
mod inspector;
mod light_direction;
mod number;
mod rows;
mod transfer_function;

pub use edited::{EditError, Edited};
pub use inspector::{InspectorContext, inspect};
pub use light_direction::{LightDirection, light_direction};
pub use transfer_function::{
    Preset, TransferFunctionData, TransferFunctionEditor, TransferFunctionFileError, read_transfer_function,
    write_transfer_function,
};
