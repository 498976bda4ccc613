//! Refuses scenes without equilibrium: a closed group of elements that reflects all light and emits.

use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use crate::proof::enclosure::{MAX_ROW_ERROR, is_compressed};
use equilux_bake::equilibrium::endless::endless_light;
use equilux_formats::{Error, Optics, Result};
use std::path::Path;

/// Fail if some group of elements keeps all its light and emits.
pub fn refuse_endless_light(
    placed: &PlacedParts,
    systems: &[InstanceSystem],
    optics: &Optics,
    file: &Path,
) -> Result<()> {
    let place: Vec<(usize, usize)> = systems
        .iter()
        .enumerate()
        .flat_map(|(k, n)| (0..n.self_block.receivers()).map(move |i| (k, i)))
        .collect();
    // Missing form factors count as light that stays, so that clusters do not open a closed scene.
    let lack = is_compressed(systems).then_some(MAX_ROW_ERROR);
    let rows = |element: usize| {
        let (k, i) = place[element];
        let first = placed.columns_of(k).start;
        let own = systems[k].self_block.row(i).map(|(j, f)| (j + first, f));
        let mut row: Vec<(usize, f64)> = lack.map(|lack| (element, lack)).into_iter().collect();
        for (node, value) in own.chain(systems[k].coupling.row(i)) {
            spread(placed, node, &mut |element, share| row.push((element, value * share)));
        }
        row
    };
    let Some(element) = endless_light(optics, rows) else { return Ok(()) };
    let instance = &placed.instances[place[element].0];
    Err(Error::new(
        file,
        format!(
            "no equilibrium exists: around `{}` the scene is closed, reflects all light and emits, so its light grows without end",
            instance.name
        ),
        "a reflectance below 1 or an opening somewhere",
        "lower a base colour below 1, or switch the emission off",
    ))
}

/// Call `visit` with every unknown that a column stands for and its share of the column's area.
fn spread(placed: &PlacedParts, column: usize, visit: &mut impl FnMut(usize, f64)) {
    let instance = placed.instance_of_column(column);
    let first: usize = (0..instance).map(|k| placed.unknowns_of(k)).sum();
    let unknowns = placed.part_of(instance).part.geometry.unknowns();
    let node = column - placed.columns_of(instance).start;
    unknowns.spread(node, &mut |unknown, share| visit(first + unknown, share));
}
