//! Again whenever a file of a scene changes, until somebody stops it.
//!
//! Folders are watched, not files, as editors put a new file in the place of the old one; and whatever the system says of
//! an event, only the contents of the files that the scene was read from decide. So neither a file that is only touched
//! nor what a run itself writes beside the scene makes another run.

use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_formats::{Content, Digest, Error, Result};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How often it is asked whether to stop.
const TICK: Duration = Duration::from_millis(100);

/// A change is over when nothing more happens for this long: programs write in pieces, and several files.
const QUIET: Duration = Duration::from_millis(200);

/// A folder in which something happens all the time is looked at after this long all the same.
const PATIENCE: Duration = Duration::from_secs(2);

/// Of a scene that cannot be read it is not known where its files lie: it is tried again this often.
const RETRY: Duration = Duration::from_secs(1);

/// Call `run` now and whenever the scene in `file` or what lies in `beside` has changed, with the reason, until the monitor is
/// stopped. Fails where folders cannot be watched.
pub fn watch(file: &Path, beside: &[&Path], monitor: &Monitor, mut run: impl FnMut(&str)) -> Result<()> {
    let (sender, events) = channel();
    let watcher = notify::recommended_watcher(move |_| {
        // Nobody listens any more once the watch is over.
        let _ = sender.send(());
    });
    let mut folders =
        Folders { watcher: watcher.map_err(|error| unwatchable(file, &error))?, watched: HashSet::new() };
    let mut why = "first run".to_owned();
    loop {
        let state = State::of(file, beside);
        folders.watch(file, &state)?;
        run(&why);
        loop {
            wait(&events, monitor, &state);
            if monitor.stopped() {
                return Ok(());
            }
            if let Some(change) = state.change(file, beside) {
                why = change;
                break;
            }
        }
    }
}

/// What a scene is made of.
#[derive(PartialEq)]
enum State {
    /// What its files hold; nothing of those that cannot be read.
    Files(BTreeMap<PathBuf, Option<Digest>>),
    /// Why it cannot be read.
    Broken(String),
}

impl State {
    fn of(file: &Path, beside: &[&Path]) -> Self {
        match import_scene(file) {
            Ok(scene) => Self::Files(digests(
                scene.sources.into_iter().chain(beside.iter().map(|path| path.to_path_buf())),
            )),
            Err(error) => Self::Broken(error.to_string()),
        }
    }

    /// What has changed since, for a person.
    fn change(&self, file: &Path, beside: &[&Path]) -> Option<String> {
        let changed: Vec<String> = match self {
            Self::Files(old) => {
                let new = digests(old.keys().cloned());
                new.iter()
                    .filter(|(path, digest)| old[*path] != **digest)
                    .map(|(path, _)| name(path))
                    .collect()
            }
            Self::Broken(_) if Self::of(file, beside) == *self => vec![],
            Self::Broken(_) => vec![name(file)],
        };
        (!changed.is_empty()).then(|| format!("{} changed", changed.join(", ")))
    }
}

fn digests(files: impl IntoIterator<Item = PathBuf>) -> BTreeMap<PathBuf, Option<Digest>> {
    let digest = |path: &Path| std::fs::read(path).ok().map(|bytes| Content::new().bytes(bytes).digest());
    files.into_iter().map(|path| (path.clone(), digest(&path))).collect()
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// The folders that are watched.
struct Folders {
    watcher: RecommendedWatcher,
    watched: HashSet<PathBuf>,
}

impl Folders {
    /// Watch the folders of all files of a scene.
    fn watch(&mut self, file: &Path, state: &State) -> Result<()> {
        let files: Vec<&Path> = match state {
            State::Files(files) => files.keys().map(PathBuf::as_path).collect(),
            State::Broken(_) => vec![file],
        };
        for path in files {
            let parent = path.parent().filter(|folder| *folder != Path::new(""));
            let folder = parent.unwrap_or(Path::new(".")).to_path_buf();
            if folder.is_dir() && self.watched.insert(folder.clone()) {
                let watched = self.watcher.watch(&folder, RecursiveMode::NonRecursive);
                watched.map_err(|error| unwatchable(&folder, &error))?;
            }
        }
        Ok(())
    }
}

fn unwatchable(path: &Path, error: &notify::Error) -> Error {
    Error::new(
        path,
        format!("cannot be watched ({error})"),
        "a folder of which the system tells changes",
        "assemble without --watch",
    )
}

/// Wait until something happened and is over, or it is time to look anyway, or the monitor is stopped.
fn wait(events: &Receiver<()>, monitor: &Monitor, state: &State) {
    let start = Instant::now();
    while !monitor.stopped() {
        match events.recv_timeout(TICK) {
            Ok(()) => break,
            Err(RecvTimeoutError::Timeout)
                if matches!(state, State::Broken(_)) && start.elapsed() > RETRY =>
            {
                return;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(TICK),
        }
    }
    let first = Instant::now();
    while first.elapsed() < PATIENCE && events.recv_timeout(QUIET).is_ok() {}
}
