//! Drawing without a window, and without what is said of windows then.
//!
//! Mesa's Vulkan layer that chooses among devices (`VK_LAYER_MESA_device_select`) looks for a Wayland compositor whenever Vulkan's extension for
//! its surfaces is enabled, which `wgpu` does in any case. Without `XDG_RUNTIME_DIR` libwayland says so on standard error, each time.
//! Vulkan's loader leaves the layer out where `NODEVICE_SELECT` is set; but a program that runs cannot set variables of its environment safely, so it begins
//! again with it.

/// Begins the program again, as the same process, where libwayland would complain. To be called first, and not where a window is wanted.
#[cfg(all(unix, not(target_vendor = "apple")))]
pub(super) fn leave_out_window_system() {
    use std::env;
    use std::os::unix::process::CommandExt;
    use std::path::Path;

    let is_fine = env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).is_absolute());
    // Whoever tells the layer which device to take wants it, and it is not to be left out twice.
    let is_settled =
        ["NODEVICE_SELECT", "MESA_VK_DEVICE_SELECT"].iter().any(|name| env::var_os(name).is_some());
    if is_fine || is_settled {
        return;
    }
    let Ok(program) = env::current_exe() else { return };
    let mut arguments = env::args_os();
    let mut again = std::process::Command::new(program);
    if let Some(name) = arguments.next() {
        again.arg0(name);
    }
    // Returns only where that fails; then a complaint does no harm.
    let error = again.args(arguments).env("NODEVICE_SELECT", "1").exec();
    log::debug!("cannot begin again without the window system: {error}");
}

/// Elsewhere nothing is said.
#[cfg(not(all(unix, not(target_vendor = "apple"))))]
pub(super) fn leave_out_window_system() {}
