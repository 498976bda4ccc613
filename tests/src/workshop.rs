//! A folder to try things in: scenes written there, assembled by library or program, nothing left behind.

use crate::model::{Model, Node};
use crate::program::program;
use assert_cmd::Command;
use equilux_assemble::exchange::{Goal, Method};
use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::report::Report;
use equilux_assemble::run::{Job, Pictures, run};
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Division, Preparation};
use equilux_bake::treecode::EXACT;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// No test's program takes a tenth of this, so whoever does hangs.
const PATIENCE: Duration = Duration::from_secs(120);

/// The folder.
pub struct Workshop(TempDir);

/// How a program ended.
pub struct Ended {
    /// Its exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// What it printed.
    pub stdout: String,
    /// What it said of itself.
    pub stderr: String,
}

impl Workshop {
    /// An empty one.
    #[expect(clippy::new_without_default, reason = "a folder is made, which no default should do")]
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// One that holds `nodes` as scene.glb.
    pub fn with(nodes: &[Node]) -> Self {
        let workshop = Self::new();
        Model::of(nodes).write(&workshop.path("scene.glb"));
        workshop
    }

    /// A file or folder in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs one of our programs in the folder.
    pub fn run(&self, name: &str, arguments: &[&str]) -> Ended {
        let output = Command::new(program(name))
            .args(arguments)
            .current_dir(self.0.path())
            .timeout(PATIENCE)
            .output()
            .expect("the program runs");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// What the library is asked for by default: scene.glb in elements of a metre.
    pub fn job(&self, division: Division) -> Job {
        Job {
            scene: self.path("scene.glb"),
            cache: self.path("cache"),
            out: self.path("out"),
            preparation: Preparation {
                resolution: EXACT,
                element_size: Some(ElementSize::Metres(1.0)),
                division,
                local_solver: None,
            },
            method: Method::Auto,
            goal: Goal { error: 0.0, rounds: usize::MAX },
            exact_rows: ExactRows::About(256),
            explain: false,
            verify: false,
            warm: false,
            pictures: Pictures::Rounds,
            lightmaps: None,
            light_units: None,
            sky: None,
            points: None,
            shot: None,
            elements: None,
            depfile: None,
            cache_limit: None,
        }
    }

    /// All files below `name` by their paths.
    pub fn files(&self, name: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut files = BTreeMap::new();
        gather(&self.path(name), &mut files);
        files
    }
}

/// Assembles, and expects no error.
pub fn assembled(job: &Job) -> Report {
    run(job, &Monitor::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn gather(folder: &Path, files: &mut BTreeMap<PathBuf, Vec<u8>>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten() {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() {
            gather(&path, files);
        } else {
            let bytes = std::fs::read(&path).expect("a readable file");
            files.insert(path, bytes);
        }
    }
}
