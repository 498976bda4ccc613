//! Notes on lamps that light nothing.

use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use crate::report::light_notes::{MAX_NAMED, more};
use equilux_bake::tidy::enclosed_lamps::enclosed_lamps;
use equilux_formats::Scene;

/// Notes on the lamps named `unlit`, whose light reaches no element, and on emitting instances that no element sees.
/// Excludes lamps inside closed meshes, which have their own note.
pub fn unlit_notes(
    scene: &Scene,
    unlit: &[String],
    placed: &PlacedParts,
    systems: &[InstanceSystem],
) -> Vec<String> {
    let enclosed = enclosed_lamps(scene);
    let is_open = |name: &&String| !enclosed.iter().any(|enclosed| enclosed.lamp == **name);
    let unseen = unseen(placed, systems);
    let unlit: Vec<&String> = unlit.iter().chain(&unseen).filter(is_open).collect();
    let sentences = unlit.iter().take(MAX_NAMED).map(|name| {
        format!(
            "lamp `{name}` lights nothing: the surfaces it shines at are hidden, face away or do not exist; move or turn it, or flip \
             the normals of the surfaces around it"
        )
    });
    sentences.chain(more(unlit.len(), "lamps that light nothing")).collect()
}

/// The names of emitting instances that no element sees.
fn unseen(placed: &PlacedParts, systems: &[InstanceSystem]) -> Vec<String> {
    let mut emits: Vec<bool> = Vec::with_capacity(placed.columns());
    for (instance, system) in systems.iter().enumerate() {
        let optics = placed.part_of(instance).part.geometry.optics_of_unknowns(&placed.optics_of(instance));
        let means = system.clusters.means(&optics.emission);
        emits.extend(means.iter().map(|emission| *emission != [0.0; 3]));
    }
    let mut unseen: Vec<bool> =
        (0..systems.len()).map(|instance| placed.columns_of(instance).any(|column| emits[column])).collect();
    for (instance, system) in systems.iter().enumerate() {
        let first = placed.columns_of(instance).start;
        let own = system.self_block.senders_seen().map(|sender| first + sender);
        for sender in own.chain(system.coupling.senders_seen()).filter(|&sender| emits[sender]) {
            unseen[placed.instance_of_column(sender)] = false;
        }
    }
    let instances = placed.instances.iter().zip(unseen);
    instances.filter(|(_, unseen)| *unseen).map(|(instance, _)| instance.name.clone()).collect()
}
