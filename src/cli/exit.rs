//! How the program ends when something is wrong.

use super::terminal;
use crate::gpu::GpuError;
use crate::render::RenderError;
use crate::scene::{MOST_TOLD, Problem, Severity, grouped, more};
use crate::window::WindowError;
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::io::{ErrorKind, IsTerminal};
use std::process::ExitCode;

/// Who is at fault, and what to say.
#[derive(Debug)]
pub(super) enum Failure {
    /// The input; what is wrong has been said already.
    Input,
    /// The command line.
    Usage(String),
    /// The machine.
    Machine(String),
    /// Who read standard output has closed it, which is nobody's fault.
    Unread,
}

/// What a shell reports of a filter that wrote where nobody reads any more: 128 and the number of SIGPIPE.
const UNREAD: u8 = 141;

/// The exit code of the program.
pub(super) fn code(done: Result<(), Failure>) -> ExitCode {
    match done {
        Err(failure) => failure.tell(),
        // What was to be said was not.
        Ok(()) if terminal::is_lost() => ExitCode::from(3),
        Ok(()) => ExitCode::SUCCESS,
    }
}

/// Prints help, the version, or what is wrong with the command line.
pub(super) fn help(shown: &clap::Error) -> ExitCode {
    match shown.print() {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => ExitCode::from(UNREAD),
        Err(_) => ExitCode::from(3),
        Ok(()) => ExitCode::from(if shown.use_stderr() { 2 } else { 0 }),
    }
}

impl Failure {
    /// Says what went wrong, if that is still to be said, and gives the exit code.
    pub fn tell(self) -> ExitCode {
        match self {
            Self::Input => ExitCode::from(1),
            Self::Usage(message) => tell(&message, 2),
            Self::Machine(message) => tell(&message, 3),
            Self::Unread => ExitCode::from(UNREAD),
        }
    }
}

fn tell(message: &str, code: u8) -> ExitCode {
    terminal::tell(format_args!("error: {message}"));
    ExitCode::from(code)
}

impl From<GpuError> for Failure {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::PictureTooLarge { .. } => Self::Usage(error.to_string()),
            _ => Self::Machine(error.to_string()),
        }
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Scene => Self::Input,
            RenderError::Gpu(error) => error.into(),
        }
    }
}

impl From<WindowError> for Failure {
    fn from(error: WindowError) -> Self {
        match error {
            WindowError::Gpu(error) => error.into(),
            _ => Self::Machine(error.to_string()),
        }
    }
}

/// Prints problems with the text around them, as the terminal allows; of many, the first in full and how many more there are.
pub(super) fn print(problems: &[Problem]) {
    let handler = if std::io::stderr().is_terminal() {
        GraphicalReportHandler::new()
    } else {
        GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(120)
    };
    // Errors first, where not all are told.
    let (errors, notes): (Vec<&Problem>, _) =
        problems.iter().partition(|problem| problem.severity == Severity::Error);
    let is_told = problems.len() <= MOST_TOLD;
    let told: Vec<&Problem> =
        if is_told { problems.iter().collect() } else { errors.into_iter().chain(notes).collect() };
    for problem in told.into_iter().take(MOST_TOLD) {
        terminal::styled(&problem.render(&handler));
    }
    if let Some(more) = more(problems.len()) {
        terminal::tell(format_args!("{more}\n"));
    }
}

/// "2 errors, 1 note".
pub(super) fn count(problems: &[Problem]) -> String {
    let errors = problems.iter().filter(|problem| problem.severity == Severity::Error).count();
    let notes = problems.len() - errors;
    let plural =
        |count: usize, name: &str| format!("{} {name}{}", grouped(count), if count == 1 { "" } else { "s" });
    match (errors, notes) {
        (0, 0) => "no problems".into(),
        (0, notes) => plural(notes, "note"),
        (errors, 0) => plural(errors, "error"),
        (errors, notes) => format!("{}, {}", plural(errors, "error"), plural(notes, "note")),
    }
}
