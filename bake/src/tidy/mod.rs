//! Reduces an imported scene to the surfaces that light can reach.

mod bounds;
mod cells;
pub mod enclosed_lamps;
mod hidden_backs;
mod overlaps;
mod recentre;

use equilux_formats::{PartId, Scene};

/// Moves a scene close to the origin of its coordinates, and removes surfaces that do not take part in its light.
pub(crate) fn tidy(scene: &mut Scene) {
    recentre::recentre(scene);
    scene.hidden_shells = hidden_backs::hide_backs(scene);
    overlaps::cut_overlaps(scene);
    scene.instances.retain(|instance| !scene.parts[instance.part.index()].surfaces.is_empty());
    drop_unused_parts(scene);
}

/// Removes parts without instances, and renumbers the others.
fn drop_unused_parts(scene: &mut Scene) {
    let mut new: Vec<Option<PartId>> = vec![None; scene.parts.len()];
    scene.instances.iter().for_each(|instance| new[instance.part.index()] = Some(instance.part));
    for (number, id) in new.iter_mut().flatten().enumerate() {
        *id = PartId::from_index(number);
    }
    let mut used = new.iter().map(Option::is_some);
    scene.parts.retain(|_| used.next().expect("one for each part"));
    for instance in &mut scene.instances {
        instance.part = new[instance.part.index()].expect("an instance uses its part");
    }
}
