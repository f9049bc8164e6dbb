//! The steps of the gate, what each took, and how to repeat the one that failed.

use std::fmt;
use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};

use crate::process::Program;

/// Steps in the order in which they ran; shown as a table.
#[derive(Default)]
pub struct Report {
    steps: Vec<Step>,
}

struct Step {
    name: String,
    took: Duration,
    verdict: Verdict,
}

enum Verdict {
    Passed,
    Failed,
    /// And why.
    NotChecked(String),
}

impl Report {
    /// Runs a step; `repeat` is what a person types to run it again alone.
    pub fn step<T>(&mut self, name: &str, repeat: &str, action: impl FnOnce() -> Result<T>) -> Result<T> {
        eprintln!("\n--- {name}: {repeat}");
        let start = Instant::now();
        let outcome = action();
        let verdict = if outcome.is_ok() { Verdict::Passed } else { Verdict::Failed };
        self.steps.push(Step { name: name.to_owned(), took: start.elapsed(), verdict });
        outcome.map_err(|error| anyhow!("{error:#}\nstep `{name}` failed; to repeat it alone:\n    {repeat}"))
    }

    /// Notes a step that this machine cannot take, which is no failure.
    pub fn not_checked(&mut self, name: &str, why: &str) {
        eprintln!("\n--- {name}: not checked: {why}");
        let verdict = Verdict::NotChecked(why.to_owned());
        self.steps.push(Step { name: name.to_owned(), took: Duration::ZERO, verdict });
    }

    /// Runs a step that is one program.
    pub fn program(&mut self, name: &str, program: Program) -> Result<()> {
        let repeat = program.line().to_owned();
        self.step(name, &repeat, || program.run())
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.steps.iter().map(|step| step.name.chars().count()).max().unwrap_or(0).max(5);
        for Step { name, took, verdict } in &self.steps {
            let verdict = match verdict {
                Verdict::Passed => "ok".to_owned(),
                Verdict::Failed => "FAILED".to_owned(),
                Verdict::NotChecked(why) => format!("not checked: {why}"),
            };
            writeln!(f, "{name:width$} {:8.1} s  {verdict}", took.as_secs_f64())?;
        }
        let total: Duration = self.steps.iter().map(|step| step.took).sum();
        write!(f, "{:width$} {:8.1} s", "total", total.as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failure_says_how_to_repeat_it() {
        let mut report = Report::default();
        report.step("one", "type one", || Ok(())).unwrap();
        let error = report.step("two", "type two", || -> Result<()> { anyhow::bail!("broken") }).unwrap_err();
        assert_eq!(format!("{error:#}"), "broken\nstep `two` failed; to repeat it alone:\n    type two");

        let table = report.to_string();
        let verdicts: Vec<_> = table.lines().map(|line| line.split_whitespace().last().unwrap()).collect();
        assert_eq!(verdicts, ["ok", "FAILED", "s"]);
    }
}
