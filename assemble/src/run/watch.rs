//! Repeats a run whenever a file of the scene changes, until the monitor is stopped.
//!
//! Folders are watched instead of files, since editors replace files by new ones. Only the contents of the scene's
//! input files decide whether a run is needed, whatever the events of the operating system say: neither a touched
//! file nor the outputs of a run start another run.

use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_formats::fingerprint::{Content, Digest};
use equilux_formats::{Error, Result};
use notify::{RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Interval at which stop requests are checked.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// A change is complete when no event follows for this long: programs write in steps, and several files.
const QUIET_PERIOD: Duration = Duration::from_millis(200);

/// Maximum time to wait for the quiet period in a folder with constant events.
const MAX_WAIT: Duration = Duration::from_secs(2);

/// Interval at which a scene that cannot be read is tried again: the locations of its files are unknown.
const RETRY_INTERVAL: Duration = Duration::from_secs(1);

/// Call `run` with the reason, immediately and whenever the scene in `file` or a file in `beside` has changed, until
/// the monitor is stopped. Fails if folders cannot be watched.
pub fn watch(file: &Path, beside: &[&Path], monitor: &Monitor, mut run: impl FnMut(&str)) -> Result<()> {
    let (sender, events) = channel();
    let watcher = notify::recommended_watcher(move |_| {
        // The channel is closed once the watch has ended.
        let _ = sender.send(());
    });
    let mut folders =
        Folders { watcher: watcher.map_err(|error| unwatchable(file, &error))?, watched: HashSet::new() };
    let mut why = "first run".to_owned();
    loop {
        let state = SceneState::of(file, beside);
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

/// The state of a scene's input files.
#[derive(PartialEq)]
enum SceneState {
    /// A digest of each file; none for files that cannot be read.
    Files(BTreeMap<PathBuf, Option<Digest>>),
    /// The error, if the scene cannot be read.
    Broken(String),
}

impl SceneState {
    fn of(file: &Path, beside: &[&Path]) -> Self {
        match import_scene(file) {
            Ok(scene) => Self::Files(digests(
                scene.sources.into_iter().chain(beside.iter().map(|path| path.to_path_buf())),
            )),
            Err(error) => Self::Broken(error.to_string()),
        }
    }

    /// The change since then as text, if there is one.
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

/// The watched folders.
struct Folders {
    watcher: RecommendedWatcher,
    watched: HashSet<PathBuf>,
}

impl Folders {
    /// Watch the folders of all files of a scene.
    fn watch(&mut self, file: &Path, state: &SceneState) -> Result<()> {
        let files: Vec<&Path> = match state {
            SceneState::Files(files) => files.keys().map(PathBuf::as_path).collect(),
            SceneState::Broken(_) => vec![file],
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
        "a folder whose changes the operating system reports",
        "assemble without --watch",
    )
}

/// Wait until a change is complete, a retry is due, or the monitor is stopped.
fn wait(events: &Receiver<()>, monitor: &Monitor, state: &SceneState) {
    let start = Instant::now();
    while !monitor.stopped() {
        match events.recv_timeout(STOP_CHECK_INTERVAL) {
            Ok(()) => break,
            Err(RecvTimeoutError::Timeout)
                if matches!(state, SceneState::Broken(_)) && start.elapsed() > RETRY_INTERVAL =>
            {
                return;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => std::thread::sleep(STOP_CHECK_INTERVAL),
        }
    }
    let first = Instant::now();
    while first.elapsed() < MAX_WAIT && events.recv_timeout(QUIET_PERIOD).is_ok() {}
}
