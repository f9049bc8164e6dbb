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
mod check;
mod exit;
mod info;
mod new;
mod open;
mod output;
mod progress;
mod render;
mod view;

use arguments::{Arguments, Command};
use bevy_app::{App, Plugins};
use clap::Parser;
use exit::Failure;
use std::process::ExitCode;

/// Runs the whole command line with `plugins` beside the framework's own.
///
/// What a person reads goes to standard error, data to standard output. Exit codes: 0 done, 1 the input is at fault, 2 the command line is at
/// fault, 3 the machine is (no adapter, out of memory, disk full).
pub fn run<M>(plugins: impl Plugins<M>) -> ExitCode {
    let started = std::time::Instant::now();
    let arguments = Arguments::parse();
    env_logger::Builder::from_env(env_logger::Env::default().default_filter_or("warn,wgpu_hal=error"))
        .format_timestamp(None)
        .init();
    let mut app = App::new();
    app.add_plugins(crate::TyndallPlugins).add_plugins(plugins);
    let done = match arguments.command {
        Command::View(arguments) => view::run(app, &arguments),
        Command::Render(arguments) => render::run(&mut app, &arguments, started),
        Command::Check(arguments) => check::run(&mut app, &arguments),
        Command::Info(arguments) => info::run(&mut app, &arguments),
        Command::New(arguments) => new::run(&arguments),
    };
    done.map_or_else(Failure::tell, |()| ExitCode::SUCCESS)
}
