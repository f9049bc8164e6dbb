//! The `tyndall` program: the framework and the plugins that come with it.

use std::process::ExitCode;

fn main() -> ExitCode {
    tyndall::cli::run(tyndall_turntable::TurntablePlugin)
}
