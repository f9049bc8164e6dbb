//! A progress bar for what takes longer than a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::Duration;

/// A bar over `frames`, or a spinner for one; nothing appears within the first second.
pub(super) fn bar(frames: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target((frames > 1).then_some(frames), ProgressDrawTarget::hidden());
    let template = if frames > 1 {
        "{elapsed} {wide_bar} {pos}/{len} frames, {eta} left"
    } else {
        "{spinner} {elapsed} {msg}"
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message("drawing");
    let shown = bar.downgrade();
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_secs(1));
        if let Some(bar) = shown.upgrade().filter(|bar| !bar.is_finished()) {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.enable_steady_tick(Duration::from_millis(200));
        }
    });
    bar
}
