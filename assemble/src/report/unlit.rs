//! Lamps that light nothing: results of a run → sentences that name them.

use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use crate::report::light_notes::{NAMED, more};
use equilux_bake::tidy::enclosed_lamps::enclosed_lamps;
use equilux_formats::Scene;

/// Sentences about the lamps called `unlit`, of which nothing arrives at any element, and about instances that emit but that
/// no element sees. Not about lamps that stand in closed meshes, which are named anyway.
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
    let sentences = unlit.iter().take(NAMED).map(|name| {
        format!(
            "lamp `{name}` lights nothing: what it shines at is hidden, looks away or is not there; move or turn it, or flip \
             the normals of what stands around it"
        )
    });
    sentences.chain(more(unlit.len(), "lamps that light nothing")).collect()
}

/// The names of the instances that emit and that no element sees.
fn unseen(placed: &PlacedParts, systems: &[InstanceSystem]) -> Vec<String> {
    let world = &placed.world;
    let mut emits: Vec<bool> = Vec::with_capacity(world.nodes.len());
    for (instance, system) in systems.iter().enumerate() {
        let means = system.clusters.means(&placed.optics_of(instance).emission);
        emits.extend(means.iter().map(|emission| *emission != [0.0; 3]));
    }
    let mut unseen: Vec<bool> =
        (0..systems.len()).map(|instance| world.nodes_of(instance).any(|node| emits[node])).collect();
    for (instance, system) in systems.iter().enumerate() {
        let first = world.nodes_of(instance).start;
        let own = system.self_block.senders_seen().map(|sender| first + sender);
        for sender in own.chain(system.coupling.senders_seen()).filter(|&sender| emits[sender]) {
            unseen[world.instance_of_node(sender)] = false;
        }
    }
    let instances = placed.instances.iter().zip(unseen);
    instances.filter(|(_, unseen)| *unseen).map(|(instance, _)| instance.name.clone()).collect()
}
