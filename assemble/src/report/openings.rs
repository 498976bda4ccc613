//! Notes on what rays leave dark: surfaces that no chain of rays joins with any light, and parts that so few rays join with it
//! that their light is mostly noise. Both are closed, or lie behind openings that are small beside the distance between rays.
//!
//! Input: a solved scene whose rows are counted rays. Output: notes, and remarks on areas that are too small to matter. What
//! mostly faces the empty space around a scene is left out: it is dark because nothing shines there.

use crate::equation::Equation;
use crate::exchange::system::InstanceSystem;
use crate::proof::noise::Noise;
use equilux_formats::Rgb;

/// The noise of a part, over its own mean irradiance, above which few rays find its light. Parts behind a door have .02 to
/// .06 with 256 rays.
const MOST_NOISE: f64 = 0.25;

/// Rows in which the noise of a part must have been measured.
const FEWEST_ROWS: usize = 4;

/// An unknown is enclosed if more than this share of its rays end on elements.
const ENCLOSED: f64 = 0.5;

/// Parts whose dark area is below this share of the scene's need no action.
const LEAST_SHARE: f64 = 1e-3;

/// Number of parts that are named; the rest are counted.
const MAX_NAMED: usize = 3;

/// Notes that call for action, and remarks that do not.
#[derive(Debug, Default)]
pub struct DarkParts {
    /// Notes.
    pub notes: Vec<String>,
    /// Remarks.
    pub remarks: Vec<String>,
}

/// What rays leave dark; nothing for exact rows, and in a scene without light. `noise`: if it was measured.
pub fn dark_parts(equation: &Equation, systems: &[InstanceSystem], noise: Option<&Noise>) -> DarkParts {
    if equation.rays().is_none() {
        return DarkParts::default();
    }
    let area: f64 = systems.iter().flat_map(|system| &system.areas).sum();
    let name = |k: usize| equation.placed.instances[k].name.as_str();
    let shares = |of: &dyn Fn(usize) -> f64| -> Vec<(&str, f64)> {
        (0..systems.len()).map(|k| (name(k), of(k) / area)).collect()
    };
    let dark = dark_areas(equation, systems);
    let unjoined = shares(&|k| dark[k]);
    let (large, small) = unjoined.into_iter().partition(|&(_, share)| share >= LEAST_SHARE);
    let unjoined = named(large).map(|parts| {
        format!(
            "no ray joins {parts} with any light: they are closed, or light enters through an opening that rays miss; if there is \
             one, give --rows exact --tolerance 0"
        )
    });
    let noisy = named(shares(&|k| noise.map_or(0.0, |noise| noisy_area(&systems[k], noise, k)))).map(|parts| {
        format!(
            "few rays join {parts} with light, probably through a small opening: row by row, the light there is uncertain by more \
             than {:.0} %; give --rows exact --tolerance 0, or more --rays",
            100.0 * MOST_NOISE
        )
    });
    let remark = named(small).map(|parts| format!("no ray joins {parts} with any light"));
    DarkParts { notes: unjoined.into_iter().chain(noisy).collect(), remarks: remark.into_iter().collect() }
}

/// The area of an instance, m², if its light is mostly noise and most of it is enclosed; else 0.
fn noisy_area(system: &InstanceSystem, noise: &Noise, instance: usize) -> f64 {
    let own = &noise.by_instance[instance];
    let area: f64 = system.areas.iter().sum();
    let enclosed = (0..system.areas.len()).filter(|&unknown| is_enclosed(system, unknown));
    let is_noisy = own.rows >= FEWEST_ROWS && own.over_mean > MOST_NOISE;
    if is_noisy && enclosed.map(|unknown| system.areas[unknown]).sum::<f64>() > area / 2.0 {
        area
    } else {
        0.0
    }
}

fn is_enclosed(system: &InstanceSystem, unknown: usize) -> bool {
    system.self_block.row_sum(unknown) + system.coupling.row_sum(unknown) > ENCLOSED
}

/// The enclosed open area of each instance that no chain of rays joins with any light, m²; 0 in a scene without light.
fn dark_areas(equation: &Equation, systems: &[InstanceSystem]) -> Vec<f64> {
    let placed = &equation.placed;
    let mut is_lit: Vec<bool> = (0..systems.len()).flat_map(|k| shines_or_is_shone_at(equation, k)).collect();
    let mut dark: Vec<(usize, usize)> = (0..systems.len())
        .flat_map(|k| (0..systems[k].areas.len()).map(move |unknown| (k, unknown)))
        .filter(|&(k, unknown)| !is_lit[placed.columns_of(k).start + unknown])
        .collect();
    let mut areas = vec![0.0; systems.len()];
    if dark.len() == is_lit.len() {
        return areas;
    }
    // What sees something lit is lit, until nothing changes.
    let mut before = usize::MAX;
    while dark.len() < before {
        before = dark.len();
        dark.retain(|&(k, unknown)| {
            let first = placed.columns_of(k).start;
            let own = systems[k].self_block.row(unknown).map(|(column, _)| first + column);
            let others = systems[k].coupling.row(unknown).map(|(column, _)| column);
            is_lit[first + unknown] = own.chain(others).any(|column| is_lit[column]);
            !is_lit[first + unknown]
        });
    }
    for (k, unknown) in dark.into_iter().filter(|&(k, unknown)| is_enclosed(&systems[k], unknown)) {
        areas[k] += systems[k].areas[unknown];
    }
    areas
}

/// For each unknown of an instance whether it emits, or light of lamps, suns or the sky reaches it.
fn shines_or_is_shone_at(equation: &Equation, instance: usize) -> Vec<bool> {
    let placed = &equation.placed;
    let own = placed.part_of(instance).part.geometry.optics_of_unknowns(&placed.optics_of(instance));
    let arriving = &equation.direct.irradiance[instance];
    own.emission.iter().zip(arriving).map(|(&e, &d)| e != Rgb::BLACK || d != Rgb::BLACK).collect()
}

/// The largest of these parts with their shares of the scene's area, and a count of the others; none if all are 0.
fn named(mut parts: Vec<(&str, f64)>) -> Option<String> {
    parts.retain(|&(_, share)| share > 0.0);
    parts.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (first, others) = parts.split_at(parts.len().min(MAX_NAMED));
    let percent = |share: f64| format!("{:.2} %", 100.0 * share);
    let mut names: Vec<String> =
        first.iter().map(|(name, share)| format!("`{name}` ({} of the area)", percent(*share))).collect();
    if !others.is_empty() {
        let share = others.iter().map(|(_, share)| share).sum();
        names.push(format!("{} more ({})", others.len(), percent(share)));
    }
    (!names.is_empty()).then(|| names.join(", "))
}
