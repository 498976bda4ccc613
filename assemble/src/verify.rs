//! The classic matrix radiosity of the whole scene, on the same elements: what the parts must agree with.

use crate::placed_parts::PlacedParts;
use crate::proof::exact_rows::ROWS_PER_EXACT_ROW;
use equilux_bake::equilibrium::{LocalSystem, default_solver, factorise};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, exact_rows};
use equilux_formats::{ClusterTree, Optics, Result, Rgb, Rows};
use std::time::{Duration, Instant};

/// The whole-scene answer and what it took.
#[derive(Debug)]
pub struct Classic {
    /// Radiosity of all elements.
    pub radiosity: Vec<Rgb>,
    /// The whole matrix.
    pub matrix: Rows,
    /// Time spent on form factors, summed over threads.
    pub form_factor_time: Duration,
    /// Time spent on the solution.
    pub solve_time: Duration,
}

/// Compute the whole matrix at once and solve it at once. Fails if the monitor was stopped.
/// `optics` are those of all elements, emission with all that drives the exchange.
pub fn classic(placed: &PlacedParts, optics: &Optics, monitor: &Monitor) -> Result<Classic> {
    let (matrix, form_factor_time) = whole_matrix(placed, monitor)?;
    let start = Instant::now();
    let trees: Vec<&ClusterTree> =
        (0..placed.instances.len()).map(|k| &placed.part_of(k).part.geometry.clusters).collect();
    let clusters = ClusterTree::joined(&trees);
    let solver = default_solver(clusters.elements());
    let factors = factorise(&matrix, &clusters, &optics.reflectance, solver);
    let system = LocalSystem::new(&matrix, &clusters, &optics.reflectance, solver, factors.as_ref());
    let radiosity = system.solve(&optics.emission, &optics.emission);
    Ok(Classic { radiosity, form_factor_time, solve_time: start.elapsed(), matrix })
}

/// Every form factor of the scene, element by element.
fn whole_matrix(placed: &PlacedParts, monitor: &Monitor) -> Result<(Rows, Duration)> {
    let world = &placed.world;
    let element: Vec<u32> =
        (0..world.nodes.len()).map(|node| world.element_of(node).map_or(u32::MAX, |e| e as u32)).collect();
    let (mut rows, mut time) = (Vec::new(), Duration::ZERO);
    monitor.begin("classic matrix", world.elements.len(), ROWS_PER_EXACT_ROW * world.elements.len() as f64);
    for instance in 0..placed.instances.len() {
        let timed = exact_rows(world, Audience::Instance(instance), monitor)?;
        time += timed.time;
        let named = |i: usize| timed.block.row(i).map(|(node, f)| (element[node], f)).collect::<Vec<_>>();
        rows.extend((0..timed.block.receivers()).map(named));
    }
    let columns = 2 * world.elements.len() - usize::from(!world.elements.is_empty());
    Ok((Rows::from_rows(columns, rows), time))
}
