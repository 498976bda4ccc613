//! Whether each part and block is computed, reused or skipped, and why, before or after a run. The reasons come from
//! the manifests that also form the cache keys.

use crate::equation::coupling::Coupled;
use crate::placed_parts::PlacedParts;
use equilux_bake::oven::Baked;
use equilux_bake::oven::cached::Origin;
use serde::Serialize;

/// A distinct part, before or after a run.
#[derive(Debug, Clone, Serialize)]
pub struct PartFate {
    /// Its name.
    pub name: String,
    /// Its elements.
    pub elements: usize,
    /// Number of instances.
    pub places: usize,
    /// Fate of its own form factors.
    pub form_factors: Fate,
    /// Fate of its local equilibrium; none before the run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<Fate>,
    /// Solver of its local equilibrium.
    pub local_solver: String,
}

/// An instance, before or after a run.
#[derive(Debug, Clone, Serialize)]
pub struct InstanceFate {
    /// Its name.
    pub name: String,
    /// Its part.
    pub part: String,
    /// The instances inside it, which change its own form factors.
    pub intruders: Vec<String>,
    /// Fate of its own form factors with the instances inside it; none if there are none.
    pub corrected: Option<Fate>,
    /// Fate of the form factors to all other instances.
    pub coupling: Fate,
}

/// Whether something is computed or reused, and why.
#[derive(Debug, Clone, Serialize)]
pub struct Fate {
    /// `computed` or `reused`.
    pub how: &'static str,
    /// Why.
    pub reason: String,
}

impl Fate {
    /// The fate that an origin describes.
    pub fn of(origin: &Origin) -> Self {
        match origin {
            Origin::Reused => Self { how: "reused", reason: "all inputs are unchanged".into() },
            Origin::Unchanged(_) => Self { how: "reused", reason: origin.to_string() },
            Origin::Computed(reason) => Self::computed(reason),
        }
    }

    /// Computed for this reason.
    pub fn computed(reason: &str) -> Self {
        Self { how: "computed", reason: reason.into() }
    }
}

/// Number of unseen instances that are named; the rest are counted.
const MAX_NAMED: usize = 4;

/// The fates of all parts and blocks as sentences, parts first.
pub fn explained(placed: &PlacedParts, coupled: &[Coupled]) -> Vec<String> {
    let parts =
        placed.parts.iter().enumerate().map(|(number, baked)| part_line(&part(placed, number, baked)));
    let blocks = (0..coupled.len()).flat_map(|k| blocks(placed, k, &coupled[k]));
    parts.chain(blocks).collect()
}

fn part(placed: &PlacedParts, number: usize, baked: &Baked) -> PartFate {
    PartFate {
        name: baked.part.name.clone(),
        elements: baked.part.geometry.elements.len(),
        places: placed.instances.iter().filter(|instance| instance.part.index() == number).count(),
        form_factors: Fate::of(&baked.form_factors),
        light: Some(Fate::of(&baked.light)),
        local_solver: format!("{:?}", baked.part.local.solver),
    }
}

fn blocks(placed: &PlacedParts, k: usize, coupled: &Coupled) -> Vec<String> {
    let name = |k: usize| placed.instances[k].name.clone();
    let corrected = coupled.corrected.as_ref().filter(|own| !own.intruders.is_empty());
    let instance = InstanceFate {
        name: name(k),
        part: placed.part_of(k).part.name.clone(),
        intruders: corrected.iter().flat_map(|own| &own.intruders).map(|&i| name(i)).collect(),
        corrected: corrected.map(|own| Fate::of(&own.origin)),
        coupling: Fate::of(&coupled.origin),
    };
    let relit = placed.relit[k].as_ref();
    let relit =
        relit.map(|relit| format!("light of {}, repainted, {}", name(k), step(&Fate::of(&relit.origin))));
    let coupling = format!("coupling of {} {}", name(k), step(&instance.coupling));
    let seen = seen_instances(placed, coupled);
    let unseen: Vec<String> = (0..seen.len()).filter(|&l| l != k && !seen[l]).map(name).collect();
    corrected_line(&instance).into_iter().chain(relit).chain([coupling + &unseen_clause(&unseen)]).collect()
}

fn unseen_clause(unseen: &[String]) -> String {
    let named = unseen.iter().take(MAX_NAMED).cloned().collect::<Vec<_>>().join(", ");
    match unseen.len() {
        0 => String::new(),
        1..=MAX_NAMED => format!("; left out: {named}, of which it sees nothing"),
        count => format!("; left out: {named} and {} more, of which it sees nothing", count - MAX_NAMED),
    }
}

/// For each instance, whether an element of the block's instance sees any of it.
pub fn seen_instances(placed: &PlacedParts, coupled: &Coupled) -> Vec<bool> {
    let mut seen = vec![false; placed.instances.len()];
    for sender in coupled.coupling.senders_seen() {
        seen[placed.instance_of_column(sender)] = true;
    }
    seen
}

/// The fate of a part as a line.
pub fn part_line(part: &PartFate) -> String {
    let places = if part.places == 1 { "1 place".into() } else { format!("{} places", part.places) };
    let light = part.light.as_ref().map_or(String::new(), |light| format!("; light {}", step(light)));
    format!(
        "part {}: {} elements in {places}, solved by {}; form factors {}{light}",
        part.name,
        part.elements,
        part.local_solver,
        step(&part.form_factors)
    )
}

/// The fate of an instance's own form factors as a line, if there are instances inside it.
pub fn corrected_line(instance: &InstanceFate) -> Option<String> {
    let corrected = instance.corrected.as_ref()?;
    let inside = instance.intruders.join(", ");
    Some(format!("inside {} is {inside}: its own form factors {}", instance.name, step(corrected)))
}

/// A fate as text.
pub fn step(step: &Fate) -> String {
    format!("{}: {}", step.how, step.reason)
}
