//! Files on disk that are watched for other contents.
//!
//! A thread sleeps until the system tells of a change in a folder of one of the files. Folders are watched, not files: editors rename a
//! new file over the old one, or delete and create it. When it has been quiet for 20 ms, or 50 ms after the first change at the latest, the
//! files touched are compared with what they held when they were read, and only those that hold something else are told of. Once a
//! second files are looked at in any case, since not every file system tells (network shares; folders above that are moved).
//!
//! `notify-debouncer-full` was looked at for the middle part: it wakes up every few milliseconds for ever, hands out a burst of saves in a piece
//! at each of these, and follows renames, which comparing by path makes needless.

mod ledger;
mod paths;

use crate::sources::trail::FileState;
use ledger::Ledger;
pub(super) use ledger::content;
use notify::event::{AccessKind, AccessMode, EventKind, ModifyKind};
use notify::{RecursiveMode, Watcher};
use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long nothing must have happened before files are looked at, and how long that is waited for.
const QUIET: Duration = Duration::from_millis(20);
const PATIENCE: Duration = Duration::from_millis(50);

/// How often files are looked at in any case. More of the time than this part is never spent on that.
const ROUND: Duration = Duration::from_secs(1);
const ROUND_SHARE: u32 = 200;

/// What files are watched for; each reason has its own set of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Reason {
    /// They are the scene's text.
    Text,
    /// Entities were read from them.
    Assets,
    /// They are shaders.
    Shaders,
}

/// A file as whoever read it found it.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub path: PathBuf,
    pub state: FileState,
    /// [`content`] of what was read, where that is known.
    pub content: Option<u64>,
}

/// Files that hold something else than before.
#[derive(Debug)]
pub(super) struct Altered {
    pub files: BTreeSet<PathBuf>,
    /// When the first of the changes was noticed.
    pub since: Instant,
}

/// Called from the thread of the watch when files have changed. It should only wake up who polls.
pub type Wake = Box<dyn Fn() + Send>;

/// Watches files until it is dropped.
pub(super) struct FileWatch {
    to_thread: Sender<Message>,
    outcome: Arc<Mutex<Outcome>>,
}

/// What the thread leaves for who polls.
#[derive(Default)]
struct Outcome {
    altered: Option<Altered>,
    /// Folders that cannot be watched, and why.
    trouble: Vec<(PathBuf, String)>,
    wake: Option<Wake>,
}

enum Message {
    Event(notify::Result<notify::Event>),
    Watch(Reason, Vec<Found>),
    Stop,
}

impl FileWatch {
    /// Starts watching. Where the system cannot tell of changes, files are looked at every second.
    pub fn new() -> Self {
        let (to_thread, messages) = channel();
        let outcome = Arc::new(Mutex::new(Outcome::default()));
        let events = to_thread.clone();
        let theirs = outcome.clone();
        let started = std::thread::Builder::new()
            .name("tyndall file watch".into())
            .spawn(move || Thread::new(events, messages, theirs).run());
        if let Err(error) = started {
            let reason = format!("no thread can be started: {error}");
            lock(&outcome).trouble.push((PathBuf::new(), reason));
        }
        Self { to_thread, outcome }
    }

    /// Watches these files for a reason, and none of those that were named for it before. A file that is no longer as it was found counts as
    /// changed at once.
    pub fn watch(&self, reason: Reason, files: Vec<Found>) {
        // Without its thread, which was told of, nothing is watched.
        let _ = self.to_thread.send(Message::Watch(reason, files));
    }

    /// What has changed since this was last asked.
    pub fn take(&self) -> Option<Altered> {
        lock(&self.outcome).altered.take()
    }

    /// Folders that cannot be watched as they should be.
    pub fn trouble(&self) -> Vec<(PathBuf, String)> {
        lock(&self.outcome).trouble.clone()
    }

    /// Whom to wake when files have changed.
    pub fn on_change(&self, wake: Wake) {
        let mut outcome = lock(&self.outcome);
        if outcome.altered.is_some() {
            wake();
        }
        outcome.wake = Some(wake);
    }
}

impl Drop for FileWatch {
    fn drop(&mut self) {
        lock(&self.outcome).wake = None;
        let _ = self.to_thread.send(Message::Stop);
    }
}

fn lock(outcome: &Mutex<Outcome>) -> MutexGuard<'_, Outcome> {
    outcome.lock().unwrap_or_else(PoisonError::into_inner)
}

struct Thread {
    messages: Receiver<Message>,
    outcome: Arc<Mutex<Outcome>>,
    watcher: Result<notify::RecommendedWatcher, notify::Error>,
    ledger: Ledger,
    /// The folders that are watched.
    folders: HashSet<PathBuf>,
    /// Files that something happened to, and when it began and was last so.
    touched: HashSet<PathBuf>,
    burst: Option<(Instant, Instant)>,
    next_round: Instant,
}

impl Thread {
    fn new(events: Sender<Message>, messages: Receiver<Message>, outcome: Arc<Mutex<Outcome>>) -> Self {
        let watcher = notify::recommended_watcher(move |event: notify::Result<notify::Event>| {
            if event.as_ref().map_or(true, matters) {
                let _ = events.send(Message::Event(event));
            }
        });
        if let Err(error) = &watcher {
            lock(&outcome).trouble.push((PathBuf::new(), error.to_string()));
        }
        Self {
            messages,
            outcome,
            watcher,
            ledger: Ledger::default(),
            folders: HashSet::new(),
            touched: HashSet::new(),
            burst: None,
            next_round: Instant::now() + ROUND,
        }
    }

    fn run(mut self) {
        loop {
            let message = match self.time_to_sleep() {
                // However many messages there are.
                Some(Duration::ZERO) => Err(RecvTimeoutError::Timeout),
                Some(time) => self.messages.recv_timeout(time),
                None => self.messages.recv().map_err(|_| RecvTimeoutError::Disconnected),
            };
            match message {
                Ok(Message::Event(event)) => self.event(event),
                Ok(Message::Watch(reason, files)) => self.watch(reason, files),
                Ok(Message::Stop) | Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => self.timed_out(),
            }
        }
    }

    /// Until when nothing is to be done but to wait; for ever if there is no file to watch.
    fn time_to_sleep(&self) -> Option<Duration> {
        let now = Instant::now();
        let until = match self.burst {
            Some((first, last)) => (last + QUIET).min(first + PATIENCE),
            None if self.ledger.has_unknown_content() => now + QUIET,
            None if self.ledger.is_empty() => return None,
            None => self.next_round,
        };
        Some(until.saturating_duration_since(now))
    }

    fn timed_out(&mut self) {
        if let Some((first, _)) = self.burst.take() {
            let touched = std::mem::take(&mut self.touched);
            self.look_at(touched, true, first);
        } else if self.ledger.has_unknown_content() {
            self.ledger.learn_one_content();
        }
        if self.burst.is_none() && Instant::now() >= self.next_round {
            let started = Instant::now();
            let all = self.ledger.different_files();
            self.look_at(all, false, started);
            self.next_round = Instant::now() + ROUND.max(started.elapsed() * ROUND_SHARE);
        }
    }

    fn event(&mut self, event: notify::Result<notify::Event>) {
        let mut concerned: HashSet<PathBuf> = HashSet::new();
        match event {
            Ok(event) if event.need_rescan() => concerned.extend(self.ledger.files()),
            Ok(event) => {
                let moves =
                    !matches!(event.kind, EventKind::Access(_) | EventKind::Modify(ModifyKind::Metadata(_)));
                event.paths.iter().for_each(|path| self.happened_at(path, moves, &mut concerned));
            }
            Err(error) => {
                log::warn!("watching files: {error}");
                concerned.extend(self.ledger.files());
            }
        }
        if !concerned.is_empty() {
            self.touched.extend(concerned);
            let now = Instant::now();
            let first = self.burst.map_or(now, |(first, _)| first);
            self.burst = Some((first, now));
        }
    }

    fn happened_at(&mut self, path: &Path, moves: bool, concerned: &mut HashSet<PathBuf>) {
        concerned.extend(self.ledger.files_at(path));
        // A folder that is gone or elsewhere is watched no more, even if there is soon another in its place.
        if moves && self.folders.contains(path) {
            self.unwatch(path);
            concerned.extend(self.ledger.files_in(path));
        }
    }

    fn watch(&mut self, reason: Reason, files: Vec<Found>) {
        let mut named: HashSet<PathBuf> = HashSet::new();
        let mut changed = HashSet::new();
        for found in files {
            named.insert(found.path.clone());
            let is_new = !self.ledger.is_known(&found.path);
            self.ledger.add(reason, &found);
            if is_new {
                self.follow(&found.path);
            }
            if self.ledger.adopt(&found) {
                changed.insert(found.path);
            }
        }
        for gone in self.ledger.keep(reason, &named) {
            for idle in self.ledger.remove(&gone) {
                self.unwatch(&idle);
            }
        }
        self.tell(changed.into_iter().collect(), Instant::now());
    }

    /// Compares files with what they held, and tells of those that hold something else.
    fn look_at(&mut self, files: HashSet<PathBuf>, touched: bool, since: Instant) {
        let mut changed = BTreeSet::new();
        for file in files {
            // First watched, then looked at: what happens in between is told of.
            self.follow(&file);
            if self.ledger.compare(&file, touched) {
                changed.insert(file);
            }
        }
        self.tell(changed, since);
    }

    fn tell(&self, files: BTreeSet<PathBuf>, since: Instant) {
        if files.is_empty() {
            return;
        }
        let mut outcome = lock(&self.outcome);
        let altered = outcome.altered.get_or_insert(Altered { files: BTreeSet::new(), since });
        altered.files.extend(files);
        if let Some(wake) = &outcome.wake {
            wake();
        }
    }

    /// Watches the folders on which the path of a file now depends, which are others when links or folders have come or gone.
    fn follow(&mut self, file: &Path) {
        // What comes between looking and watching is seen by looking again.
        for _ in 0..3 {
            let entries = paths::entries(file);
            let folders = paths::folders(&entries);
            for idle in self.ledger.depend(file, entries) {
                self.unwatch(&idle);
            }
            let new: Vec<_> = folders.into_iter().filter(|folder| !self.folders.contains(folder)).collect();
            new.iter().for_each(|folder| self.watch_folder(folder));
            if new.is_empty() {
                return;
            }
        }
    }

    fn watch_folder(&mut self, folder: &Path) {
        let Ok(watcher) = &mut self.watcher else { return };
        let watched = watcher.watch(folder, RecursiveMode::NonRecursive);
        let mut outcome = lock(&self.outcome);
        outcome.trouble.retain(|(troubled, _)| troubled != folder);
        match watched {
            Ok(()) => _ = self.folders.insert(folder.to_owned()),
            // Gone again already: the next look finds what is there in its stead.
            Err(error) if matches!(error.kind, notify::ErrorKind::PathNotFound) => {}
            Err(error) => outcome.trouble.push((folder.to_owned(), error.to_string())),
        }
    }

    fn unwatch(&mut self, folder: &Path) {
        if self.folders.remove(folder)
            && let Ok(watcher) = &mut self.watcher
        {
            // It may have been forgotten with the folder.
            let _ = watcher.unwatch(folder);
        }
    }
}

/// Whether something may have been written. Opening and reading are told of as well, and reading is what follows here.
fn matters(event: &notify::Event) -> bool {
    match event.kind {
        EventKind::Access(kind) => kind == AccessKind::Close(AccessMode::Write),
        EventKind::Other => event.need_rescan(),
        _ => true,
    }
}
