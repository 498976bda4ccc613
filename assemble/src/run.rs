//! The whole run: scene → baked parts → coupling → exchange → outputs and report.

use crate::account::refuse_endless_light;
use crate::classic::{Classic, classic, whole};
use crate::direct::with_direct;
use crate::equation::Equation;
use crate::exchange::{Goal, Method, Node, Outcome, exchange_observed};
use crate::explain::explained;
use crate::gather::sky::Sky;
use crate::light_notes::light_notes;
use crate::lightmap::Wanted;
use crate::lightmap::atlas::Atlas;
use crate::observer::{Observer, Unobserved};
use crate::outputs::{Light, RESULT, Written, check_writable, write_all};
use crate::placed::Placed;
use crate::points::{self, Place};
use crate::proof::prove;
use crate::proof::sample::ExactRows;
use crate::render::{Reference, Shot};
use crate::report::summary::HIDDEN_SHELLS;
use crate::report::{Report, Run, cpu_seconds, peak_rss, summary};
use crate::unlit::unlit_notes;
use crate::warm::{keep, last_light};
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::batch::damage_notes;
use equilux_bake::oven::prepare::{Preparation, Prepared, lost_digits_note, prepare};
use equilux_bake::oven::{depfile, stamp};
use equilux_formats::{LightUnits, Result, Scene, Store, Swept};
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Which pictures are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pictures {
    /// Of the first eight rounds, of powers of two, of the end, and of the elements.
    Rounds,
    /// Of the end.
    Last,
    /// None.
    None,
}

/// What to assemble, and how.
#[derive(Debug, Clone)]
pub struct Job {
    /// The scene's file.
    pub scene: PathBuf,
    /// The cache folder.
    pub cache: PathBuf,
    /// The folder that gets `<scene>/` with all pictures.
    pub out: PathBuf,
    /// Elements, parts and local solvers.
    pub preparation: Preparation,
    /// How parts exchange light.
    pub method: Method,
    /// When the exchange ends.
    pub goal: Goal,
    /// How many receivers get exact rows to measure with what clusters cost.
    pub exact_rows: ExactRows,
    /// Whether to say of each part and block what became of it.
    pub explain: bool,
    /// Whether to solve the classic matrix too.
    pub verify: bool,
    /// Whether to start from the light of the last such run of the scene, and to keep this one's for the next.
    pub warm: bool,
    /// What the intensities of the file's lights mean; none for what each file suggests.
    pub light_units: Option<LightUnits>,
    /// What shines from all around; none for darkness.
    pub sky: Option<Sky>,
    /// Which rounds get pictures.
    pub pictures: Pictures,
    /// A picture to draw besides; none for none.
    pub shot: Option<Shot>,
    /// Which lightmaps to write; none to write none.
    pub lightmaps: Option<Wanted>,
    /// A table of places of which to tell the light; none to tell none.
    pub points: Option<PathBuf>,
    /// Where to write the table of elements.
    pub elements: Option<PathBuf>,
    /// Where to write for build tools which files were read.
    pub depfile: Option<PathBuf>,
    /// How many bytes the cache may have in the end; none to let it grow.
    pub cache_limit: Option<u64>,
}

impl Job {
    /// The files that are read beside those of the scene.
    pub fn beside(&self) -> impl Iterator<Item = &Path> {
        let sky = self.sky.as_ref().and_then(Sky::file);
        let against = self.shot.as_ref().and_then(|shot| shot.against.as_deref());
        [sky, self.points.as_deref(), against].into_iter().flatten()
    }

    /// Fail where outputs could not be written or nothing could be seen, before hours are spent on them.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        check_writable(self, scene)?;
        self.depfile.as_deref().map(stamp::check).transpose()?;
        self.shot.as_ref().map_or(Ok(()), |shot| shot.check(&scene.cameras, &self.scene))
    }

    /// The places to tell the light of and the light to compare with, where they are asked for, in scene coordinates, which
    /// begin at `origin` in those of the tables.
    pub fn tables(&self, origin: DVec3) -> Result<(Option<Vec<Place>>, Option<Reference>)> {
        let against = self.shot.as_ref().and_then(|shot| shot.against.as_deref());
        let places = self.points.as_deref().map(|file| points::read(file, origin)).transpose()?;
        Ok((places, against.map(|file| Reference::read(file, origin)).transpose()?))
    }
}

/// Run the job; everything is written when this returns.
pub fn run(job: &Job, monitor: &Monitor) -> Result<Report> {
    run_observed(job, monitor, &Unobserved)
}

/// The same with somebody who sees it go on.
pub fn run_observed(job: &Job, monitor: &Monitor, observer: &dyn Observer) -> Result<Report> {
    let start = Instant::now();
    let (scene, prepared) = opened(job)?;
    let atlas = job.lightmaps.map(|wanted| Atlas::new(&scene, wanted.texel_size)).transpose()?;
    let (places, against) = job.tables(scene.origin)?;
    let sky = job.sky.as_ref().map(Sky::read).transpose()?;
    let store = Store::open(&job.cache)?;
    let element_size = prepared.element_size.to_string();
    let equation = Equation::of(job, &scene, sky.as_ref(), prepared, &store, monitor, observer)?;
    let nodes = equation.nodes();
    let Equation { placed, coupled, optics, direct, .. } = &equation;
    refuse_endless_light(placed, &nodes, &whole(&equation.driven), &job.scene)?;
    observer.coupled_all(placed, coupled, optics);
    let mut outcome = exchanged(job, placed, &nodes, &store, monitor, observer)?;
    let (solve, solve_cpu) = (start.elapsed().as_secs_f64(), cpu_seconds());
    let proof = prove(placed, &nodes, &outcome, job.exact_rows, monitor);
    let peak = peak_rss();
    let classic = if job.verify { classic(placed, &whole(&equation.driven), monitor) } else { None };
    with_direct(&mut outcome.irradiance, &direct.irradiance);
    observer.settled(&outcome);

    let light = Light {
        equation: &equation,
        outcome: &outcome,
        classic: classic.as_ref(),
        atlas: atlas.as_ref(),
        places: places.as_deref(),
        against: against.as_ref(),
    };
    let Written { paths: outputs, notes, point_time } = write_all(job, &scene, &light, monitor)?;
    if let Some(path) = &job.depfile {
        depfile::write(path, &job.out.join(&scene.name).join(RESULT), &scene.sources)?;
    }
    let swept = job.cache_limit.map(|bytes| store.limit(bytes)).transpose()?;
    let run = Run {
        placed,
        coupled,
        nodes: &nodes,
        optics,
        outcome: &outcome,
        proof: proof.as_ref(),
        classic: classic.as_ref(),
    };
    let mut report = Report { scene: scene.name.clone(), element_size, outputs, ..summary(&run) };
    report.blocks.leave_out(HIDDEN_SHELLS, scene.hidden_shells);
    report.bytes.peak_rss = peak;
    report.form_factors_computed += direct.computed;
    if job.explain {
        report.explained = explained(placed, coupled);
    }
    report.seconds.points = point_time.as_secs_f64();
    (report.seconds.solve, report.seconds.solve_cpu) = (solve, solve_cpu);
    report.seconds.total = start.elapsed().as_secs_f64();
    let last = dropped_note(swept).into_iter().chain(unverified_note(job, classic.as_ref())).collect();
    let lights = [
        light_notes(&scene, job.light_units, job.sky.as_ref()),
        unlit_notes(&scene, &direct.unlit, placed, &nodes),
    ]
    .concat();
    report.notes = [scene.notes, lights, damage_notes(&store), report.notes, notes, last].concat();
    Ok(report)
}

/// The scene and its parts with elements. Fails where the job could not be done.
fn opened(job: &Job) -> Result<(Scene, Prepared)> {
    let mut scene = import_scene(&job.scene)?;
    scene.sources.extend(job.beside().map(Path::to_path_buf));
    let prepared = prepare(&scene, &job.preparation)?;
    scene.notes.extend(lost_digits_note(&scene, prepared.element_size));
    job.check(&scene)?;
    Ok((scene, prepared))
}

/// The light of the scene; from the last run's, and kept for the next, if that is asked for.
fn exchanged(
    job: &Job,
    placed: &Placed,
    nodes: &[Node],
    store: &Store,
    monitor: &Monitor,
    observer: &dyn Observer,
) -> Result<Outcome> {
    let start = if job.warm { last_light(placed, store, &job.scene) } else { None };
    let outcome = exchange_observed(nodes, job.method, job.goal, start.as_deref(), monitor, observer);
    if job.warm {
        keep(placed, store, &job.scene, &outcome.radiosity)?;
    }
    Ok(outcome)
}

fn unverified_note(job: &Job, classic: Option<&Classic>) -> Option<String> {
    (job.verify && classic.is_none())
        .then(|| "stopped: the classic matrix was not computed, so nothing was compared".to_owned())
}

fn dropped_note(swept: Option<Swept>) -> Option<String> {
    let Swept { dropped, .. } = swept.filter(|swept| swept.dropped.files > 0)?;
    Some(format!("files dropped from the cache: {}, of {} bytes", dropped.files, dropped.bytes))
}
