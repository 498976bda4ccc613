//! An edited scene reuses exactly what the edit cannot have changed: after each of many edits the blocks equal those
//! computed from scratch.

use equilux_assemble::equation::coupling::Coupled;
use equilux_assemble::placed_parts::PlacedParts;
use equilux_bake::elements::ElementSize;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod};
use equilux_bake::treecode::{EXACT, Resolution};
use equilux_formats::Rows;
use equilux_tests::edited::{Dice, Thing, edit, scene};
use equilux_tests::lit::coupled;
use equilux_tests::shapes::coupling;
use equilux_tests::workshop::{Workshop, assembled};
use std::path::Path;

/// All blocks of a scene, and how many form factors were computed for them.
fn blocks(file: &Path, cache: &Path, resolution: Resolution) -> (PlacedParts, Vec<Coupled>, usize) {
    let wanted = Preparation {
        element_size: Some(ElementSize::Metres(0.5)),
        division: Division::Authored,
        resolution,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    };
    let (placed, coupled) = coupled(file, cache, &wanted);
    let computed = coupled.iter().map(|c| c.computed + c.corrected.as_ref().map_or(0, |c| c.computed)).sum();
    (placed, coupled, computed)
}

/// Largest difference of an instance's blocks from its rows of the whole matrix, entry by entry.
fn difference(placed: &PlacedParts, instance: usize, blocks: &Coupled, whole: &Rows) -> f64 {
    let (own, first) =
        (blocks.self_block(&placed.part_of(instance).part.self_block), placed.world.nodes_of(instance).start);
    let row = |i: usize| {
        let mut row = vec![0.0; whole.senders()];
        whole.row(i).for_each(|(sender, value)| row[sender] += value);
        own.row(i).for_each(|(sender, value)| row[first + sender] -= value);
        blocks.coupling.row(i).for_each(|(sender, value)| row[sender] -= value);
        row.into_iter().map(f64::abs).fold(0.0, f64::max)
    };
    (0..whole.receivers()).map(row).fold(0.0, f64::max)
}

#[test]
fn after_two_hundred_edits_every_form_factor_is_that_of_the_whole_matrix() {
    let (workshop, mut dice) = (Workshop::new(), Dice(7));
    let mut things: Vec<Thing> = (0..4).map(|place| dice.thing(place, 2 * place)).collect();
    let (file, cache) = (workshop.path("scene.glb"), workshop.path("cache"));
    scene(&things).write(&file);
    blocks(&file, &cache, EXACT);
    let (mut computed_now, mut computed_fresh) = (0, 0);
    for number in 0..200 {
        let what = edit(&mut things, &mut dice, number);
        scene(&things).write(&file);
        let (placed, now, computed) = blocks(&file, &cache, EXACT);
        let everyone: Vec<usize> = (0..placed.instances.len()).collect();
        for (k, now) in now.iter().enumerate() {
            let whole = coupling(&placed.world, k, &everyone, EXACT);
            let off = difference(&placed, k, now, &whole);
            // Entries are the same numbers, or sums of the same clipped terms in another order: some 1e-16 each.
            assert!(
                off <= 1e-12,
                "{what}: a form factor of `{}` is off by {off:e}",
                placed.instances[k].name
            );
            computed_fresh += whole.stored();
        }
        computed_now += computed;
    }
    assert!(computed_now < computed_fresh / 2, "{computed_now} computed, {computed_fresh} if from nothing");
}

#[test]
fn after_edits_compressed_light_is_within_what_is_proved_of_the_whole_matrix() {
    let (workshop, mut dice) = (Workshop::new(), Dice(11));
    let mut things: Vec<Thing> = (0..4).map(|place| dice.thing(place, 2 * place)).collect();
    let mut job = workshop.job(Division::Authored);
    let resolution = Resolution::for_tolerance(0.01);
    job.scene = workshop.path("scene.glb");
    job.settings.preparation.resolution = resolution;
    job.settings.preparation.element_size = Some(ElementSize::Metres(0.25));
    job.outputs.verify = true;
    for number in 0..12 {
        let what = edit(&mut things, &mut dice, number);
        scene(&things).write(&job.scene);
        let report = assembled(&job);
        let off = report.verify.as_ref().expect("asked for").max_abs_diff;
        let proved = report.error.proved;
        // Nothing is added for rounding: clusters cost a thousand times more.
        assert!(off <= proved, "{what}: {off} W/m² away from the whole, proved are {proved}");
        // A row keeps its sum to a step, and so does one that was brought up to date.
        let lost = report.row_sum_defect.max;
        assert!(lost <= 1e-3, "{what}: a row sums to {lost} less or more than 1");
    }
}
