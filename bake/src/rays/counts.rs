//! Rows of an instance in a scene, as whole numbers: what its rays end on.
//!
//! A scene adds to the row of the part alone what escaped rays meet, and replaces what now stands behind something else. It
//! is the same row as from nothing, since a ray meets its own part in the same way in both.

use super::samples::Samples;
use super::scenery::{Landing, Scenery};
use super::surfaces::End;
use super::tracing::{Scratch, tallied, traced};
use super::wide_tree::Ray;
use crate::geometry::aabb::Aabb;
use crate::monitor::Monitor;
use equilux_formats::baked::Escapes;
use equilux_formats::rows::CountedRow;
use equilux_formats::{Result, Rows};
use glam::DVec3;

/// What the columns of a scene's rows stand for: the unknowns of all instances, then the cells of the sky.
#[derive(Clone, Copy)]
pub struct SceneColumns<'a> {
    /// The first column of each instance.
    pub first: &'a [u32],
    /// Number of columns of instances.
    pub unknowns: usize,
    /// Number of cells of the sky.
    pub cells: usize,
    /// The cell of the sky in a direction of the scene.
    pub cell: &'a (dyn Fn(DVec3) -> u32 + Sync),
}

/// What a ray adds to a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Count {
    /// One to an unknown of its own part.
    Own(u32),
    /// One to another column of the scene.
    Other(u32),
    /// It does not count: something covers its start.
    Covered,
    /// Nothing: it ends on black.
    Nothing,
}

impl SceneColumns<'_> {
    /// What a ray of an instance adds to its row where it lands.
    #[inline(always)]
    pub(super) fn count(
        &self,
        scenery: &Scenery,
        instance: usize,
        ray: &Ray,
        landing: Option<Landing>,
    ) -> Count {
        match landing {
            None => {
                let direction = scenery.placement_of(instance).transform_vector3(ray.direction);
                Count::Other(self.unknowns as u32 + (self.cell)(direction))
            }
            Some(Landing { end: End::Covered, .. }) => Count::Covered,
            Some(Landing { end: End::Black, .. }) => Count::Nothing,
            Some(Landing { end: End::Element(element), instance: met, .. }) => {
                let unknown = scenery.surfaces_of(met).unknown_of(element);
                if met == instance { Count::Own(unknown) } else { Count::Other(self.first[met] + unknown) }
            }
        }
    }
}

impl std::fmt::Debug for SceneColumns<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} unknowns and {} cells", self.unknowns, self.cells)
    }
}

/// The rows of an instance in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedRows {
    /// F_kk, if anything may stand between surfaces of the instance.
    pub self_block: Option<Rows>,
    /// F_kl for l ≠ k and then the cells of the sky, `unknowns × columns of the scene`.
    pub others: Rows,
    /// Rays traced for each row.
    pub traced: Vec<u32>,
}

/// Whether another instance may stand between surfaces of this one, or hold the start of one of its rays.
pub fn may_be_blocked(scenery: &Scenery, instance: usize, escapes: &Escapes) -> bool {
    let blockers = Blockers::new(scenery, instance, escapes);
    (0..escapes.reach.len()).any(|unknown| blockers.may_block(escapes, unknown))
}

/// The boxes, in the coordinates of an instance, of others that may stand between its surfaces.
pub(super) struct Blockers(Vec<Aabb>);

impl Blockers {
    pub(super) fn new(scenery: &Scenery, instance: usize, escapes: &Escapes) -> Self {
        let whole = escapes.reach.iter().map(reach).fold(Aabb::EMPTY, Aabb::union);
        Self(scenery.boxes_near(instance, whole))
    }

    /// Whether one of them may block or cover rays of this unknown.
    fn may_block(&self, escapes: &Escapes, unknown: usize) -> bool {
        let reach = reach(&escapes.reach[unknown]);
        self.0.iter().any(|other| other.meets(&reach))
    }
}

/// Traces what the rays of an instance meet in a scene beyond their own part. `baked`: its rows alone. Fails if the monitor
/// was stopped.
pub fn placed(
    scenery: &Scenery,
    samples: &Samples,
    instance: usize,
    (baked, escapes): (&Rows, &Escapes),
    columns: SceneColumns,
    monitor: &Monitor,
) -> Result<PlacedRows> {
    let blockers = Blockers::new(scenery, instance, escapes);
    let unknowns = scenery.surfaces_of(instance).unknowns();
    let rows = traced(unknowns, monitor, |unknown, scratch| {
        placed_row(Placed { scenery, samples, instance, unknown, columns, scratch }, escapes, &blockers)
    })?;
    let is_corrected = rows.iter().any(|row| row.own.is_some());
    Ok(PlacedRows::of(rows, baked, (samples, columns), is_corrected))
}

impl PlacedRows {
    /// Blocks of these rows. `baked`: F_kk of the part alone; F_kk is kept if `is_corrected`.
    pub(super) fn of(
        rows: Vec<PlacedRow>,
        baked: &Rows,
        (samples, columns): (&Samples, SceneColumns),
        is_corrected: bool,
    ) -> Self {
        let rays = |row: &PlacedRow| samples.rays() as u32 - u32::from(row.covered);
        let own = |(unknown, row): (usize, &PlacedRow)| {
            let counts = row.own.clone().map(|counts| CountedRow { counts, rays: rays(row) });
            counts.unwrap_or_else(|| baked.counted_row(unknown))
        };
        let self_block =
            is_corrected.then(|| Rows::from_counts(rows.len(), rows.iter().enumerate().map(own)));
        let traced = rows.iter().map(|row| row.traced).collect();
        let others = rows.into_iter().map(|row| CountedRow { rays: rays(&row), counts: row.others });
        let others = Rows::from_counts(columns.unknowns + columns.cells, others);
        Self { self_block, others, traced }
    }
}

/// An unknown in a scene.
pub(super) struct Placed<'a> {
    pub scenery: &'a Scenery,
    pub samples: &'a Samples,
    pub instance: usize,
    pub unknown: usize,
    pub columns: SceneColumns<'a>,
    pub scratch: &'a mut Scratch,
}

/// What the rays of an unknown end on in a scene.
#[derive(Default)]
pub(super) struct PlacedRow {
    /// On the own part, if that was traced again.
    pub own: Option<Vec<(u32, u16)>>,
    /// On other columns of the scene.
    pub others: Vec<(u32, u16)>,
    /// Rays that start in something.
    pub covered: u16,
    /// Rays that were traced.
    pub traced: u32,
}

/// Traces the rays of an unknown that may meet another instance.
pub(super) fn placed_row(row: Placed, escapes: &Escapes, blockers: &Blockers) -> PlacedRow {
    let covered = escapes.covered[row.unknown];
    let escaped = escapes.of_row(row.unknown, row.samples.rays() as u32);
    if blockers.may_block(escapes, row.unknown) {
        pulp::Arch::new().dispatch(Whole(row))
    } else if escaped.iter().all(|&bits| bits == 0) {
        PlacedRow { covered, ..PlacedRow::default() }
    } else {
        pulp::Arch::new().dispatch(Escaped { row, escaped, covered })
    }
}

impl Placed<'_> {
    /// Counts where a ray ends.
    #[inline(always)]
    fn land(&mut self, ray: &Ray, landing: Option<Landing>, covered: &mut u16) {
        let Scratch { own, others, .. } = &mut self.scratch;
        match self.columns.count(self.scenery, self.instance, ray, landing) {
            Count::Own(unknown) => own.push(unknown),
            Count::Other(column) => others.push(column),
            Count::Covered => *covered += 1,
            Count::Nothing => {}
        }
    }

    /// The distance up to which a black back covers the start of a ray.
    fn near(&self) -> f64 {
        self.scenery.surfaces_of(self.instance).emitters(self.unknown).bounds().diagonal()
    }

    /// The unknown's rays, and empty lists for where they end.
    #[inline(always)]
    fn begin(&mut self) -> Vec<Ray> {
        let mut rays = std::mem::take(&mut self.scratch.rays);
        let surfaces = self.scenery.surfaces_of(self.instance);
        let emitters = surfaces.emitters(self.unknown);
        emitters.rays(self.samples, emitters.number(), &mut rays);
        self.scratch.own.clear();
        self.scratch.others.clear();
        rays
    }
}

/// All rays of a row.
struct Whole<'a>(Placed<'a>);

impl pulp::NullaryFnOnce for Whole<'_> {
    type Output = PlacedRow;

    #[inline(always)]
    fn call(self) -> PlacedRow {
        let Self(mut row) = self;
        let (rays, near, mut covered) = (row.begin(), row.near(), 0);
        for ray in &rays {
            let landing = row.scenery.land(row.instance, ray, near);
            row.land(ray, landing, &mut covered);
        }
        let traced = rays.len() as u32;
        row.scratch.rays = rays;
        let (own, others) = (tallied(&mut row.scratch.own), tallied(&mut row.scratch.others));
        PlacedRow { own: Some(own), others, covered, traced }
    }
}

/// The rays of a row that leave their own part.
struct Escaped<'a> {
    row: Placed<'a>,
    escaped: &'a [u64],
    covered: u16,
}

impl pulp::NullaryFnOnce for Escaped<'_> {
    type Output = PlacedRow;

    #[inline(always)]
    fn call(self) -> PlacedRow {
        let Self { mut row, escaped, mut covered } = self;
        let (rays, near, mut traced) = (row.begin(), row.near(), 0);
        for (number, ray) in rays.iter().enumerate() {
            if escaped[number / 64] >> (number % 64) & 1 == 1 {
                let landing = row.scenery.land_after(row.instance, ray, None, near);
                row.land(ray, landing, &mut covered);
                traced += 1;
            }
        }
        row.scratch.rays = rays;
        PlacedRow { own: None, others: tallied(&mut row.scratch.others), covered, traced }
    }
}

/// The box around what the rays of a row reach in their part.
pub(super) fn reach(&[a, b, c, d, e, f]: &[f32; 6]) -> Aabb {
    Aabb { low: DVec3::new(a.into(), b.into(), c.into()), high: DVec3::new(d.into(), e.into(), f.into()) }
}

#[cfg(test)]
mod tests {
    use super::super::alone::{AloneRows, alone};
    use super::super::shapes::{part, room, similarity, soup};
    use super::super::surfaces::Surfaces;
    use super::*;
    use proptest::prelude::*;
    use std::sync::{Arc, LazyLock};

    static SAMPLES: LazyLock<Samples> = LazyLock::new(|| Samples::new(256));

    fn placed_rows(scenery: &Scenery, instance: usize, baked: &AloneRows) -> PlacedRows {
        let counts = scenery.unknowns();
        let first: Vec<u32> =
            counts.iter().scan(0, |sum, n| Some(std::mem::replace(sum, *sum + *n as u32))).collect();
        let unknowns = counts.iter().sum();
        let columns = SceneColumns { first: &first, unknowns, cells: 1, cell: &|_| 0 };
        let alone = (&baked.self_block, &baked.escapes);
        placed(scenery, &SAMPLES, instance, alone, columns, &Monitor::default()).expect("not stopped")
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn rows_of_a_closed_room_sum_to_the_number_of_rays(faces in room(), placement in similarity()) {
            let surfaces = Arc::new(Surfaces::new(&part(&faces)));
            let baked = alone(&surfaces, &SAMPLES, &Monitor::default()).expect("not stopped");
            let scenery = Scenery::new([(surfaces, placement)]);
            let rows = placed_rows(&scenery, 0, &baked);
            prop_assert_eq!(rows.self_block, None);
            prop_assert_eq!(rows.others.stored(), 0);
            for unknown in 0..baked.self_block.receivers() {
                prop_assert_eq!(baked.self_block.row_sum(unknown), 1.0);
                prop_assert_eq!(baked.escapes.covered[unknown], 0);
                // No element of a flat face sees itself.
                prop_assert!(baked.self_block.row(unknown).all(|(column, _)| column != unknown));
            }
        }

        /// What a part knows of itself and what a scene adds make the row that rays find in the whole scene, in whole numbers, for
        /// any number of turned, mirrored and scaled things in a room, whatever stands in what.
        #[test]
        fn a_row_is_what_its_rays_find_in_the_whole_scene(
            faces in room(),
            things in proptest::collection::vec((prop_oneof![soup(), room()], similarity()), 1..4),
        ) {
            let others = things.iter().map(|(faces, placement)| (Arc::new(Surfaces::new(&part(faces))), *placement));
            let own = (Arc::new(Surfaces::new(&part(&faces))), glam::DAffine3::IDENTITY);
            let scenery = Scenery::new(std::iter::once(own).chain(others));
            for instance in 0..=things.len() {
                let surfaces = scenery.surfaces_of(instance);
                let baked = alone(surfaces, &SAMPLES, &Monitor::default()).expect("not stopped");
                let rows = placed_rows(&scenery, instance, &baked);
                let own = rows.self_block.as_ref().unwrap_or(&baked.self_block);
                for unknown in 0..surfaces.unknowns() {
                    let whole = whole(&scenery, instance, unknown);
                    prop_assert_eq!(own.counted_row(unknown), whole.0, "own row {} of {}", unknown, instance);
                    prop_assert_eq!(rows.others.counted_row(unknown), whole.1, "row {} of {}", unknown, instance);
                }
            }
        }
    }

    /// A row from nothing: what each ray lands on, one after the other.
    fn whole(scenery: &Scenery, instance: usize, unknown: usize) -> (CountedRow, CountedRow) {
        let counts = scenery.unknowns();
        let first = |instance: usize| counts[..instance].iter().sum::<usize>() as u32;
        let emitters = scenery.surfaces_of(instance).emitters(unknown);
        let (mut rays, mut own, mut others, mut covered) = (vec![], vec![], vec![], 0);
        emitters.rays(&SAMPLES, emitters.number(), &mut rays);
        for ray in &rays {
            match scenery.land(instance, ray, emitters.bounds().diagonal()) {
                None => others.push(first(counts.len())),
                Some(Landing { end: End::Covered, .. }) => covered += 1,
                Some(Landing { end: End::Black, .. }) => {}
                Some(Landing { end: End::Element(element), instance: met, .. }) if met == instance => {
                    own.push(element)
                }
                Some(Landing { end: End::Element(element), instance: met, .. }) => {
                    others.push(first(met) + element)
                }
            }
        }
        let row = |mut hits: Vec<u32>| CountedRow { counts: tallied(&mut hits), rays: 256 - covered };
        (row(own), row(others))
    }
}
