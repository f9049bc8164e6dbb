//! The command line, for the `tyndall` program and for programs of your own.
//!
//! ```no_run
//! use bevy_app::App;
//!
//! fn main() -> std::process::ExitCode {
//!     tyndall::cli::run(|app: &mut App| { /* app.register_type::<MyComponent>().add_systems(…) */ })
//! }
//! ```

mod arguments;
mod bug;
mod check;
mod ending;
mod exit;
mod headless;
mod help;
mod info;
mod new;
mod open;
mod output;
mod outputs;
mod progress;
mod render;
mod terminal;
mod view;

use arguments::{Arguments, Command};
use bevy_app::{App, Plugins};
use clap::Parser;
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the whole command line with `plugins` beside the framework's own.
///
/// What a person reads goes to standard error, data to standard output. Exit codes: 0 done, 1 the input is at fault, 2 the command line is at
/// fault, 3 the machine is (no adapter, out of memory, disk full), 141 nobody reads standard output any more.
///
/// A panic that nobody catches ends it with 101, and with what to send to whoever can mend it.
pub fn run<M>(plugins: impl Plugins<M>) -> ExitCode {
    // Of what was typed: another command line is another program's business, which is not to begin again.
    if std::env::args_os().nth(1).is_some_and(|command| command != "view") {
        headless::leave_out_window_system();
    }
    run_from(std::env::args_os(), plugins)
}

/// The same with another command line than the process has: the name of the program, and what is typed behind it.
pub fn run_from<M>(
    words: impl IntoIterator<Item = impl Into<OsString>>,
    plugins: impl Plugins<M>,
) -> ExitCode {
    let words: Vec<OsString> = words.into_iter().map(Into::into).collect();
    bug::guarded(&words, || run_unguarded(&words, plugins))
}

fn run_unguarded<M>(words: &[OsString], plugins: impl Plugins<M>) -> ExitCode {
    let started = std::time::Instant::now();
    let arguments = match Arguments::try_parse_from(words) {
        Ok(arguments) => arguments,
        Err(shown) => return exit::help(&shown),
    };
    let filter = env_logger::Env::default().default_filter_or("warn,wgpu_hal=error");
    let mut logger = env_logger::Builder::from_env(filter);
    terminal::log_to(&mut logger);
    logger.init();
    ending::on_signals();
    let mut app = App::new();
    app.add_plugins(crate::TyndallPlugins).add_plugins(plugins);
    let done = match arguments.command {
        Command::View(arguments) => view::run(app, &arguments),
        Command::Render(arguments) => render::run(&mut app, &arguments, started),
        Command::Check(arguments) => check::run(&mut app, &arguments),
        Command::Info(arguments) => info::run(&mut app, &arguments),
        Command::New(arguments) => new::run(&arguments),
        Command::Help(arguments) => help::run(&app, &arguments),
    };
    exit::code(done)
}
