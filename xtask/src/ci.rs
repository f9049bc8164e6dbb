//! `cargo xtask ci`: all that a change has to pass, in the order in which it fails fastest.
//!
//! Everything is built in the dev profile and for the whole workspace at once. Selecting one package would
//! choose other features of the shared crates, and so build the largest of them a second time.

mod artifacts;
mod report;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::environment::Environment;
use crate::process::{Program, cargo};
use crate::{assets, setup, test};
use report::Report;

/// Runs the whole gate and prints what each step took.
pub fn run() -> Result<()> {
    let mut report = Report::default();
    let outcome = steps(&mut report);
    eprintln!("\n{report}");
    outcome
}

fn steps(report: &mut Report) -> Result<()> {
    report.step("setup", "cargo xtask setup --ci", || setup::run(true))?;
    let environment = Environment::new()?;

    report.program("format", cargo().arguments(["fmt", "--all", "--check"]))?;
    report.program("lints", clippy())?;
    report.program("licences", deny()?.arguments(["check", "bans", "licenses", "sources"]))?;
    advisories(report, cargo().arguments(["deny", "fetch", "db"]).capture(), || {
        Ok(deny()?.arguments(["check", "advisories"]))
    })?;
    report.step("assets", "cargo xtask assets --check", assets::check)?;
    report.program("tests", test::nextest().variable("CI", "true").inside(&environment))?;
    report.program("doc tests", test::doc_tests().variable("CI", "true").inside(&environment))?;
    report.program("docs", docs())?;

    let built = report.step("build", artifacts::build_line(), artifacts::build)?;
    for example in &built.examples {
        let repeat = format!("cargo run --example {}", example.name);
        let program = Program::new(&example.executable).inside(&environment);
        report.step(&format!("example {}", example.name), &repeat, || program.run())?;
    }
    report.step("scenes", "tyndall check (every scene under scenes/)", || {
        check_scenes(&built.program("tyndall")?.executable, &environment)
    })?;
    report.step("fuzz", "cargo run -p tyndall_fuzz -- --seconds 60", || {
        Program::new(&built.program("tyndall-fuzz")?.executable).arguments(["--seconds", "60"]).run()
    })
}

fn clippy() -> Program {
    cargo().arguments(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"])
}

/// Needs the manifests of every crate for every system; without the network, those for this system will do.
fn deny() -> Result<Program> {
    let program = cargo().arguments(["deny", "--offline"]);
    let fetched = cargo().arguments(["fetch", "--locked", "--quiet"]).capture();
    let program = match fetched {
        Ok(_) => program,
        Err(error) => {
            eprintln!("checking the licences for this system only: {error:#}");
            program.arguments(["--target", &host()?])
        }
    };
    Ok(program)
}

/// Looks for known vulnerabilities of all dependencies, where the database of them could be reached: a machine without the network is no reason
/// to fail.
fn advisories(
    report: &mut Report,
    fetched: Result<String>,
    check: impl FnOnce() -> Result<Program>,
) -> Result<()> {
    match fetched {
        Ok(_) => report.program("advisories", check()?),
        Err(error) => {
            let told = format!("{error:#}");
            // The first line says what was tried; the last is the reason.
            let reason = told.lines().map(str::trim).rfind(|line| !line.is_empty()).unwrap_or_default();
            report.not_checked("advisories", &format!("the database cannot be reached ({reason})"));
            Ok(())
        }
    }
}

/// The system that cargo itself was built for.
fn host() -> Result<String> {
    let version = cargo().arguments(["--version", "--verbose"]).capture()?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.context("`cargo --version --verbose` names no host")?.to_owned())
}

fn docs() -> Program {
    cargo().arguments(["doc", "--workspace", "--no-deps"]).variable("RUSTDOCFLAGS", "-D warnings")
}

fn check_scenes(program: &str, environment: &Environment) -> Result<()> {
    let scenes = scene_files(Path::new("scenes")).context("cannot list scenes/")?;
    if scenes.is_empty() {
        bail!("there is no scene under scenes/");
    }
    Program::new(program).arguments(["check"]).arguments(scenes).inside(environment).run()
}

/// Folders of components that scenes share by `File("…")`: checked with the scenes that use them, and no scenes themselves.
const SHARED: [&str; 2] = ["materials", "transfer_functions"];

/// Every scene under the folder.
fn scene_files(folder: &Path) -> Result<Vec<String>> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
            let path: PathBuf = entry?.path();
            if path.is_dir() {
                if !SHARED.iter().any(|shared| path.ends_with(shared)) {
                    folders.push(path);
                }
            } else if path.extension().is_some_and(|extension| extension == "ron") {
                files.push(path.to_str().context("a scene's name is no UTF-8")?.to_owned());
            }
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_found_in_every_folder_but_those_of_shared_components() {
        let root = tempfile::tempdir().unwrap();
        for folder in ["volumes", "transfer_functions"] {
            fs::create_dir(root.path().join(folder)).unwrap();
        }
        for name in ["b.ron", "volumes/a.ron", "notes.md", "transfer_functions/bone.ron"] {
            fs::write(root.path().join(name), "()").unwrap();
        }
        let found = scene_files(root.path()).unwrap();
        let names: Vec<_> =
            found.iter().map(|path| Path::new(path).strip_prefix(root.path()).unwrap()).collect();
        assert_eq!(names, [Path::new("b.ron"), Path::new("volumes/a.ron")]);
    }

    #[test]
    fn without_the_network_advisories_are_not_checked_and_with_it_they_count() {
        let mut report = Report::default();
        let offline = Err(anyhow::anyhow!("`cargo deny fetch db` failed:\nerror: no route to host\n"));
        advisories(&mut report, offline, || panic!("there is nothing to check with")).unwrap();
        let table = report.to_string();
        assert!(
            table.contains("not checked: the database cannot be reached (error: no route to host)"),
            "{table}"
        );
        assert!(!table.contains("ok") && !table.contains("FAILED"), "{table}");

        let answer = |command: &'static str| move || Ok(cargo().arguments([command]));
        let vulnerable = advisories(&mut report, Ok(String::new()), answer("no-such-command"));
        assert!(vulnerable.unwrap_err().to_string().contains("step `advisories` failed"));
        advisories(&mut report, Ok(String::new()), answer("--version")).unwrap();
    }
}
