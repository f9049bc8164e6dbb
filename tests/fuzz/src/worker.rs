//! The process that reads mutated files, within bounds.

use crate::target::Targets;
use crate::{Arguments, mutate, seeds};
use anyhow::{Context, Result, bail};
use fastrand::Rng;
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use rustix::time::{ClockId, clock_gettime};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Seconds of processor time that one file may take.
pub const MOST_SECONDS: u64 = 5;

/// What the process ends with when a file takes longer.
pub const TOO_LONG: i32 = 3;

/// Bytes that the process may have beyond those that it starts with: 1 GiB.
const MOST_BYTES: u64 = 1 << 30;

/// Mutates and reads until the time is over.
pub fn run(arguments: &Arguments, folder: &Path) -> Result<()> {
    let ends_so = |name: &str| arguments.only.as_ref().is_none_or(|ending| name.ends_with(ending.as_str()));
    let mut seeds = seeds::all()?;
    seeds.retain(|seed| ends_so(&seed.name));
    if seeds.is_empty() {
        bail!("there is no file to mutate");
    }
    let all = seeds.len();
    // As often each kind of file, however many there are of it.
    let mut kinds: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (index, seed) in seeds.iter().enumerate() {
        kinds.entry(ending(&seed.name)).or_default().push(index);
    }
    let kinds: Vec<Vec<usize>> = kinds.into_values().collect();
    let targets = Targets::new();
    limit_memory()?;
    let started_at = watch();
    let mut rng = Rng::with_seed(arguments.seed);
    let mut counts: BTreeMap<String, (u64, u64)> = BTreeMap::new();
    let deadline = Instant::now() + Duration::from_secs(arguments.seconds);
    let mut done = 0;
    while done < arguments.mutations && Instant::now() < deadline {
        let kind = &kinds[rng.usize(..kinds.len())];
        let seed = &seeds[kind[rng.usize(..kind.len())]];
        let mutated = mutate::mutated(&mut rng, seed, &seeds);
        let own = folder.join("input");
        fs::create_dir_all(&own)?;
        for (name, bytes) in &seed.beside {
            fs::write(own.join(name), bytes).with_context(|| format!("cannot write {name}"))?;
        }
        let path = own.join(&seed.name);
        fs::write(&path, &mutated).with_context(|| format!("cannot write {}", seed.name))?;
        started_at.store(processor_time(), Ordering::Relaxed);
        let is_read = targets.read(&path);
        started_at.store(IDLE, Ordering::Relaxed);
        let (read, refused) = counts.entry(ending(&seed.name)).or_default();
        *if is_read { read } else { refused } += 1;
        fs::remove_dir_all(&own)?;
        done += 1;
    }
    println!(
        "{done} mutations of {all} files (seed {}): none panicked, hung or took too much memory",
        arguments.seed
    );
    for (ending, (read, refused)) in counts {
        println!("  {ending:5} {read:8} read {refused:8} refused");
    }
    Ok(())
}

fn ending(name: &str) -> String {
    name.rsplit('.').next().unwrap_or_default().to_lowercase()
}

/// Reads one file within the same bounds.
pub fn repeat(path: &Path) -> Result<()> {
    let targets = Targets::new();
    limit_memory()?;
    watch().store(processor_time(), Ordering::Relaxed);
    println!("{}", if targets.read(path) { "read" } else { "refused" });
    Ok(())
}

/// The file that was being read in a worker's folder.
pub fn input_in(folder: &Path) -> Option<PathBuf> {
    let files = fs::read_dir(folder.join("input")).ok()?.filter_map(Result::ok).map(|entry| entry.path());
    // What stands beside was written before.
    files.max_by_key(|path| path.metadata().and_then(|metadata| metadata.modified()).ok())
}

/// Has allocations fail that no sound file needs.
fn limit_memory() -> Result<()> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes = status
        .lines()
        .find_map(|line| line.strip_prefix("VmSize:")?.trim().split(' ').next()?.parse::<u64>().ok());
    let Some(now) = kilobytes else { return Ok(()) };
    let known = getrlimit(Resource::As);
    let limit = Rlimit { current: Some(1024 * now + MOST_BYTES), maximum: known.maximum };
    setrlimit(Resource::As, limit).context("cannot limit the memory")
}

/// No file is being read.
const IDLE: u64 = u64::MAX;

/// Ends the process when a file takes too long: what is answered says when the reading of one began.
fn watch() -> Arc<AtomicU64> {
    let started_at = Arc::new(AtomicU64::new(IDLE));
    let watched = Arc::clone(&started_at);
    // Two looks at the same file, so that one that has just begun is not taken for the one before.
    let last = Mutex::new(IDLE);
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_millis(200));
            let start = watched.load(Ordering::Relaxed);
            let Ok(mut last) = last.lock() else { return };
            if start != IDLE && *last == start && processor_time() > start + 1000 * MOST_SECONDS {
                std::process::exit(TOO_LONG);
            }
            *last = start;
        }
    });
    started_at
}

/// Milliseconds of processor time that this process has had: a busy machine is no reason to complain.
fn processor_time() -> u64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec.unsigned_abs() * 1000 + time.tv_nsec.unsigned_abs() / 1_000_000
}
