//! What a run would do, before a form factor is computed: the run itself with a monitor that is stopped. What the cache
//! has, the run's own code finds there; what it has not is not made. A [`Job`] becomes a [`Plan`].

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

/// What would be computed, reused and left out, as `--json` prints it.
#[derive(Debug, Clone, Serialize)]
pub struct Plan {
    /// The scene's name.
    pub scene: String,
    /// Number of elements in the scene.
    pub elements: usize,
    /// Element size in force, for a person.
    pub element_size: String,
    /// How form factors are kept, for a person.
    pub resolution: String,
    /// The distinct parts.
    pub parts: Vec<PartFate>,
    /// The parts in their places.
    pub instances: Vec<InstanceFate>,
    /// Pairs of instances whose faces cannot see each other whatever stands between; walls may hide more.
    pub unseen: Vec<[String; 2]>,
    /// How parts would exchange light, and why, for a person.
    pub exchange: String,
    /// What would be left out because it changes no radiosity, and how often at least, by reason.
    pub left_out: BTreeMap<String, usize>,
    /// Bytes of the classic matrix in f64: every element with every other.
    pub classic_matrix_bytes: usize,
    /// What was ignored, dropped or found damaged, one sentence each.
    pub notes: Vec<String>,
}

/// What the job would do. Computes no form factor. Parts whose form factors are in the cache are brought up to date
/// there: a new paint is solved now instead of by the run.
pub fn plan(job: &Job) -> Result<Plan> {
    let mut scene = import_scene(&job.scene)?;
    let prepared = prepare(&scene, &job.settings.preparation)?;
    scene.notes.extend(lost_digits_note(&scene, prepared.element_size));
    check_writable(&job.outputs, &scene)?;
    let store = Store::open(&job.settings.cache)?;
    let lights = light_notes(&scene, job.settings.light_units, job.settings.sky.as_ref());
    let stopped = Monitor::default();
    stopped.stop();
    let resolution = job.settings.preparation.resolution;
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
        parts: planned_parts(&prepared, &baked, |part| oven.foresee(part)),
        unseen: unseen.iter().map(|pair| pair.map(name)).collect(),
        exchange: exchange::planned(&job.settings, &prepared, &baked),
        left_out: left_out(&prepared, unseen.len(), scene.hidden_shells),
        classic_matrix_bytes: world.elements.len().pow(2) * size_of::<f64>(),
        instances: planned_instances(&prepared, baked, |placed| {
            let coupler = Coupler { placed, store: &store, file: &job.scene, resolution, monitor: &stopped };
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

/// What `foresee` says of the parts in their places, if the cache has them all. Without its parts nothing is known under
/// which a coupling could be found: then every block is computed.
fn planned_instances(
    prepared: &Prepared,
    baked: Vec<Option<Baked>>,
    foresee: impl FnOnce(&PlacedParts) -> Vec<ForeseenBlocks>,
) -> Vec<InstanceFate> {
    let foreseen = match baked.into_iter().collect::<Option<Vec<Baked>>>() {
        Some(parts) => foresee(&PlacedParts::new(parts, prepared.instances.clone())),
        None => anew(prepared),
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

/// Everything computed.
fn anew(prepared: &Prepared) -> Vec<ForeseenBlocks> {
    let geometry = |k: usize| &prepared.parts[prepared.instances[k].part.index()].geometry;
    let computed = || Origin::Computed("not all parts are in the cache".into());
    let of = |k: usize| {
        let intruders = intruders(&prepared.instances, geometry, k);
        ForeseenBlocks { corrected: (!intruders.is_empty()).then(computed), coupling: computed(), intruders }
    };
    (0..prepared.instances.len()).map(of).collect()
}

/// What can be told without form factors of what the report of the run will count.
fn left_out(prepared: &Prepared, unseen: usize, hidden_shells: usize) -> BTreeMap<String, usize> {
    let parts = || prepared.instances.iter().map(|instance| &prepared.parts[instance.part.index()]);
    let black = |part: &PreparedPart| part.optics.reflectance.iter().filter(|&&rho| rho == [0.0; 3]).count();
    let counts = [
        // Each of the two has a coupling.
        (UNSEEN, 2 * unseen),
        (BLACK_ROWS, parts().map(black).sum()),
        (SHARED, prepared.instances.len() - prepared.parts.len()),
        (HIDDEN_SHELLS, hidden_shells),
    ];
    counts.into_iter().filter(|&(_, count)| count > 0).map(|(what, count)| (what.into(), count)).collect()
}
