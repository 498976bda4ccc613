//! A complete run: solves the scene, proves the error, writes the outputs and creates the report.

pub mod advice;
mod expected_work;
pub mod job;
pub mod plan;
#[cfg(feature = "cli")]
pub mod watch;

use crate::equation::Equation;
use crate::equation::observer::Observer;
use crate::exchange::listener::Unobserved;
use crate::exchange::system::InstanceSystem;
use crate::lightmap::atlas::Atlas;
use crate::outputs::{OutputRecord, RESULT, RunResults, write_all};
use crate::proof::audit::{Audit, audit};
use crate::proof::noise::{Noise, noise};
use crate::proof::sample::ExactRows;
use crate::proof::{Proof, prove};
use crate::report::Report;
use crate::report::fates::explained;
use crate::report::light_notes::light_notes;
use crate::report::process::{cpu_seconds, peak_rss};
use crate::report::summary::{HIDDEN_SHELLS, ReportSources, summary};
use crate::report::unlit::unlit_notes;
use crate::solve::settings::SolveSettings;
use crate::solve::{Solved, solve_prepared};
use crate::verify::{Classic, classic};
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::batch::damage_notes;
use equilux_bake::oven::depfile;
use equilux_bake::oven::prepare::{Prepared, lost_digits_note, prepare};
use equilux_formats::store::Evicted;
use equilux_formats::{Result, Scene, Store, unless_stopped};
use expected_work::expected_work;
use job::Job;
use std::path::Path;
use std::time::Instant;

/// Run the job. All outputs are written when this returns. Fails if the scene cannot be read or solved, or an output
/// cannot be written.
pub fn run(job: &Job, monitor: &Monitor) -> Result<Report> {
    run_observed(job, monitor, &Unobserved)
}

/// Like [`run`], reporting progress to `observer`.
pub fn run_observed(job: &Job, monitor: &Monitor, observer: &dyn Observer) -> Result<Report> {
    let start = Instant::now();
    let Job { settings, outputs: requests, .. } = job;
    let (scene, prepared) = opened(job)?;
    let atlas = requests.lightmaps.map(|options| Atlas::of(&scene, &options)).transpose()?;
    let (places, against) = job.tables(scene.origin)?;
    let environment = settings.environment()?;
    let store = Store::open(&settings.cache)?;
    let element_size = prepared.element_size.to_string();
    let places = places.as_deref();
    let elements = prepared.elements();
    monitor.expect(expected_work(requests, (elements, prepared.resolution), atlas.as_ref(), places));
    let solved = solve_prepared(&scene, prepared, &environment, settings, &store, monitor, observer)?;
    let (solve, solve_cpu) = (start.elapsed().as_secs_f64(), cpu_seconds());
    let (equation, outcome) = (&solved.equation, &solved.outcome);
    let (placed, systems) = (&equation.placed, equation.systems());
    let (proof, noise, audit) = errors(&solved, &systems, requests.exact_rows, monitor);
    let peak = peak_rss();
    let compare = || unless_stopped(classic(placed, &equation.driven_optics(), monitor));
    let classic = if requests.verify { compare()? } else { None };
    observer.settled(outcome, &solved.irradiance);

    let results = RunResults {
        solved: &solved,
        store: &store,
        classic: classic.as_ref(),
        atlas: atlas.as_ref(),
        places,
        against: against.as_ref(),
    };
    let OutputRecord { paths: outputs, notes, point_time, point_cpu } =
        write_all(requests, &scene, &results, monitor)?;
    if let Some(path) = &requests.depfile {
        depfile::write(path, &requests.folder.join(&scene.name).join(RESULT), &scene.sources)?;
    }
    let evicted = job.cache_limit.map(|bytes| store.limit(bytes)).transpose()?;
    let sources = ReportSources {
        equation,
        systems: &systems,
        outcome,
        proof: proof.as_ref(),
        noise: noise.as_ref(),
        audit,
        classic: classic.as_ref(),
    };
    let mut report = Report { scene: scene.name.clone(), element_size, outputs, ..summary(&sources) };
    report.blocks.leave_out(HIDDEN_SHELLS, scene.hidden_shells);
    report.bytes.peak_rss = peak;
    if requests.explain {
        report.explained = explained(placed, &equation.coupled);
    }
    (report.seconds.points, report.seconds.points_cpu) = (point_time.as_secs_f64(), point_cpu);
    (report.seconds.solve, report.seconds.solve_cpu) = (solve, solve_cpu);
    report.seconds.total = start.elapsed().as_secs_f64();
    let last = dropped_note(evicted).into_iter().chain(unverified_note(job, classic.as_ref())).collect();
    let lights = notes_on_lights(settings, &scene, equation, &systems);
    report.notes = [scene.notes, lights, damage_notes(&store), report.notes, notes, last].concat();
    Ok(report)
}

/// What is proved and measured of the error of clusters, or of rows by rays; `asked`: the rows to compare with exact ones.
fn errors(
    solved: &Solved,
    systems: &[InstanceSystem],
    asked: Option<ExactRows>,
    monitor: &Monitor,
) -> (Option<Proof>, Option<Noise>, Option<Audit>) {
    let equation = &solved.equation;
    let rows = asked.unwrap_or(ExactRows::ENOUGH);
    let proof = prove(&equation.placed, systems, &solved.outcome, rows, monitor);
    if rows.of(1) == 0 {
        return (proof, None, None);
    }
    let (radiosity, irradiance) = (solved.radiosity(), &solved.irradiance);
    let audit = asked.and_then(|rows| audit(equation, radiosity, irradiance, rows, monitor));
    (proof, noise(equation, radiosity, irradiance), audit)
}

/// The scene, and its parts divided into elements. Fails where the job is not possible.
fn opened(job: &Job) -> Result<(Scene, Prepared)> {
    let mut scene = import_scene(&job.scene)?;
    scene.sources.extend(job.beside().map(Path::to_path_buf));
    let prepared = prepare(&scene, &job.settings.preparation)?;
    scene.notes.extend(lost_digits_note(&scene, prepared.element_size));
    job.check(&scene)?;
    if prepared.resolution.rays.is_none() {
        // Exact rows know planes only.
        scene.flatten_normals();
    }
    Ok((scene, prepared))
}

/// Notes on the scene's lights, and on lamps that light nothing.
fn notes_on_lights(
    settings: &SolveSettings,
    scene: &Scene,
    equation: &Equation,
    systems: &[InstanceSystem],
) -> Vec<String> {
    let mut notes = light_notes(scene, settings.light_units, settings.sky.as_ref());
    notes.extend(unlit_notes(scene, &equation.direct.unlit, &equation.placed, systems));
    notes
}

fn unverified_note(job: &Job, classic: Option<&Classic>) -> Option<String> {
    (job.outputs.verify && classic.is_none())
        .then(|| "stopped: the classic matrix was not computed, so nothing was compared".to_owned())
}

fn dropped_note(evicted: Option<Evicted>) -> Option<String> {
    let Evicted { dropped, .. } = evicted.filter(|evicted| evicted.dropped.files > 0)?;
    Some(format!("files dropped from the cache: {}, of {} bytes", dropped.files, dropped.bytes))
}
