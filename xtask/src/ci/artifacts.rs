//! The workspace's programs and examples, and where cargo put them.
//!
//! They are run directly rather than by `cargo run`, which would select one package and build its crates again.

use anyhow::{Context, Result};
use serde_json::Value;

use crate::process::cargo;

const BUILD: [&str; 4] = ["build", "--workspace", "--bins", "--examples"];

/// Something that can be run.
#[derive(Debug, PartialEq, Eq)]
pub struct Artifact {
    pub name: String,
    pub executable: String,
}

/// All that can be run, sorted by name.
#[derive(Debug, Default)]
pub struct Artifacts {
    pub programs: Vec<Artifact>,
    pub examples: Vec<Artifact>,
}

impl Artifacts {
    pub fn program(&self, name: &str) -> Result<&Artifact> {
        let found = self.programs.iter().find(|artifact| artifact.name == name);
        found.with_context(|| format!("the workspace builds no program named `{name}`"))
    }
}

/// What a person types for the same.
pub fn build_line() -> &'static str {
    "cargo build --workspace --bins --examples"
}

/// Builds them; after the tests there is nothing left to compile.
pub fn build() -> Result<Artifacts> {
    let messages = cargo().arguments(BUILD).arguments(["--message-format=json-render-diagnostics"]);
    parse(&messages.capture_output()?)
}

/// Reads cargo's messages, one JSON object a line.
fn parse(messages: &str) -> Result<Artifacts> {
    let mut artifacts = Artifacts::default();
    for line in messages.lines().filter(|line| line.starts_with('{')) {
        let message: Value = serde_json::from_str(line).context("cannot read cargo's messages")?;
        let (Some(executable), Some(name)) =
            (message["executable"].as_str(), message["target"]["name"].as_str())
        else {
            continue;
        };
        let artifact = Artifact { name: name.to_owned(), executable: executable.to_owned() };
        match message["target"]["kind"][0].as_str() {
            Some("example") => artifacts.examples.push(artifact),
            Some("bin") => artifacts.programs.push(artifact),
            _ => {}
        }
    }
    artifacts.examples.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(artifacts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_and_examples_are_told_apart() {
        let messages = r#"
{"reason":"compiler-artifact","target":{"kind":["lib"],"name":"tyndall"},"executable":null}
{"reason":"compiler-artifact","target":{"kind":["bin"],"name":"tyndall"},"executable":"/t/debug/tyndall"}
{"reason":"compiler-artifact","target":{"kind":["example"],"name":"slab"},"executable":"/t/debug/examples/slab"}
{"reason":"build-finished","success":true}"#;
        let artifacts = parse(messages).unwrap();
        assert_eq!(artifacts.program("tyndall").unwrap().executable, "/t/debug/tyndall");
        assert_eq!(artifacts.examples.len(), 1);
        assert_eq!(artifacts.examples[0].name, "slab");
        assert!(artifacts.program("other").is_err());
    }
}
