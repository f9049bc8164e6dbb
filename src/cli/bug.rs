//! What is said when the program itself is at fault.

use super::terminal;
use crate::plain;
use std::any::Any;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::cell::RefCell;
use std::ffi::OsString;
use std::fmt::Write;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::process::ExitCode;
use std::thread::{self, ThreadId};

/// What Rust's own programs end with.
const BUG: u8 = 101;

/// A panic, as it can be told.
struct Told {
    message: String,
    place: String,
    /// Where one is asked for.
    trace: Option<String>,
}

thread_local! {
    /// The last panic of a thread. Whether it is a bug is known when nobody has caught it.
    static LAST: RefCell<Option<Told>> = const { RefCell::new(None) };
}

/// Runs the program. A panic that nobody catches is told as what it is, with what it takes to find its cause.
pub(super) fn guarded(words: &[OsString], run: impl FnOnce() -> ExitCode) -> ExitCode {
    let own = thread::current().id();
    panic::set_hook(Box::new(move |panic| remember(own, panic)));
    panic::catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|payload| {
        let last = LAST.take().filter(|last| last.message == message_of(payload.as_ref()));
        let last = last.unwrap_or_else(|| Told {
            message: message_of(payload.as_ref()),
            place: "another thread".into(),
            trace: None,
        });
        terminal::tell(report(&last, words));
        ExitCode::from(BUG)
    })
}

/// Keeps what a panic says. Those of other threads are told at once: their work is missing from here on.
fn remember(own: ThreadId, panic: &PanicHookInfo) {
    let trace = Backtrace::capture();
    let told = Told {
        message: message_of(panic.payload()),
        place: panic.location().map_or_else(String::new, |place| {
            format!("{}:{}:{}", source(place.file()), place.line(), place.column())
        }),
        trace: (trace.status() == BacktraceStatus::Captured).then(|| trace.to_string()),
    };
    if thread::current().id() != own {
        log::error!("a part of the program failed ({}): {}", told.place, told.message);
    } else if LAST.try_with(|last| last.try_borrow_mut().map(|mut last| *last = Some(told)).is_ok()).is_err()
    {
        log::error!("the program failed while it ended");
    }
}

fn message_of(payload: &(dyn Any + Send)) -> String {
    let text =
        payload.downcast_ref::<String>().map(String::as_str).or(payload.downcast_ref::<&str>().copied());
    text.unwrap_or("no message").to_owned()
}

/// A source file without where this machine, or the one that the program was built on, keeps it.
fn source(file: &str) -> String {
    let file = file.replace('\\', "/");
    // A registry has a folder for each index; the compiler's own files one for each version.
    let within = |folder: &str| file.split_once(folder).and_then(|(_, rest)| rest.split_once('/'));
    match within("/registry/src/").or_else(|| within("/rustc/")).or_else(|| within("/git/checkouts/")) {
        Some((_, rest)) => rest.to_owned(),
        None => file
            .rsplit_once("/src/")
            .filter(|_| file.starts_with('/'))
            .map_or(file.clone(), |(_, rest)| format!("src/{rest}")),
    }
}

/// What is to be sent.
fn report(told: &Told, words: &[OsString]) -> String {
    let words = words.iter().skip(1).map(|word| word.to_string_lossy());
    let words: Vec<String> =
        words.map(|word| if word.contains(' ') { format!("'{word}'") } else { word.into_owned() }).collect();
    let mut text = String::new();
    // Writing to a String does not fail.
    let _ = writeln!(
        text,
        "error: this is a bug in Tyndall. Please report it with these lines and, if you may, the scene:"
    );
    let _ = writeln!(text, "  message  {}", plain::message(&told.message).replace('\n', "\n           "));
    let _ = writeln!(text, "  place    {}", told.place);
    let _ = writeln!(
        text,
        "  version  {} on {} {}",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    let _ = write!(text, "  command  {}", plain::message(&format!("tyndall {}", words.join(" "))));
    if let Some(trace) = &told.trace {
        let _ = write!(text, "\n{trace}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_do_not_tell_where_files_are_kept() {
        for (file, shown) in [
            ("src/window/session.rs", "src/window/session.rs"),
            (
                "/root/.cargo/registry/src/index.crates.io-1949cf8c6b5b557f/wgpu-30.0.1/src/lib.rs",
                "wgpu-30.0.1/src/lib.rs",
            ),
            ("C:\\Users\\a\\.cargo\\registry\\src\\x\\ron-0.12.3\\src\\de.rs", "ron-0.12.3/src/de.rs"),
            ("/rustc/0123456789/library/core/src/option.rs", "library/core/src/option.rs"),
            ("/home/who/plugins/bob/src/main.rs", "src/main.rs"),
        ] {
            assert_eq!(source(file), shown);
        }
    }

    #[test]
    fn the_command_line_is_repeated() {
        let told = Told { message: "boom\u{1b}".into(), place: "src/a.rs:1:2".into(), trace: None };
        let text = report(&told, &["/usr/bin/tyndall", "render", "my scene.ron"].map(OsString::from));
        for part in [
            "this is a bug",
            "message  boom␛\n",
            "place    src/a.rs:1:2",
            env!("CARGO_PKG_VERSION"),
            "tyndall render 'my scene.ron'",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
    }
}
