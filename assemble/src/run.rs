//! The whole run: scene → baked parts → coupling → exchange → outputs and report.

use crate::account::{energy, refuse_endless_light, row_sum_defect};
use crate::classic::{Classic, classic, largest_difference, mean_difference, whole_optics};
use crate::coupling::{Coupled, Coupler};
use crate::exchange::{Goal, Method, Node, Outcome, exchange, nodes};
use crate::outputs::{Light, check_writable, write_all};
use crate::placed::Placed;
use crate::report::{Blocks, Bytes, PartReport, Report, RoundReport, Verify, peak_rss};
use crate::steps::seconds;
use equilux_bake::batch::damage_notes;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::{Baked, Oven};
use equilux_bake::prepare::{Preparation, Prepared, prepare};
use equilux_formats::{Error, Optics, Result, Store};
use std::path::PathBuf;
use std::time::Instant;

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
    /// Whether to solve the classic matrix too.
    pub verify: bool,
    /// Where to write the table of elements.
    pub elements: Option<PathBuf>,
}

/// Run the job; everything is written when this returns.
pub fn run(job: &Job, monitor: &Monitor) -> Result<Report> {
    let start = Instant::now();
    let scene = import_scene(&job.scene)?;
    let prepared = prepare(&scene, &job.preparation)?;
    check_writable(job, &scene)?;
    let store = Store::open(&job.cache)?;
    let stopped = || {
        let remedy = "run the same command again: what was finished is in the cache";
        Error::new(&job.scene, "stopped before the form factors were complete", "a complete run", remedy)
    };
    let element_size = prepared.element_size.to_string();
    let placed = bake_parts(job, prepared, &store, monitor)?.ok_or_else(stopped)?;
    let coupled = couple(job, &placed, &store, monitor)?.ok_or_else(stopped)?;

    let each: Vec<Optics> = (0..placed.instances.len()).map(|k| placed.optics_of(k)).collect();
    let optics = whole_optics(&placed);
    let nodes = nodes(&placed, &coupled, &each);
    refuse_endless_light(&placed, &nodes, &optics, &job.scene)?;
    let outcome = exchange(&nodes, job.method, job.goal, monitor);
    let peak = peak_rss();
    let classic = if job.verify { classic(&placed, monitor) } else { None };

    let light = Light { placed: &placed, optics: &optics, outcome: &outcome, classic: classic.as_ref() };
    let outputs = write_all(job, &scene, &light, monitor)?;
    let mut report = report(&placed, &coupled, &nodes, &outcome, &optics);
    report.scene = scene.name.clone();
    report.element_size = element_size;
    report.bytes.peak_rss = peak;
    report.seconds.total = start.elapsed().as_secs_f64();
    let left_undone = job.verify && classic.is_none();
    report.verify = classic.map(|c| verification(&placed, &c, &outcome));
    report.notes = [scene.notes, damage_notes(&store), intruder_notes(&placed, &coupled)].concat();
    if left_undone {
        report.notes.push("stopped: the classic matrix was not computed, so nothing was compared".into());
    }
    report.outputs = outputs;
    Ok(report)
}

fn bake_parts(job: &Job, prepared: Prepared, store: &Store, monitor: &Monitor) -> Result<Option<Placed>> {
    let resolution = job.preparation.resolution;
    let oven = Oven { store, file: &job.scene, resolution, monitor };
    let mut parts: Vec<Baked> = Vec::new();
    for part in &prepared.parts {
        let Some(baked) = oven.bake(part)? else { return Ok(None) };
        parts.push(baked);
    }
    Ok(Some(Placed::new(parts, prepared.instances)))
}

fn couple(job: &Job, placed: &Placed, store: &Store, monitor: &Monitor) -> Result<Option<Vec<Coupled>>> {
    let resolution = job.preparation.resolution;
    let coupler = Coupler { placed, store, file: &job.scene, resolution, monitor };
    (0..placed.instances.len()).map(|k| coupler.couple(k)).collect()
}

fn report(
    placed: &Placed,
    coupled: &[Coupled],
    nodes: &[Node],
    outcome: &Outcome,
    optics: &Optics,
) -> Report {
    let elements = placed.world.elements.len();
    Report {
        scene: String::new(),
        elements,
        parts: placed.parts.iter().map(part_report).collect(),
        instances: placed.instances.len(),
        element_size: String::new(),
        blocks: blocks(placed, coupled),
        form_factors_computed: form_factors_computed(placed, coupled),
        seconds: seconds(placed, coupled, &outcome.times),
        rounds: outcome.rounds.iter().map(round_report).collect(),
        converged: outcome.converged,
        bytes: memory(nodes, elements),
        energy: energy(placed, optics, &outcome.radiosity, &outcome.irradiance),
        row_sum_defect: row_sum_defect(nodes),
        verify: None,
        notes: vec![],
        outputs: vec![],
    }
}

fn part_report(baked: &Baked) -> PartReport {
    PartReport {
        name: baked.part.name.clone(),
        elements: baked.part.geometry.elements.len(),
        form_factors: if baked.form_factors.is_reused() { "reused" } else { "computed" },
        reason: baked.form_factors.to_string(),
        local_solver: format!("{:?}", baked.part.local.solver),
        stored: baked.part.self_block.stored(),
    }
}

fn round_report(round: &crate::exchange::Round) -> RoundReport {
    RoundReport {
        round: round.number,
        residual: round.residual,
        error_bound: round.error_bound,
        compression: round.compression,
        relative_bound: round.relative_bound,
        seconds: round.time.as_secs_f64(),
    }
}

fn blocks(placed: &Placed, coupled: &[Coupled]) -> Blocks {
    let baked = placed.parts.iter().filter(|part| !part.form_factors.is_reused()).count();
    let corrected = coupled.iter().filter(|c| c.corrected.is_some()).count();
    let mut blocks = Blocks {
        self_baked: baked,
        self_reused: placed.instances.len().saturating_sub(baked + corrected),
        self_corrected: corrected,
        ..Blocks::default()
    };
    let mut unseen = 0;
    for (k, own) in coupled.iter().enumerate() {
        let seen = seen_instances(placed, own);
        unseen += placed.instances.len() - 1 - seen.iter().enumerate().filter(|&(l, s)| *s && l != k).count();
        let seen = seen.iter().filter(|&&s| s).count();
        if own.origin.is_reused() { blocks.coupling_reused += seen } else { blocks.coupling_computed += seen }
    }
    if unseen > 0 {
        blocks.coupling_left_out.insert("the parts cannot see each other".into(), unseen);
    }
    blocks
}

/// Which instances a block's receivers see anything of.
fn seen_instances(placed: &Placed, coupled: &Coupled) -> Vec<bool> {
    let mut seen = vec![false; placed.instances.len()];
    let of: Vec<usize> =
        (0..seen.len()).flat_map(|l| std::iter::repeat_n(l, placed.world.nodes_of(l).len())).collect();
    for receiver in 0..coupled.coupling.receivers() {
        coupled.coupling.row(receiver).for_each(|(sender, _)| seen[of[sender]] = true);
    }
    seen
}

fn form_factors_computed(placed: &Placed, coupled: &[Coupled]) -> usize {
    let own = placed.parts.iter().filter(|p| !p.form_factors.is_reused()).map(|p| p.part.self_block.stored());
    let corrected = coupled.iter().filter_map(|c| c.corrected.as_ref());
    let anew = corrected.filter(|c| !c.origin.is_reused()).map(|c| c.self_block.stored());
    let coupling = coupled.iter().filter(|c| !c.origin.is_reused()).map(|c| c.coupling.stored());
    own.chain(anew).chain(coupling).sum()
}

fn memory(nodes: &[Node], elements: usize) -> Bytes {
    let sizes = || nodes.iter().flat_map(|n| [n.self_block.bytes(), n.coupling.bytes()]);
    Bytes {
        dense: elements * elements * size_of::<f64>(),
        stored: sizes().sum(),
        largest_block: sizes().max().unwrap_or(0),
        peak_rss: None,
    }
}

fn verification(placed: &Placed, classic: &Classic, outcome: &Outcome) -> Verify {
    let pairs = outcome.radiosity.iter().flatten().zip(classic.radiosity.iter().flatten());
    Verify {
        max_rel_diff: largest_difference(&outcome.radiosity, &classic.radiosity),
        rms_rel_diff: mean_difference(placed, &outcome.radiosity, &classic.radiosity),
        max_abs_diff: pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
        form_factor_seconds: classic.form_factor_time.as_secs_f64(),
        solve_seconds: classic.solve_time.as_secs_f64(),
        matrix_bytes: classic.matrix.bytes(),
        peak_rss: peak_rss(),
    }
}

fn intruder_notes(placed: &Placed, coupled: &[Coupled]) -> Vec<String> {
    let name = |k: usize| format!("`{}`", placed.instances[k].name);
    let note = |(k, own): (usize, &Coupled)| {
        let corrected = own.corrected.as_ref()?;
        let inside: Vec<String> = corrected.intruders.iter().map(|&i| name(i)).collect();
        let how =
            if corrected.origin.is_reused() { "taken corrected from the cache" } else { "computed anew" };
        Some(format!("inside {} is {}: its own block was {how}", name(k), inside.join(", ")))
    };
    coupled.iter().enumerate().filter_map(note).collect()
}
