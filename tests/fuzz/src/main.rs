//! Mutates files that the readers know, and scenes, and sees to it that none of them panics, takes more than five seconds or more than a gigabyte.
//!
//! ```sh
//! cargo run -p tyndall_fuzz -- --seconds 60
//! cargo run -p tyndall_fuzz -- --mutations 1000000 --seconds 3600 --seed 7
//! ```
//!
//! What breaks a reader is kept as a file, of which the last lines say how to read it again. With `TYNDALL_DATA`, the small files of that folder are
//! mutated too, beside those that are made here.

mod mutate;
mod seeds;
mod target;
mod worker;

use anyhow::{Context, Result, bail};
use clap::Parser;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, ExitStatus};

#[derive(Parser, Clone, Debug)]
struct Arguments {
    /// Ends after so many seconds
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// Ends after so many mutations, if that is sooner
    #[arg(long, default_value_t = u64::MAX)]
    mutations: u64,
    /// Where the random numbers begin; the same mutations follow from the same seed and files
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Mutates only files whose names end so: `nii`, `ron`
    #[arg(long)]
    only: Option<String>,
    /// Reads one file as it is, once
    #[arg(long)]
    repeat: Option<PathBuf>,
    /// The folder that the process that reads works in; for the program itself
    #[arg(long, hide = true)]
    worker: Option<PathBuf>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let outcome = match (&arguments.worker, &arguments.repeat) {
        (Some(folder), _) => worker::run(&arguments, folder),
        (None, Some(file)) => worker::repeat(file),
        (None, None) => supervise(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Has another process read, which may end in any way.
fn supervise() -> Result<()> {
    let folder = tempfile::tempdir().context("cannot make a folder for the files")?;
    let program = std::env::current_exe().context("cannot find this program")?;
    let given: Vec<_> = std::env::args_os().skip(1).collect();
    let status = Command::new(program)
        .args(given)
        .arg("--worker")
        .arg(folder.path())
        .status()
        .context("cannot start the process that reads")?;
    if status.success() {
        return Ok(());
    }
    let kept = keep(folder.path())?;
    bail!("{}; repeat it with `cargo run -p tyndall_fuzz -- --repeat {}`", end_of(status), kept.display())
}

fn end_of(status: ExitStatus) -> String {
    match status.code() {
        Some(101) => "a reader panicked".to_owned(),
        Some(worker::TOO_LONG) => format!("a reader took more than {} s", worker::MOST_SECONDS),
        Some(code) => format!("the process that reads ended with code {code}"),
        // An allocation that fails aborts.
        None => {
            "the process that reads was ended by a signal: it crashed, or wanted more than 1 GiB".to_owned()
        }
    }
}

/// Copies the file that was being read to where it stays.
fn keep(folder: &Path) -> Result<PathBuf> {
    let last = worker::input_in(folder).context("no file was being read")?;
    let kept = Path::new("target").join("fuzz");
    fs::create_dir_all(&kept).context("cannot make target/fuzz")?;
    let path = kept.join(last.file_name().unwrap_or_default());
    fs::copy(&last, &path).with_context(|| format!("cannot keep {}", last.display()))?;
    Ok(path)
}
