//! Sums over the whole scene: means, row sums, and light that never ends.

use crate::exchange::Node;
use crate::placed::Placed;
use crate::proof::enclosure::{OFF, is_compressed};
use equilux_bake::equilibrium::added;
use equilux_bake::equilibrium::endless::endless_light;
use equilux_formats::{Error, Optics, Result, Rgb, RowSumDefect};
use rayon::prelude::*;
use std::path::Path;

/// The mean over the scene's area, channel by channel.
pub fn mean_over_area(placed: &Placed, values: &[Rgb]) -> Rgb {
    let (mut sum, mut total) = ([0.0; 3], 0.0);
    for (element, value) in placed.world.elements.iter().zip(values) {
        sum = added(sum, value.map(|v| v * element.area));
        total += element.area;
    }
    sum.map(|sum| sum / total)
}

/// The root of the mean square of `values` over the mean of `unit`, both over the scene's area; the worst channel.
pub fn rms_over_mean(placed: &Placed, values: &[Rgb], unit: &[Rgb]) -> f64 {
    let squares: Vec<Rgb> = values.iter().map(|v| v.map(|v| v * v)).collect();
    let (squares, means) = (mean_over_area(placed, &squares), mean_over_area(placed, unit));
    let of = |c: usize| if squares[c] == 0.0 { 0.0 } else { squares[c].sqrt() / means[c] };
    (0..3).map(of).fold(0.0, f64::max)
}

/// How far the rows of the whole matrix are from summing to one.
pub fn row_sum_defect(nodes: &[Node]) -> RowSumDefect {
    let sums = nodes.par_iter().map(|node| row_sums(node).collect()).collect::<Vec<Vec<f64>>>();
    RowSumDefect::of(&sums.concat())
}

/// Σ_j F_ij of every receiver of an instance, over all senders of the scene.
pub fn row_sums<'a>(node: &'a Node<'a>) -> impl Iterator<Item = f64> + 'a {
    (0..node.self_block.receivers()).map(|i| node.self_block.row_sum(i) + node.coupling.row_sum(i))
}

/// Refuse a scene in which some group of elements keeps all its light for ever and gets more.
pub fn refuse_endless_light(placed: &Placed, nodes: &[Node], optics: &Optics, file: &Path) -> Result<()> {
    let place: Vec<(usize, usize)> = nodes
        .iter()
        .enumerate()
        .flat_map(|(k, n)| (0..n.self_block.receivers()).map(move |i| (k, i)))
        .collect();
    // What a row may lack counts as staying: clusters must not open a closed scene.
    let lack = is_compressed(nodes).then_some(OFF);
    let rows = |element: usize| {
        let (k, i) = place[element];
        let first = placed.world.nodes_of(k).start;
        let own = nodes[k].self_block.row(i).map(|(j, f)| (j + first, f));
        let mut row: Vec<(usize, f64)> = lack.map(|lack| (element, lack)).into_iter().collect();
        for (node, value) in own.chain(nodes[k].coupling.row(i)) {
            spread(placed, node, &mut |element, share| row.push((element, value * share)));
        }
        row
    };
    let Some(element) = endless_light(optics, rows) else { return Ok(()) };
    let instance = &placed.instances[place[element].0];
    Err(Error::new(
        file,
        format!(
            "around `{}` the scene is closed, reflects everything and emits: its light grows without end",
            instance.name
        ),
        "a reflectance below 1 or an opening somewhere",
        "lower a base colour below 1, or switch the emission off",
    ))
}

/// Call `visit` with every element of a node of the scene and its share of the node's area.
fn spread(placed: &Placed, node: usize, visit: &mut impl FnMut(usize, f64)) {
    let instance = placed.world.instance_of_node(node);
    let (nodes, elements) = (placed.world.nodes_of(instance), placed.world.elements_of(instance));
    let clusters = &placed.part_of(instance).part.geometry.clusters;
    clusters.spread(node - nodes.start, &mut |element, share| visit(elements.start + element, share));
}
