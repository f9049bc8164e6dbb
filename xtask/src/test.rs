//! `cargo xtask test`: every test of the workspace, with the variables that they need.

use anyhow::Result;

use crate::process::{Program, cargo};
use crate::{setup, tools};

/// Runs the tests that `arguments` select, or all of them and the documentation's as well.
pub fn run(arguments: &[String]) -> Result<()> {
    let environment = setup::environment()?;
    let selection = || arguments.iter().map(String::as_str);
    if !tools::has_nextest() {
        return cargo().arguments(["test", "--workspace"]).arguments(selection()).inside(&environment).run();
    }
    nextest().arguments(selection()).inside(&environment).run()?;
    if arguments.is_empty() {
        doc_tests().inside(&environment).run()?;
    }
    Ok(())
}

/// Unit and integration tests, each in a process of its own.
pub fn nextest() -> Program {
    cargo().arguments(["nextest", "run", "--workspace"])
}

/// The examples in the documentation, which nextest does not run.
pub fn doc_tests() -> Program {
    cargo().arguments(["test", "--doc", "--workspace"])
}
