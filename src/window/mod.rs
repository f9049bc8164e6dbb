//! A scene in a window: drawn when something changes, and not otherwise.
//!
//! ```text
//!  events ──▶ Session::frame ──▶ panels ──▶ what is asked for ──▶ camera, quality ──▶ App::update, if anything changed ──▶ Painter
//!    ▲                                                                                                                      │
//!    └────────── wait: for an event, a file, the end of a movement, the next set of samples, or nothing ◀──────────────────┘
//! ```
//!
//! A [`Session`] is all of this but the window: it takes the input of a frame and says when it wants the next, so that tests and benchmarks
//! drive the very code that [`run`] drives from a real window. [`Painter`] puts panels and picture on a texture, on the device that draws the
//! scene, so that no pixel leaves the GPU.

mod edits;
mod error;
mod event_loop;
mod files;
mod memory;
pub mod orbit;
mod pace;
mod painter;
mod recovery;
mod screenshot;
mod session;
mod stale;
mod surface;

pub use error::WindowError;
pub use event_loop::{WindowOptions, run};
pub use pace::Pace;
pub use painter::Painter;
pub(crate) use recovery::keep_unsaved;
pub use session::{Frame, Session, SessionOptions};
