//! A temporary folder for tests: writes scenes, and runs the library or the programs on them.

use crate::model::{Model, Node};
use crate::program::program;
use assert_cmd::Command;
use equilux_assemble::outputs::requests::Pictures;
use equilux_assemble::report::Report;
use equilux_assemble::run::job::Job;
use equilux_assemble::run::run;
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod};
use equilux_bake::treecode::EXACT;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Timeout of programs: ten times what any of them takes.
const PATIENCE: Duration = Duration::from_secs(120);

/// The folder.
#[derive(Debug)]
pub struct Workshop(TempDir);

/// The result of a program.
#[derive(Debug)]
pub struct Ended {
    /// Its exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// Its standard output.
    pub stdout: String,
    /// Its standard error.
    pub stderr: String,
}

impl Workshop {
    /// An empty folder.
    #[expect(clippy::new_without_default, reason = "a folder is made, which no default should do")]
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// A folder with the scene `nodes` as scene.glb.
    pub fn with(nodes: &[Node]) -> Self {
        let workshop = Self::new();
        Model::of(nodes).write(&workshop.path("scene.glb"));
        workshop
    }

    /// The path of a file or folder in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs `bake` or `assemble` in the folder.
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

    /// The default job of tests: scene.glb with elements of a metre.
    pub fn job(&self, division: Division) -> Job {
        let mut job = Job::new(self.path("scene.glb"));
        job.settings.cache = self.path("cache");
        job.settings.preparation = Preparation {
            resolution: EXACT,
            element_size: Some(ElementSize::Metres(1.0)),
            division,
            rows: RowMethod::Exact,
            rays: 256,
            local_solver: None,
        };
        job.settings.goal.error = 0.0;
        job.outputs.folder = self.path("out");
        job.outputs.pictures = Pictures::Rounds;
        job
    }

    /// All files below `name` by their paths.
    pub fn files(&self, name: &str) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut files = BTreeMap::new();
        gather(&self.path(name), &mut files);
        files
    }
}

/// `job` after `change`.
pub fn changed(mut job: Job, change: impl FnOnce(&mut Job)) -> Job {
    change(&mut job);
    job
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
