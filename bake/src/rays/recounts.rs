//! Rows after an edit: what the rays that an edit concerns end on is counted in the scene before and after it, and the
//! difference is added to the rows. They are the rows from nothing, in whole numbers.
//!
//! An edit concerns the rays that pass a box around something that came or went. Rows whose rays all end within boxes that meet
//! none of those are not looked at.

use super::counts::{
    Blockers, Count, Placed, PlacedRow, PlacedRows, SceneColumns, may_be_blocked, placed_row, reach,
};
use super::samples::Samples;
use super::scenery::{Scenery, moved};
use super::tracing::{Scratch, traced};
use super::wide_tree::Ray;
use crate::geometry::aabb::Aabb;
use crate::geometry::tolerance::SAME_HIT;
use crate::monitor::Monitor;
use equilux_formats::baked::Escapes;
use equilux_formats::{Result, Rows};
use std::collections::BTreeMap;

/// A scene before and after an edit.
#[derive(Debug)]
pub struct Edit<'a> {
    before: Side<'a>,
    after: Side<'a>,
    /// Boxes around what came or went, in scene coordinates.
    changed: Vec<Aabb>,
    /// For each column before, the column after; u32::MAX if it is gone.
    column_after: Vec<u32>,
}

/// A scene and what its columns stand for.
pub type Side<'a> = (&'a Scenery, SceneColumns<'a>);

/// The blocks of an instance before an edit, and what its rays do in its part alone.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// F_kk of the part alone.
    pub baked: &'a Rows,
    /// What the rays may meet in a scene.
    pub escapes: &'a Escapes,
    /// F_kk before the edit, if that differs.
    pub self_block: Option<&'a Rows>,
    /// F_kl and the cells of the sky before the edit.
    pub others: &'a Rows,
}

impl<'a> Edit<'a> {
    /// `stays`: for each instance before, its number after if it has the same part and placement; these numbers rise.
    pub fn new(before: Side<'a>, after: Side<'a>, stays: &[Option<usize>]) -> Self {
        let mut is_new = vec![true; after.1.first.len()];
        stays.iter().flatten().for_each(|&number| is_new[number] = false);
        let gone = (0..stays.len()).filter(|&k| stays[k].is_none()).map(|k| before.0.bounds_of(k));
        let new = (0..is_new.len()).filter(|&k| is_new[k]).map(|k| after.0.bounds_of(k));
        let extent = before.0.bounds().union(after.0.bounds());
        // Hits so near to each other are ties.
        let around = 4.0 * SAME_HIT * extent.diagonal();
        let changed = gone.chain(new).filter(|bounds| !bounds.is_empty()).map(|bounds| bounds.grown(around));
        let changed = changed.collect();
        let mut column_after = Vec::with_capacity(before.1.unknowns + before.1.cells);
        for (k, stays) in stays.iter().enumerate() {
            let unknowns = 0..before.0.surfaces_of(k).unknowns() as u32;
            column_after.extend(unknowns.map(|u| stays.map_or(u32::MAX, |number| after.1.first[number] + u)));
        }
        let cells = 0..before.1.cells as u32;
        column_after.extend(cells.map(|cell| after.1.unknowns as u32 + cell));
        Self { before, after, changed, column_after }
    }

    /// Boxes around what came or went, in scene coordinates.
    pub fn changed(&self) -> &[Aabb] {
        &self.changed
    }

    /// The rows after the edit of an instance of these numbers before and after; none if they are those before it. Fails if
    /// the monitor was stopped.
    pub fn recounted(
        &self,
        samples: &Samples,
        instance: [usize; 2],
        known: Known,
        monitor: &Monitor,
    ) -> Result<Option<PlacedRows>> {
        let view = View::new(self, samples, instance, known);
        let (scenery, columns) = self.after;
        let unknowns = known.others.receivers();
        let changes = traced(unknowns, monitor, |unknown, scratch| view.change(unknown, scratch))?;
        let blockers = Blockers::new(scenery, instance[1], known.escapes);
        let mut scratch = Scratch::default();
        let mut row = |(unknown, change): (usize, &Option<Change>)| {
            view.row(unknown, change.as_ref()).unwrap_or_else(|| {
                let scratch = &mut scratch;
                let placed = Placed { scenery, samples, instance: instance[1], unknown, columns, scratch };
                placed_row(placed, known.escapes, &blockers)
            })
        };
        let is_corrected = may_be_blocked(scenery, instance[1], known.escapes);
        let columns_stay = (0..).zip(&self.column_after).all(|(before, &after)| before == after);
        let columns_stay = columns_stay && self.column_after.len() == columns.unknowns + columns.cells;
        let is_alike = columns_stay && is_corrected == known.self_block.is_some();
        if is_alike && changes.iter().all(|change| change.as_ref().is_none_or(|change| change.is_nothing())) {
            return Ok(None);
        }
        let rows: Vec<PlacedRow> = changes.iter().enumerate().map(&mut row).collect();
        let traced = |change: &Option<Change>| change.as_ref().map_or(0, |change| change.traced);
        Ok(Some(PlacedRows {
            traced: changes.iter().map(traced).collect(),
            ..PlacedRows::of(rows, known.baked, (samples, columns), is_corrected)
        }))
    }
}

/// An edit as an instance sees it.
struct View<'a> {
    edit: &'a Edit<'a>,
    samples: &'a Samples,
    /// The instance before and after.
    instance: [usize; 2],
    known: Known<'a>,
    /// Boxes around what came or went, in the coordinates of the instance.
    changed: Vec<Aabb>,
}

/// What an edit changes in a row.
#[derive(Default)]
struct Change {
    /// By unknown of the own part.
    own: BTreeMap<u32, i32>,
    /// By column before.
    less: BTreeMap<u32, i32>,
    /// By column after.
    more: BTreeMap<u32, i32>,
    covered: i32,
    traced: u32,
}

impl Change {
    fn is_nothing(&self) -> bool {
        let all = self.own.values().chain(self.less.values()).chain(self.more.values());
        all.chain([&self.covered]).all(|&change| change == 0)
    }
}

impl<'a> View<'a> {
    fn new(edit: &'a Edit, samples: &'a Samples, instance: [usize; 2], known: Known<'a>) -> Self {
        let inverse = edit.after.0.placement_of(instance[1]).inverse();
        let changed = edit.changed.iter().map(|bounds| moved(*bounds, &inverse)).collect();
        Self { edit, samples, instance, known, changed }
    }

    /// F_kk before the edit.
    fn own(&self) -> &'a Rows {
        self.known.self_block.unwrap_or(self.known.baked)
    }

    /// What the edit changes in a row; none if no ray of it can be concerned.
    fn change(&self, unknown: usize, scratch: &mut Scratch) -> Option<Change> {
        let escapes = self.known.escapes;
        let escaped = escapes.of_row(unknown, self.samples.rays() as u32);
        let own = reach(&escapes.reach[unknown]);
        let may_matter = self.changed.iter().any(|bounds| bounds.meets(&own))
            || escaped.iter().any(|&bits| bits != 0) && self.may_reach_a_change(unknown);
        may_matter.then(|| pulp::Arch::new().dispatch(Recount { view: self, unknown, escaped, scratch }))
    }

    /// Whether rays of a row that leave their part may have passed what went, or may pass what came: they stayed within the
    /// boxes of what they ended on.
    fn may_reach_a_change(&self, unknown: usize) -> bool {
        let (scenery, SceneColumns { first, unknowns, .. }) = self.edit.before;
        let others = self.known.others.counted_row(unknown);
        let own = self.own().counted_row(unknown);
        let counted: u32 = own.counts.iter().chain(&others.counts).map(|&(_, count)| u32::from(count)).sum();
        let last = others.counts.last().map_or(0, |&(column, _)| column as usize);
        // Where the others ended is not known.
        if counted != others.rays || last >= unknowns {
            return true;
        }
        let mut around = scenery.bounds_of(self.instance[0]);
        let mut columns = others.counts.iter().map(|&(column, _)| column).peekable();
        while let Some(column) = columns.next() {
            let met = first.partition_point(|&first| first <= column) - 1;
            around = around.union(scenery.bounds_of(met));
            let end = first.get(met + 1).copied().unwrap_or(u32::MAX);
            while columns.next_if(|&column| column < end).is_some() {}
        }
        self.edit.changed.iter().any(|bounds| bounds.meets(&around))
    }

    /// The row after the edit; none if it does not follow from the one before.
    fn row(&self, unknown: usize, change: Option<&Change>) -> Option<PlacedRow> {
        let [own, others] = [self.own(), self.known.others].map(|rows| rows.counted_row(unknown));
        let covered = self.samples.rays() as i32 - others.rays as i32;
        let after = |column: u32| self.edit.column_after[column as usize];
        let Some(change) = change.filter(|change| !change.is_nothing()) else {
            let moved = others.counts.into_iter().map(|(column, count)| (after(column), count));
            let others: Vec<(u32, u16)> = moved.collect();
            let is_whole = others.iter().all(|&(column, _)| column != u32::MAX);
            return is_whole.then_some(PlacedRow {
                own: Some(own.counts),
                others,
                covered: covered as u16,
                traced: 0,
            });
        };
        let (mut counts, mut less) = (change.more.clone(), change.less.clone());
        for (column, count) in others.counts {
            let left = i32::from(count) + less.remove(&column).unwrap_or(0);
            match after(column) {
                u32::MAX if left != 0 => return None,
                u32::MAX => {}
                after => *counts.entry(after).or_default() += left,
            }
        }
        let mut owned = change.own.clone();
        own.counts.iter().for_each(|&(of, count)| *owned.entry(of).or_default() += i32::from(count));
        less.values().all(|&left| left == 0).then_some(())?;
        Some(PlacedRow {
            own: Some(positive(owned)?),
            others: positive(counts)?,
            covered: u16::try_from(covered + change.covered).ok()?,
            traced: 0,
        })
    }
}

/// These counts without zeros; none if one is negative.
fn positive(counts: BTreeMap<u32, i32>) -> Option<Vec<(u32, u16)>> {
    let counts = counts.into_iter().filter(|&(_, count)| count != 0);
    counts.map(|(column, count)| Some((column, u16::try_from(count).ok()?))).collect()
}

/// The rays of a row that an edit concerns, before and after it.
struct Recount<'a> {
    view: &'a View<'a>,
    unknown: usize,
    escaped: &'a [u64],
    scratch: &'a mut Scratch,
}

impl pulp::NullaryFnOnce for Recount<'_> {
    type Output = Change;

    #[inline(always)]
    fn call(self) -> Change {
        let Self { view, unknown, escaped, scratch } = self;
        let Edit { before, after, column_after, .. } = view.edit;
        let surfaces = after.0.surfaces_of(view.instance[1]);
        let emitters = surfaces.emitters(unknown);
        let near = emitters.bounds().diagonal();
        emitters.rays(view.samples, emitters.number(), &mut scratch.rays);
        let mut change = Change::default();
        for (number, ray) in scratch.rays.iter().enumerate() {
            let passed = view.changed.iter().map(|bounds| entry(bounds, ray));
            let passed = passed.fold(f64::INFINITY, f64::min);
            if passed == f64::INFINITY {
                continue;
            }
            let escapes = escaped[number / 64] >> (number % 64) & 1 == 1;
            let own = if escapes { None } else { surfaces.tree.first(ray, f64::INFINITY) };
            if own.as_ref().is_some_and(|hit| hit.t < passed) {
                continue;
            }
            change.traced += 1;
            let count = |(scenery, columns): &Side, instance: usize| {
                columns.count(scenery, instance, ray, scenery.land_after(instance, ray, own, near))
            };
            let [was, is] = [count(before, view.instance[0]), count(after, view.instance[1])];
            let stays = match was {
                Count::Other(column) => match column_after[column as usize] {
                    u32::MAX => false,
                    after => is == Count::Other(after),
                },
                other => is == other,
            };
            if !stays {
                change.add(was, -1);
                change.add(is, 1);
            }
        }
        change
    }
}

impl Change {
    fn add(&mut self, count: Count, by: i32) {
        match count {
            Count::Own(unknown) => *self.own.entry(unknown).or_default() += by,
            Count::Other(column) if by < 0 => *self.less.entry(column).or_default() += by,
            Count::Other(column) => *self.more.entry(column).or_default() += by,
            Count::Covered => self.covered += by,
            Count::Nothing => {}
        }
    }
}

/// Where on a ray it enters a box; infinity if it misses it.
#[inline(always)]
fn entry(bounds: &Aabb, ray: &Ray) -> f64 {
    let (mut from, mut to) = (0.0_f64, f64::INFINITY);
    for axis in 0..3 {
        let inverse = 1.0 / ray.direction[axis];
        let [a, b] = [bounds.low[axis], bounds.high[axis]].map(|plane| (plane - ray.origin[axis]) * inverse);
        // A ray within one of the planes gives no number, which min and max pass over.
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    if from <= to { from } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use super::super::alone::{AloneRows, alone};
    use super::super::counts::placed;
    use super::super::shapes::{part, room, similarity, soup};
    use super::super::surfaces::Surfaces;
    use super::*;
    use glam::DAffine3;
    use proptest::prelude::*;
    use std::sync::{Arc, LazyLock};

    static SAMPLES: LazyLock<Samples> = LazyLock::new(|| Samples::new(256));

    struct Level {
        scenery: Scenery,
        first: Vec<u32>,
        unknowns: usize,
    }

    impl Level {
        fn new(things: &[(Arc<Surfaces>, DAffine3)]) -> Self {
            let scenery = Scenery::new(things.iter().cloned());
            let counts = scenery.unknowns();
            let first = (0..counts.len()).map(|k| counts[..k].iter().sum::<usize>() as u32).collect();
            Self { scenery, first, unknowns: counts.iter().sum() }
        }

        fn side(&self) -> Side<'_> {
            let cell = &|direction: glam::DVec3| u32::from(direction.x > 0.0);
            (&self.scenery, SceneColumns { first: &self.first, unknowns: self.unknowns, cells: 2, cell })
        }

        /// The rows of an instance from nothing.
        fn rows(&self, instance: usize, baked: &AloneRows) -> PlacedRows {
            let alone = (&baked.self_block, &baked.escapes);
            let (scenery, columns) = self.side();
            placed(scenery, &SAMPLES, instance, alone, columns, &Monitor::default()).expect("not stopped")
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Rooms and soups that stand in each other, some of which come, go, or move: an edit leaves the rows that the scene after it
        /// has from nothing.
        #[test]
        fn rows_after_an_edit_are_those_from_nothing(
            things in prop::collection::vec((prop_oneof![soup(), room()], similarity(), similarity(), 0..6), 2..6),
        ) {
            let placed = things.iter().map(|(faces, here, there, what)| {
                (Arc::new(Surfaces::new(&part(faces))), *here, *there, *what)
            });
            let placed: Vec<(Arc<Surfaces>, DAffine3, DAffine3, i32)> = placed.collect();
            let (mut old, mut new, mut stays) = (vec![], vec![], vec![]);
            for (surfaces, here, there, what) in placed {
                let number = new.len();
                match what {
                    0 => new.push((surfaces, here)),
                    1 => {
                        old.push((surfaces, here));
                        stays.push(None);
                    }
                    2 => {
                        old.push((surfaces.clone(), here));
                        new.push((surfaces, there));
                        stays.push(None);
                    }
                    _ => {
                        old.push((surfaces.clone(), here));
                        new.push((surfaces, here));
                        stays.push(Some(number));
                    }
                }
            }
            let (before, after) = (Level::new(&old), Level::new(&new));
            let edit = Edit::new(before.side(), after.side(), &stays);
            for (k, number) in stays.iter().enumerate().filter_map(|(k, number)| Some((k, (*number)?))) {
                let baked = alone(&old[k].0, &SAMPLES, &Monitor::default()).expect("not stopped");
                let was = before.rows(k, &baked);
                let is = after.rows(number, &baked);
                let known = Known {
                    baked: &baked.self_block,
                    escapes: &baked.escapes,
                    self_block: was.self_block.as_ref(),
                    others: &was.others,
                };
                let found = edit.recounted(&SAMPLES, [k, number], known, &Monitor::default()).expect("not stopped");
                let found = found.unwrap_or(was);
                prop_assert_eq!(found.self_block, is.self_block);
                prop_assert_eq!(found.others, is.others);
            }
        }
    }
}
