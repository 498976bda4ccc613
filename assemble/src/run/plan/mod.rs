//! A dry run: the code of a run with a monitor that is already stopped. It finds what the cache holds, and computes
//! nothing. Input: a [`Job`]. Output: a [`Plan`].

mod exchange;
pub mod text;
mod unseen;

use crate::equation::coupling::{Coupler, ForeseenBlocks};
use crate::equation::intruders::intruders;
use crate::outputs::check_writable;
use crate::placed_parts::PlacedParts;
use crate::report::fates::{Fate, InstanceFate, PartFate};
use crate::report::light_notes::light_notes;
use crate::report::summary::{BLACK_ROWS, HIDDEN_SHELLS, SHARED, UNSEEN};
use crate::run::job::Job;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::batch::damage_notes;
use equilux_bake::oven::cached::Origin;
use equilux_bake::oven::prepare::{Prepared, PreparedPart, lost_digits_note, prepare};
use equilux_bake::oven::{Baked, Oven};
use equilux_bake::world::World;
use equilux_formats::{Instance, Result, Store, unless_stopped};
use serde::Serialize;
use std::collections::BTreeMap;
use unseen::unseen_pairs;

/// Planned, reused and skipped work, as `--json` prints it.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// The scene's name.
    pub scene: String,
    /// Number of elements in the scene.
    pub elements: usize,
    /// Element size in force, as text.
    pub element_size: String,
    /// Accuracy and storage of form factors, as text.
    pub resolution: String,
    /// How rows are computed, and why.
    pub rows: String,
    /// The distinct parts.
    pub parts: Vec<PartFate>,
    /// The instances.
    pub instances: Vec<InstanceFate>,
    /// Pairs of instances whose faces cannot see each other, whatever stands between them; walls may hide more pairs.
    pub unseen: Vec<[String; 2]>,
    /// The exchange method and the reason for it, as text.
    pub exchange: String,
    /// Minimum amount of work that would be skipped because it changes no radiosity, by reason.
    pub left_out: BTreeMap<String, usize>,
    /// Size of the classic matrix of all pairs of elements in f64, bytes.
    pub classic_matrix_bytes: usize,
    /// Notes on ignored, dropped or damaged input, one sentence each.
    pub notes: Vec<String>,
}

/// The plan of a job. Computes no form factors. Parts whose form factors are in the cache are updated there: their
/// local equilibrium with a new paint is solved now instead of in the run. Fails where the job would.
pub fn plan(job: &Job) -> Result<Plan> {
    let mut scene = import_scene(&job.scene)?;
    let prepared = prepare(&scene, &job.settings.preparation)?;
    scene.notes.extend(lost_digits_note(&scene, prepared.element_size));
    check_writable(&job.outputs, &scene)?;
    let store = Store::open(&job.settings.cache)?;
    let lights = light_notes(&scene, job.settings.light_units, job.settings.sky.as_ref());
    let stopped = Monitor::default();
    stopped.stop();
    let resolution = prepared.resolution;
    let oven = Oven { store: &store, file: &job.scene, resolution, monitor: &stopped };
    let baked =
        prepared.parts.iter().map(|part| unless_stopped(oven.bake(part))).collect::<Result<Vec<_>>>()?;

    let placed = |i: &Instance| (&prepared.parts[i.part.index()].geometry, i.placement);
    let world = World::new(prepared.instances.iter().map(placed));
    let unseen = unseen_pairs(&world);
    let name = |k: usize| prepared.instances[k].name.clone();
    Ok(Plan {
        scene: scene.name,
        elements: world.elements.len(),
        element_size: prepared.element_size.to_string(),
        resolution: resolution.to_string(),
        rows: job.settings.preparation.rows_text(),
        parts: planned_parts(&prepared, &baked, |part| oven.foresee(part)),
        unseen: unseen.iter().map(|pair| pair.map(name)).collect(),
        exchange: exchange::planned(&job.settings, &prepared, &baked),
        left_out: left_out(&prepared, unseen.len(), scene.hidden_shells),
        classic_matrix_bytes: world.elements.len().pow(2) * size_of::<f64>(),
        instances: planned_instances(&prepared, baked, |placed| {
            let coupler = Coupler::new(&oven, placed);
            (0..placed.instances.len()).map(|k| coupler.foresee(k)).collect()
        }),
        notes: [scene.notes, lights, damage_notes(&store)].concat(),
    })
}

fn planned_parts(
    prepared: &Prepared,
    baked: &[Option<Baked>],
    foresee: impl Fn(&PreparedPart) -> Origin,
) -> Vec<PartFate> {
    let planned = |(number, (part, baked)): (usize, (&PreparedPart, &Option<Baked>))| PartFate {
        name: part.name.clone(),
        elements: part.geometry.elements.len(),
        places: prepared.instances.iter().filter(|instance| instance.part.index() == number).count(),
        form_factors: Fate::of(&baked.as_ref().map_or_else(|| foresee(part), |b| b.form_factors.clone())),
        light: None,
        local_solver: format!("{:?}", part.solver),
    };
    prepared.parts.iter().zip(baked).enumerate().map(planned).collect()
}

/// The result of `foresee` for the placed parts, if all of them are in the cache. Without the parts, the keys of
/// couplings are unknown, and every block is computed.
fn planned_instances(
    prepared: &Prepared,
    baked: Vec<Option<Baked>>,
    foresee: impl FnOnce(&PlacedParts) -> Vec<ForeseenBlocks>,
) -> Vec<InstanceFate> {
    let foreseen = match baked.into_iter().collect::<Option<Vec<Baked>>>() {
        Some(parts) => foresee(&PlacedParts::new(parts, prepared.instances.clone())),
        None => all_computed(prepared),
    };
    let planned = |(instance, foreseen): (&Instance, ForeseenBlocks)| InstanceFate {
        name: instance.name.clone(),
        part: prepared.parts[instance.part.index()].name.clone(),
        corrected: foreseen.corrected.as_ref().map(Fate::of),
        coupling: Fate::of(&foreseen.coupling),
        intruders: foreseen.intruders.iter().map(|&k| prepared.instances[k].name.clone()).collect(),
    };
    prepared.instances.iter().zip(foreseen).map(planned).collect()
}

/// All blocks of all instances would be computed.
fn all_computed(prepared: &Prepared) -> Vec<ForeseenBlocks> {
    let geometry = |k: usize| &prepared.parts[prepared.instances[k].part.index()].geometry;
    let computed = || Origin::Computed("not all parts are in the cache".into());
    let of = |k: usize| {
        let intruders = intruders(&prepared.instances, geometry, k);
        ForeseenBlocks { corrected: (!intruders.is_empty()).then(computed), coupling: computed(), intruders }
    };
    (0..prepared.instances.len()).map(of).collect()
}

/// The counts of skipped work that are known without form factors.
fn left_out(prepared: &Prepared, unseen: usize, hidden_shells: usize) -> BTreeMap<String, usize> {
    let parts = || prepared.instances.iter().map(|instance| &prepared.parts[instance.part.index()]);
    let black = |part: &PreparedPart| part.optics.reflectance.iter().filter(|&&rho| rho == [0.0; 3]).count();
    let counts = [
        // A pair has two couplings.
        (UNSEEN, 2 * unseen),
        (BLACK_ROWS, parts().map(black).sum()),
        (SHARED, prepared.instances.len() - prepared.parts.len()),
        (HIDDEN_SHELLS, hidden_shells),
    ];
    counts.into_iter().filter(|&(_, count)| count > 0).map(|(what, count)| (what.into(), count)).collect()
}
