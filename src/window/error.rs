use crate::gpu::GpuError;

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WindowError {
    /// There is no display, or it cannot be reached.
    #[error(
        "no window can be opened: {0}. `tyndall view` needs a display: an X server that DISPLAY names or a Wayland compositor that WAYLAND_DISPLAY names; \
         without one, `tyndall render SCENE` draws into a file, and `xvfb-run tyndall view SCENE` into a screen that is only in memory"
    )]
    NoDisplay(String),
    /// The system has a display, and gives no window on it.
    #[error("the display gives no window: {0}; ask for a smaller `--size`, or see what its server logs")]
    NoWindow(String),
    /// The GPU failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
}
