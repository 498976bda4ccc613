//! Error against run time: a grid of settings, each run in a process of its own within a budget of time, compared at points
//! with a reference. In goes a scene; out come `sweep.csv`, `sweep.json` and `report.html`. What was run is kept, so that a
//! sweep that was stopped goes on where it was.

pub mod cli;
mod errors;
mod findings;
mod folder;
mod forecast;
pub mod front;
mod grid;
mod page;
pub mod points;
mod process;
mod reference;
mod run;
mod separation;
mod setting;
mod summary;
mod table;

use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Division, Preparation, prepare};
use equilux_bake::treecode::EXACT;
use equilux_formats::{Error, Result, Scene};
use folder::{alone, identity, own_points, write};
use forecast::{forecast, matrix_bytes, memory_available};
use grid::{SIZES, grid, metres};
use process::{Ended, Runner};
use reference::Reference;
use run::Run;
use setting::{Kind, Setting};
use std::path::PathBuf;
use std::time::{Duration, Instant};
pub use summary::{Row, Summary};

/// The share of the budget that may go into a reference.
const FOR_REFERENCE: f64 = 1.0 / 3.0;

/// The share of the memory available that a matrix may take.
const FOR_MATRIX: f64 = 0.5;

/// The share of the budget that one classic run may take: they are there to compare with.
const FOR_CLASSIC: f64 = 0.05;

/// What to sweep.
#[derive(Debug, Clone)]
pub struct Options {
    /// The scene's file.
    pub scene: PathBuf,
    /// The light it should have; none to compute it.
    pub truth: Option<PathBuf>,
    /// No run begins that would end later than this.
    pub budget: Duration,
    /// The folder that gets `<scene>/sweep/`.
    pub out: PathBuf,
    /// Options for every run.
    pub more: Vec<String>,
}

/// A setting that was not run.
#[derive(Debug, Clone)]
pub struct Skipped {
    /// The setting.
    setting: Setting,
    /// Why not.
    why: String,
}

/// A sweep on its way.
struct Sweep<'a> {
    runner: Runner<'a>,
    scene: &'a Scene,
    monitor: &'a Monitor,
    start: Instant,
    budget: Duration,
    done: Vec<Run>,
    /// How many of these were there already.
    reused: usize,
    skipped: Vec<Skipped>,
    /// How many elements of a size, metres, the scene has.
    counted: Vec<(f64, usize)>,
}

/// Run the sweep and write everything. When the monitor is stopped, what is there is written.
pub fn sweep(options: &Options, monitor: &Monitor) -> Result<Summary> {
    let start = Instant::now();
    let scene = import_scene(&options.scene)?;
    let truth = options.truth.as_deref().map(Reference::read).transpose()?;
    let folder = options.out.join(&scene.name).join("sweep");
    let _alone = alone(&folder)?;
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
    let budget = options.budget;
    let mut sweep = Sweep {
        runner,
        scene: &scene,
        monitor,
        start,
        budget,
        done: vec![],
        reused: 0,
        skipped: vec![],
        counted: vec![],
    };
    let (reference, compared) = match truth {
        Some(truth) => {
            let compared = summary::Compared::with_file(options.truth.as_deref(), &truth);
            (truth, compared)
        }
        None => sweep.find_reference(size)?,
    };
    sweep.try_all(size)?;
    let found = summary::Found {
        scene: &scene.name,
        size,
        runs: &sweep.done,
        reused: sweep.reused,
        skipped: &sweep.skipped,
        seconds: start.elapsed().as_secs_f64(),
        commands: &|setting| sweep.runner.command(setting),
    };
    let summary = Summary::of(&found, &reference, compared);
    write(&folder, &summary)?;
    Ok(summary)
}

impl Sweep<'_> {
    /// The light that the finest exact run gathers, which takes no more than its share of the budget.
    fn find_reference(&mut self, size: f64) -> Result<(Reference, summary::Compared)> {
        let mut ladder: Vec<Run> = vec![];
        for factor in SIZES.into_iter().chain([0.25]) {
            let setting = Setting::new(Kind::Parts { tolerance: 0.0 }, metres(size * factor));
            let may_take = self.budget.mul_f64(FOR_REFERENCE).saturating_sub(self.start.elapsed());
            match self.attempt(&setting, may_take)? {
                Some(run) => ladder.push(run),
                None => break,
            }
        }
        let Some(finest) = ladder.last() else {
            let (found, remedy) = match self.skipped.first() {
                Some(skipped) => (
                    format!("no run ended, the first because {}", skipped.why),
                    "give more time with --budget SECONDS, or a reference with --truth FILE.csv",
                ),
                None => {
                    ("stopped before the first run was complete".to_owned(), "run the same command again")
                }
            };
            return Err(Error::new(&self.scene.file, found, "at least one run to compare with", remedy));
        };
        self.skipped.clear();
        let reference = Reference::of(finest);
        let coarser = ladder.len().checked_sub(2).map(|k| &ladder[k]);
        Ok((reference.clone(), summary::Compared::with_run(finest, coarser, &reference)))
    }

    /// Run all settings that the time is enough for.
    fn try_all(&mut self, size: f64) -> Result<()> {
        for setting in grid(size) {
            if self.monitor.stopped() {
                break;
            }
            if self.done.iter().any(|run| run.setting == setting) {
                continue;
            }
            let left = self.budget.saturating_sub(self.start.elapsed());
            let most = if setting.is_classic() { self.budget.mul_f64(FOR_CLASSIC) } else { left };
            self.attempt(&setting, left.min(most))?;
        }
        Ok(())
    }

    /// The run of a setting, from before or now, if it can be expected to take no more than `may_take`.
    fn attempt(&mut self, setting: &Setting, may_take: Duration) -> Result<Option<Run>> {
        if let Some(run) = self.runner.kept(setting) {
            self.reused += 1;
            self.done.push(run.clone());
            return Ok(Some(run));
        }
        let elements = self.count(setting.element_size)?;
        let seconds = forecast(setting, elements, &self.done);
        if seconds > may_take.as_secs_f64() {
            self.skip(
                setting,
                format!("it would take about {seconds:.1} s, and may take {:.1} s", may_take.as_secs_f64()),
            );
            return Ok(None);
        }
        let bytes = matrix_bytes(setting.kind, elements).unwrap_or(0.0);
        if memory_available().is_some_and(|available| bytes > FOR_MATRIX * available) {
            self.skip(
                setting,
                format!("its matrix takes {:.1} GB, more than memory should be filled with", bytes / 1e9),
            );
            return Ok(None);
        }
        let left = self.budget.saturating_sub(self.start.elapsed()).as_secs();
        let what = format!("run {} ({}), {left} s left", self.done.len() + 1, setting.label());
        self.monitor.begin(what, (seconds * 10.0).ceil() as usize);
        match self.runner.run(setting)? {
            Ended::Done(run) => {
                self.done.push((*run).clone());
                return Ok(Some(*run));
            }
            Ended::Failed(said) => self.skip(setting, format!("it failed: {said}")),
            Ended::TimeUp => self.skip(setting, "the time was up before it ended".into()),
            Ended::Stopped => {}
        }
        Ok(None)
    }

    /// How many elements of that size, metres, the scene has.
    fn count(&mut self, size: f64) -> Result<usize> {
        if let Some((_, elements)) = self.counted.iter().find(|(known, _)| *known == size) {
            return Ok(*elements);
        }
        let elements = elements_of(self.scene, size)?;
        self.counted.push((size, elements));
        Ok(elements)
    }

    fn skip(&mut self, setting: &Setting, why: String) {
        self.skipped.push(Skipped { setting: setting.clone(), why });
    }
}

fn preparation(element_size: Option<ElementSize>) -> Preparation {
    Preparation { element_size, division: Division::Authored, resolution: EXACT, local_solver: None }
}

/// The element size that the scene gets when nobody says otherwise, metres.
fn default_size(scene: &Scene) -> Result<f64> {
    match prepare(scene, &preparation(None))?.element_size {
        ElementSize::Metres(size) => Ok(size),
        ElementSize::Mesh => Ok(1.0),
    }
}

/// How many elements of that size the scene has.
fn elements_of(scene: &Scene, size: f64) -> Result<usize> {
    let prepared = prepare(scene, &preparation(Some(ElementSize::Metres(size))))?;
    Ok(prepared.instances.iter().map(|i| prepared.parts[i.part.index()].geometry.elements.len()).sum())
}
