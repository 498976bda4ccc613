//! The rows of a part on its own, as whole numbers, and what their rays may still meet in a scene.

use super::samples::Samples;
use super::surfaces::{End, Surfaces};
use super::tracing::{Scratch, tallied, traced};
use crate::geometry::aabb::Aabb;
use crate::monitor::Monitor;
use equilux_formats::baked::Escapes;
use equilux_formats::rows::CountedRow;
use equilux_formats::{Result, Rows};

/// The rows of a part on its own.
#[derive(Debug, Clone, PartialEq)]
pub struct AloneRows {
    /// F_kk, `unknowns × unknowns`.
    pub self_block: Rows,
    /// What the rays may still meet in a scene.
    pub escapes: Escapes,
}

/// Traces all rows of a part on its own. Fails if the monitor was stopped.
pub fn alone(surfaces: &Surfaces, samples: &Samples, monitor: &Monitor) -> Result<AloneRows> {
    let rows = traced(surfaces.unknowns(), monitor, |unknown, scratch| {
        // The widest vector instructions of the machine; the order of operations, and with it the result, does not change.
        pulp::Arch::new().dispatch(Alone { surfaces, samples, unknown, scratch })
    })?;
    let mut escapes = Escapes::default();
    let mut counted = Vec::with_capacity(rows.len());
    for row in rows {
        escapes.escaped.extend(row.escaped);
        escapes.covered.push(row.covered);
        escapes.reach.push(row.reach);
        counted.push(CountedRow { counts: row.counts, rays: samples.rays() as u32 - u32::from(row.covered) });
    }
    Ok(AloneRows { self_block: Rows::from_counts(surfaces.unknowns(), counted), escapes })
}

/// The row of an unknown in its part alone.
struct Alone<'a> {
    surfaces: &'a Surfaces,
    samples: &'a Samples,
    unknown: usize,
    scratch: &'a mut Scratch,
}

struct AloneRow {
    counts: Vec<(u32, u16)>,
    covered: u16,
    escaped: Vec<u64>,
    reach: [f32; 6],
}

impl pulp::NullaryFnOnce for Alone<'_> {
    type Output = AloneRow;

    #[inline(always)]
    fn call(self) -> AloneRow {
        let Self { surfaces, samples, unknown, scratch: Scratch { rays, own, .. } } = self;
        let emitters = surfaces.emitters(unknown);
        emitters.rays(samples, emitters.number(), rays);
        own.clear();
        let near = emitters.bounds().diagonal();
        let (mut covered, mut escaped) = (0, vec![0; rays.len().div_ceil(64)]);
        let mut reach = Aabb::EMPTY;
        for (number, ray) in rays.iter().enumerate() {
            reach = reach.union(Aabb { low: ray.origin, high: ray.origin });
            let hit = surfaces.tree.first(ray, f64::INFINITY);
            // In a scene something may cover the start of a ray that escapes.
            let end = ray.at(hit.map_or(near, |hit| hit.t));
            reach = reach.union(Aabb { low: end, high: end });
            let Some(hit) = hit else {
                escaped[number / 64] |= 1 << (number % 64);
                continue;
            };
            match surfaces.end(ray, &hit, near) {
                End::Element(element) => own.push(surfaces.unknown_of(element)),
                End::Covered => covered += 1,
                End::Black => {}
            }
        }
        AloneRow { counts: tallied(own), covered, escaped, reach: rounded(reach) }
    }
}

/// A box in f32, no smaller.
fn rounded(bounds: Aabb) -> [f32; 6] {
    let [a, b, c] = bounds.low.to_array().map(|x| (x as f32).next_down());
    let [d, e, f] = bounds.high.to_array().map(|x| (x as f32).next_up());
    [a, b, c, d, e, f]
}
