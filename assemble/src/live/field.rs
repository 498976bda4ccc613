//! Values of elements that viewers fetch. Input: the published state of a run. Output: bytes.

use super::model::Model;
use crate::equation::coupling::Coupled;
use crate::placed_parts::PlacedParts;
use equilux_formats::{Optics, Rgb};
use rayon::prelude::*;
use serde::Deserialize;
use std::sync::Arc;

/// A quantity of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Field {
    /// W/m², linear RGB.
    Radiosity,
    /// W/m², linear RGB; [`UNKNOWN`] on black elements until the end.
    Irradiance,
    /// |1 − Σ_j F_ij|.
    RowSums,
    /// The share of an element's form factors that were computed in this run.
    Computed,
}

/// Marks a value that is not known yet.
pub const UNKNOWN: f32 = f32::MIN;

/// The light of a round.
#[derive(Debug, Clone)]
pub struct RoundLight {
    /// The scene's model.
    pub model: Arc<Model>,
    /// The round after which it was published; 0 before the first.
    pub round: usize,
    /// Radiosity of all elements, W/m².
    pub radiosity: Arc<Vec<Rgb>>,
    /// Irradiance of all elements, W/m², after the exchange.
    pub irradiance: Option<Arc<Vec<Rgb>>>,
    /// Optics of all elements.
    pub optics: Arc<Optics>,
}

/// The values of a field at some time.
pub struct Snapshot {
    /// The run that it belongs to.
    pub run: u32,
    /// Version; later snapshots have higher numbers.
    pub number: u32,
    /// Its values.
    pub values: SnapshotValues,
}

/// The values of a snapshot.
pub enum SnapshotValues {
    /// Light.
    Light(RoundLight, Field),
    /// One number for each element.
    Numbers(Arc<Vec<f32>>),
}

impl Snapshot {
    /// The bytes for viewers: run, number and round (u32), exposure (f32, the factor on B/π), numbers for each
    /// element (u32), then the numbers (f32). All little-endian. Round and exposure are 0 for fields that are not
    /// light.
    pub fn bytes(&self) -> Vec<u8> {
        let (round, (exposure, stride, numbers)) = match &self.values {
            SnapshotValues::Numbers(numbers) => (0, (0.0, 1, numbers.to_vec())),
            SnapshotValues::Light(light, field) => (light.round as u32, light.shown(*field)),
        };
        let mut bytes = Vec::with_capacity(20 + 4 * numbers.len());
        [self.run, self.number, round].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
        bytes.extend((exposure as f32).to_le_bytes());
        bytes.extend(u32::to_le_bytes(stride));
        bytes.extend(numbers.into_iter().flat_map(f32::to_le_bytes));
        bytes
    }
}

impl RoundLight {
    /// Exposure, numbers for each element, and the numbers.
    fn shown(&self, field: Field) -> (f64, u32, Vec<f32>) {
        let exposure = |light: &[Rgb]| self.model.exposure(light, &self.optics.emission).0;
        let numbers = |light: &[Rgb]| light.iter().flatten().map(|&x| x as f32).collect();
        match (field, &self.irradiance) {
            (Field::Irradiance, Some(h)) => (exposure(h), 3, numbers(h)),
            (Field::Irradiance, None) => {
                let arriving = self.arriving();
                let known = arriving.iter().map(|h| Rgb(h.map(|h| h.unwrap_or(0.0)))).collect::<Vec<_>>();
                let numbers = arriving.iter().flatten().map(|h| h.map_or(UNKNOWN, |h| h as f32));
                (exposure(&known), 3, numbers.collect())
            }
            _ => (exposure(&self.radiosity), 3, numbers(&self.radiosity)),
        }
    }

    /// H = (B − E)/ρ, W/m²; none where ρ is 0.
    fn arriving(&self) -> Vec<[Option<f64>; 3]> {
        let Optics { reflectance, emission } = &*self.optics;
        let of = |i: usize, c: usize| {
            let rho = reflectance[i][c];
            (rho > 0.0).then(|| (self.radiosity[i][c] - emission[i][c]) / rho)
        };
        (0..self.radiosity.len()).map(|i| [0, 1, 2].map(|c| of(i, c))).collect()
    }
}

/// |1 − Σ_j F_ij| of all elements.
pub fn row_sums(placed: &PlacedParts, coupled: &[Coupled]) -> Vec<f32> {
    let of = |k: usize| {
        let own = coupled[k].self_block(&placed.part_of(k).part.self_block);
        let sum = move |i: usize| own.row_sum(i) + coupled[k].coupling.row_sum(i);
        (0..own.receivers()).map(move |i| (1.0 - sum(i)).abs() as f32).collect::<Vec<_>>()
    };
    (0..coupled.len()).into_par_iter().map(of).collect::<Vec<_>>().concat()
}

/// The share of each element's form factors that were computed in this run.
pub fn computed(placed: &PlacedParts, coupled: &[Coupled]) -> Vec<f32> {
    let of = |k: usize| computed_of(placed, coupled, k);
    (0..coupled.len()).into_par_iter().map(of).collect::<Vec<_>>().concat()
}

fn computed_of(placed: &PlacedParts, coupled: &[Coupled], k: usize) -> Vec<f32> {
    let (baked, blocks) = (placed.part_of(k), &coupled[k]);
    let own = blocks.self_block(&baked.part.self_block);
    let count = |rows: &[u32], i: usize| rows.get(i).map_or(0, |&count| count as usize);
    let share = |i: usize| {
        // A block corrected for intruders starts from the part's own block: if that is new, all of it is.
        let inside = match &blocks.corrected {
            _ if !baked.form_factors.is_reused() => own.entries_of(i),
            Some(corrected) => count(&corrected.computed_by_row, i),
            None => 0,
        };
        let computed = inside + count(&blocks.computed_by_row, i);
        // An entry that is rounded to zero when stored was computed too.
        let stored = own.entries_of(i) + blocks.coupling.entries_of(i);
        (computed as f32 / stored.max(1) as f32).min(1.0)
    };
    (0..own.receivers()).map(share).collect()
}
