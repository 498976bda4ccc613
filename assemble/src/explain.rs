//! What a run computed, reused and left out, and why: a sentence for each part and block, in the words in which a plan says
//! it beforehand. The reasons come from the manifests that make the keys.

use crate::coupling::Coupled;
use crate::placed::Placed;
use crate::plan::text::{corrected_line, part_line, step};
use crate::plan::{PlannedInstance, PlannedPart, Step};
use crate::report::summary::seen_instances;
use equilux_bake::oven::Baked;

/// So many instances that another does not see are named, more are counted.
const NAMED: usize = 4;

/// The sentences, parts first.
pub fn explained(placed: &Placed, coupled: &[Coupled]) -> Vec<String> {
    let parts =
        placed.parts.iter().enumerate().map(|(number, baked)| part_line(&part(placed, number, baked)));
    let blocks = (0..coupled.len()).flat_map(|k| blocks(placed, k, &coupled[k]));
    parts.chain(blocks).collect()
}

fn part(placed: &Placed, number: usize, baked: &Baked) -> PlannedPart {
    PlannedPart {
        name: baked.part.name.clone(),
        elements: baked.part.geometry.elements.len(),
        places: placed.instances.iter().filter(|instance| instance.part.index() == number).count(),
        form_factors: Step::of(&baked.form_factors),
        light: Some(Step::of(&baked.light)),
        local_solver: format!("{:?}", baked.part.local.solver),
    }
}

fn blocks(placed: &Placed, k: usize, coupled: &Coupled) -> Vec<String> {
    let name = |k: usize| placed.instances[k].name.clone();
    let instance = PlannedInstance {
        name: name(k),
        part: placed.part_of(k).part.name.clone(),
        intruders: coupled.corrected.iter().flat_map(|own| &own.intruders).map(|&i| name(i)).collect(),
        corrected: coupled.corrected.as_ref().map(|own| Step::of(&own.origin)),
        coupling: Step::of(&coupled.origin),
    };
    let relit = placed.relit[k].as_ref();
    let relit =
        relit.map(|relit| format!("light of {}, repainted, {}", name(k), step(&Step::of(&relit.origin))));
    let coupling = format!("coupling of {} {}", name(k), step(&instance.coupling));
    let seen = seen_instances(placed, coupled);
    let unseen: Vec<String> = (0..seen.len()).filter(|&l| l != k && !seen[l]).map(name).collect();
    corrected_line(&instance).into_iter().chain(relit).chain([coupling + &unseen_clause(&unseen)]).collect()
}

fn unseen_clause(unseen: &[String]) -> String {
    let named = unseen.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ");
    match unseen.len() {
        0 => String::new(),
        1..=NAMED => format!("; left out: {named}, of which it sees nothing"),
        count => format!("; left out: {named} and {} more, of which it sees nothing", count - NAMED),
    }
}
