//! How the program ends when something is wrong.

use crate::gpu::GpuError;
use crate::render::RenderError;
use crate::scene::{Problem, Severity};
use crate::window::WindowError;
use miette::{GraphicalReportHandler, GraphicalTheme};
use std::io::IsTerminal;
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
}

impl Failure {
    /// Says what went wrong, if that is still to be said, and gives the exit code.
    pub fn tell(self) -> ExitCode {
        match self {
            Self::Input => ExitCode::from(1),
            Self::Usage(message) => tell(&message, 2),
            Self::Machine(message) => tell(&message, 3),
        }
    }
}

fn tell(message: &str, code: u8) -> ExitCode {
    eprintln!("error: {message}");
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

/// Prints problems with the text around them, as the terminal allows.
pub(super) fn print(problems: &[Problem]) {
    let handler = if std::io::stderr().is_terminal() {
        GraphicalReportHandler::new()
    } else {
        GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor()).with_width(120)
    };
    for problem in problems {
        eprintln!("{}", problem.render(&handler));
    }
}

/// "2 errors, 1 note".
pub(super) fn count(problems: &[Problem]) -> String {
    let errors = problems.iter().filter(|problem| problem.severity == Severity::Error).count();
    let notes = problems.len() - errors;
    let plural = |count: usize, name: &str| format!("{count} {name}{}", if count == 1 { "" } else { "s" });
    match (errors, notes) {
        (0, 0) => "no problems".into(),
        (0, notes) => plural(notes, "note"),
        (errors, 0) => plural(errors, "error"),
        (errors, notes) => format!("{}, {}", plural(errors, "error"), plural(notes, "note")),
    }
}
