//! What is still done when the program is ended from outside: by Ctrl+C, `kill`, or the end of a session.

/// From here on, files that are not whole are taken away, and edits that are not saved are kept, before a signal ends the program.
#[cfg(unix)]
pub(super) fn on_signals() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    let ignored = ignored();
    // What `nohup` and shells have background work ignore stays ignored.
    let ends = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored & 1 << (signal - 1) == 0);
    let Ok(mut signals) = Signals::new(ends) else { return log::debug!("signals end the program at once") };
    let started = std::thread::Builder::new().name("tyndall signals".into()).spawn(move || {
        for signal in signals.forever() {
            crate::window::keep_unsaved();
            let _nothing_more = crate::whole_file::abandon();
            // So that who waits for the program learns what ended it.
            let _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
    if let Err(error) = started {
        log::debug!("signals end the program at once: {error}");
    }
}

/// The same where there are no such signals.
#[cfg(not(unix))]
pub(super) fn on_signals() {}

/// The signals that whoever started the program has it ignore, a bit each from the lowest for signal 1; none where that is not told.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    line.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or_default()
}
