//! Running other programs, and showing how to repeat by hand what failed.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use anyhow::{Context, Result, anyhow, bail};

use crate::environment::Environment;

/// A program to run, and the line that a person would type to run the same.
pub struct Program {
    command: Command,
    line: String,
}

/// The cargo that runs this very task.
pub fn cargo() -> Program {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    Program { command: Command::new(cargo), line: "cargo".to_owned() }
}

impl Program {
    /// `name` is looked up in the search path.
    pub fn new(name: &str) -> Self {
        Self { command: Command::new(name), line: name.to_owned() }
    }

    pub fn arguments<S: AsRef<str>>(mut self, arguments: impl IntoIterator<Item = S>) -> Self {
        for argument in arguments {
            self.command.arg(argument.as_ref());
            self.line = format!("{} {}", self.line, quoted(argument.as_ref()));
        }
        self
    }

    /// Sets a variable that belongs to the line to type.
    pub fn variable(mut self, name: &str, value: &str) -> Self {
        self.command.env(name, value);
        self.line = format!("{name}={} {}", quoted(value), self.line);
        self
    }

    pub fn without_variable(mut self, name: &str) -> Self {
        self.command.env_remove(name);
        self
    }

    /// Sets what the program under test needs to find its adapter and its data.
    pub fn inside(mut self, environment: &Environment) -> Self {
        self.command.envs(environment.variables());
        self
    }

    pub fn in_folder(mut self, folder: &Path) -> Self {
        self.command.current_dir(folder);
        self
    }

    /// What a person would type.
    pub fn line(&self) -> &str {
        &self.line
    }

    /// Runs with the terminal's own input and output.
    pub fn run(mut self) -> Result<()> {
        let status = self.command.status().with_context(|| format!("cannot run `{}`", self.line))?;
        if !status.success() {
            bail!("`{}` failed ({status})", self.line);
        }
        Ok(())
    }

    /// Runs silently and returns what it wrote; a failure quotes its complaint.
    pub fn capture(mut self) -> Result<String> {
        let output = self.output(Stdio::piped())?;
        if !output.status.success() {
            let complaint = String::from_utf8_lossy(&output.stderr);
            bail!("`{}` failed ({}):\n{}", self.line, output.status, complaint.trim());
        }
        String::from_utf8(output.stdout).with_context(|| format!("`{}` wrote no UTF-8", self.line))
    }

    /// Runs with its complaints shown, and returns what it wrote to standard output.
    pub fn capture_output(mut self) -> Result<String> {
        let output = self.output(Stdio::inherit())?;
        if !output.status.success() {
            bail!("`{}` failed ({})", self.line, output.status);
        }
        String::from_utf8(output.stdout).with_context(|| format!("`{}` wrote no UTF-8", self.line))
    }

    fn output(&mut self, complaints: Stdio) -> Result<Output> {
        self.command.stdin(Stdio::null()).stderr(complaints).output().map_err(|error| match error.kind() {
            ErrorKind::NotFound => anyhow!("`{}` is not installed", self.command.get_program().display()),
            _ => anyhow!("cannot run `{}`: {error}", self.line),
        })
    }
}

/// Where the shell, or cargo for its subcommands, would find this program.
pub fn find(name: &str) -> Option<PathBuf> {
    let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    let search_path = std::env::var_os("PATH").unwrap_or_default();
    let mut folders: Vec<PathBuf> = std::env::split_paths(&search_path).collect();
    folders.extend(cargo_home().map(|home| home.join("bin")));
    folders.into_iter().map(|folder| folder.join(&file)).find(|path| path.is_file())
}

fn cargo_home() -> Option<PathBuf> {
    let home = || std::env::home_dir().map(|home| home.join(".cargo"));
    std::env::var_os("CARGO_HOME").map(PathBuf::from).or_else(home)
}

/// True when the variable is set and says something.
pub fn is_set(name: impl AsRef<OsStr>) -> bool {
    std::env::var_os(name).is_some_and(|value| !value.is_empty())
}

fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:@,+%".contains(c);
    if !word.is_empty() && word.chars().all(plain) { word.to_owned() } else { format!("'{word}'") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_can_be_typed() {
        let program = cargo().arguments(["doc", "-E", "a b"]).variable("RUSTDOCFLAGS", "-D warnings");
        assert_eq!(program.line(), "RUSTDOCFLAGS='-D warnings' cargo doc -E 'a b'");
    }

    #[test]
    fn a_missing_program_is_named() {
        let error = Program::new("tyndall-no-such-program").capture().unwrap_err();
        assert_eq!(error.to_string(), "`tyndall-no-such-program` is not installed");
    }
}
