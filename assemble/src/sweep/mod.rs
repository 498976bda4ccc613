//! Error against run time: runs a grid of settings on a scene, each in a process of its own and all within a budget of
//! time, and compares their light at points with a reference. Writes `sweep.csv`, `sweep.json` and `report.html`. Completed
//! runs are kept, so a sweep that was stopped continues where it ended.

mod errors;
mod findings;
mod folder;
mod forecast;
pub mod front;
mod grid;
pub(crate) mod numbers;
mod page;
pub mod points;
mod process;
mod reference;
mod row;
mod run;
mod separation;
mod setting;
pub mod summary;
mod table;
mod trials;

use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_formats::Result;
use folder::{alone, identity, own_points, write};
use process::Runner;
use reference::Reference;
use row::Compared;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use summary::{Found, Summary};
use trials::{Trials, default_size};

/// The scene of a sweep, and its budget.
#[derive(Debug, Clone)]
pub struct Options {
    /// The scene's file.
    pub scene: PathBuf,
    /// A table of its light from elsewhere; none to take the finest run as the reference.
    pub truth: Option<PathBuf>,
    /// The time that all runs together may take.
    pub budget: Duration,
    /// The folder that gets `<scene>/sweep/`.
    pub out: PathBuf,
    /// Options for every run.
    pub more: Vec<String>,
}

/// Run the sweep and write its files. When the monitor is stopped, the completed runs are reported. Fails if the scene or the
/// truth cannot be read, if no run is complete, or if files cannot be written.
pub fn sweep(options: &Options, monitor: &Monitor) -> Result<Summary> {
    let start = Instant::now();
    let scene = import_scene(&options.scene)?;
    let truth = options.truth.as_deref().map(Reference::read).transpose()?;
    let folder = options.out.join(&scene.name).join("sweep");
    let _lock = alone(&folder)?;
    let points = match &options.truth {
        Some(path) => path.clone(),
        None => own_points(&scene, &folder)?,
    };
    let size = default_size(&scene)?;
    let (program, content) = identity(&scene, &points)?;
    let runner = Runner {
        program,
        scene: &options.scene,
        points,
        more: &options.more,
        folder: &folder,
        content,
        deadline: start + options.budget,
        monitor,
    };
    let mut trials = Trials::new(runner, &scene, start, options.budget);
    let (reference, compared) = match truth {
        Some(truth) => {
            let compared = Compared::with_file(options.truth.as_deref(), &truth);
            (truth, compared)
        }
        None => trials.find_reference(size)?,
    };
    trials.try_all(size)?;
    let found = Found {
        scene: &scene.name,
        size,
        runs: &trials.done,
        reused: trials.reused,
        skipped: &trials.skipped,
        seconds: start.elapsed().as_secs_f64(),
        commands: &|setting| trials.runner.command(setting),
    };
    let summary = Summary::of(&found, &reference, compared);
    write(&folder, &summary)?;
    Ok(summary)
}
