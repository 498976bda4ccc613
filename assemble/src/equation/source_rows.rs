//! The form factors F^a from unknowns to sources, one column a source, kept like any block. What a source sends is in no key: a
//! lamp that is dimmed costs no rays. After an edit those are kept that it cannot concern.

use crate::equation::coupling::{Coupled, Coupler};
use crate::equation::earlier::Since;
use crate::equation::facing::{Blocks, NEIGHBOURS, facing};
use crate::equation::sources::Sources;
use equilux_bake::oven::cached::{NewValue, cached_or_revised};
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::rays::sources::{Source, bear_on, form_factors};
use equilux_formats::fingerprint::{Digest, Key};
use equilux_formats::rows::{Precision, RowGroup};
use equilux_formats::store::Lookup;
use equilux_formats::{Error, Result, Rows, SourceRows};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::sync::OnceLock;

/// Unknowns for which it is found out together what stands between them and a source. They share a list of sources.
const BUNDLE: usize = 32;

/// The sources near a run of unknowns: identities, rising, and numbers.
type Near = Vec<(u64, u32)>;

/// A row of form factors: columns and values.
type Row = Vec<(u32, f64)>;

/// Form factors to the sources of a scene.
pub struct FactorsOfSources<'a> {
    coupler: &'a Coupler<'a>,
    scenery: &'a Scenery,
    coupled: &'a [Coupled],
    since: Since<'a>,
    sources: &'a Sources,
    /// Which elements are which source.
    which: Digest,
    /// The number of the source of each identity.
    numbers: HashMap<u64, u32>,
    /// For each instance, for each run of its unknowns, the sources near it.
    near: OnceLock<Vec<Vec<Near>>>,
}

impl<'a> FactorsOfSources<'a> {
    /// Those of placed parts with these blocks to `sources`.
    pub fn new(
        coupler: &'a Coupler<'a>,
        (scenery, coupled): (&'a Scenery, &'a [Coupled]),
        since: Since<'a>,
        sources: &'a Sources,
    ) -> Self {
        let numbered = sources.sources.iter().zip(0..);
        let numbers = numbered.map(|(source, number)| (source.identity(), number)).collect();
        let which = sources.digest();
        Self { coupler, scenery, coupled, since, sources, which, numbers, near: OnceLock::new() }
    }

    /// F^a of an instance, `unknowns × sources`, and the number of form factors computed. Fails if the monitor was stopped.
    pub fn rows(&self, instance: usize) -> Result<(Rows, usize)> {
        let coupler = self.coupler;
        let manifest = coupler.manifest(instance, self.sources.what).digest("sources", self.which);
        let name = coupler.name(instance, self.sources.what);
        let mut computed = 0;
        let (found, _) = cached_or_revised(coupler.store, &name, &manifest, coupler.monitor, || {
            let known = self.known(instance);
            let (rows, count) = self.computed(instance, known.as_ref().map(|(rows, _)| rows))?;
            computed = count;
            Ok(match known {
                Some((before, key)) if before == rows => NewValue::AsUnder(key, rows),
                Some(_) => NewValue::Revised(rows, "light that the edit concerns".into()),
                None => NewValue::Whole(rows),
            })
        })?;
        // What the cache says need not agree.
        let found = if self.fits(instance, &found) { found } else { self.computed(instance, None)?.0 };
        Ok((self.whole(instance, &found), computed))
    }

    /// The block that an instance had in the last run, and its key.
    fn known(&self, instance: usize) -> Option<(SourceRows, Key)> {
        let (keys, number) = self.since.before(self.coupler, instance)?;
        let last =
            self.coupler.store.last_manifest(&keys.name(self.coupler.file, number, self.sources.what))?;
        if !last.extends(&keys.manifest(number, self.sources.what)) {
            return None;
        }
        let key = self.coupler.store.target(&last.key());
        match self.coupler.store.load::<SourceRows>(&key) {
            Lookup::Found(rows) => self.has_size_of(instance, &rows).then_some((rows, key)),
            Lookup::Missing | Lookup::Damaged(_) => None,
        }
    }

    fn has_size_of(&self, instance: usize, found: &SourceRows) -> bool {
        let unknowns = self.coupler.placed.unknowns_of(instance);
        found.rows.receivers() == unknowns && found.runs.len() == unknowns.div_ceil(NEIGHBOURS)
    }

    fn fits(&self, instance: usize, found: &SourceRows) -> bool {
        self.has_size_of(instance, found)
            && found.sources.iter().all(|known| self.numbers.contains_key(known))
    }

    /// The form factors of an instance, and how many were computed; the others are those of `known`.
    fn computed(&self, instance: usize, known: Option<&SourceRows>) -> Result<(SourceRows, usize)> {
        let (placed, monitor) = (self.coupler.placed, self.coupler.monitor);
        let near = &self.near.get_or_init(|| self.near())[instance];
        let mut sources: Vec<u64> = near.iter().flatten().map(|&(identity, _)| identity).collect();
        sources.sort_unstable();
        sources.dedup();
        let place = |identity: u64| sources.binary_search(&identity).expect("it is near") as u32;
        let runs: Vec<Vec<u32>> =
            near.iter().map(|run| run.iter().map(|&(identity, _)| place(identity)).collect()).collect();
        let unknowns = placed.unknowns_of(instance);
        let bundle = |number: usize| -> (Vec<Row>, bool) {
            if monitor.stopped() {
                return (vec![], false);
            }
            let bundle = number * BUNDLE..unknowns.min((number + 1) * BUNDLE);
            let run = bundle.start / NEIGHBOURS;
            let own: Vec<(u32, &Source)> = near[run]
                .iter()
                .map(|&(identity, number)| (place(identity), &self.sources.sources[number as usize]))
                .collect();
            let kept = known.and_then(|known| self.kept(instance, bundle.clone(), &own, (known, run)));
            let is_new = kept.is_none();
            let rows = kept
                .unwrap_or_else(|| form_factors(self.scenery, instance, bundle, &own, self.sources.effort));
            (rows, is_new)
        };
        let bundles: Vec<(Vec<Row>, bool)> =
            (0..unknowns.div_ceil(BUNDLE)).into_par_iter().map(bundle).collect();
        if monitor.stopped() {
            return Err(Error::Stopped);
        }
        let stored = |rows: &Vec<Row>| -> usize { rows.iter().map(Vec::len).sum() };
        let computed = bundles.iter().filter(|(_, is_new)| *is_new).map(|(rows, _)| stored(rows)).sum();
        let rows = single(sources.len(), bundles.into_iter().flat_map(|(rows, _)| rows));
        Ok((SourceRows { sources, runs, rows }, computed))
    }

    /// The rows of some unknowns that get their light from `own`, if what changed since they were `known` cannot concern them.
    fn kept(
        &self,
        instance: usize,
        unknowns: Range<usize>,
        own: &[(u32, &Source)],
        (known, run): (&SourceRows, usize),
    ) -> Option<Vec<Row>> {
        let before = known.runs[run].iter().map(|&place| known.sources[place as usize]);
        let is_equal = before.eq(own.iter().map(|(_, source)| source.identity()));
        if !is_equal || bear_on(self.since.changed(), self.scenery, instance, unknowns.clone(), own) {
            return None;
        }
        // Equal lists, so the place in the run tells the source.
        let place = |before: u32| Some(own[known.runs[run].binary_search(&before).ok()?].0);
        let row = |unknown: usize| {
            let row = known.rows.row(unknown);
            row.map(|(before, value)| Some((place(before as u32)?, value))).collect::<Option<Row>>()
        };
        unknowns.map(row).collect()
    }

    /// The light of all sources, as the average over what is not covered: that of sources which are not near arrives along the rows.
    fn whole(&self, instance: usize, found: &SourceRows) -> Rows {
        let blocks = Blocks { placed: self.coupler.placed, coupled: self.coupled };
        let rays = self.coupler.resolution.rays.unwrap_or(1);
        let number = |place: u32| self.numbers[&found.sources[place as usize]];
        let runs = found.runs.iter().map(|run| {
            let mut near: Vec<u32> = run.iter().map(|&place| number(place)).collect();
            near.sort_unstable();
            near
        });
        let runs: Vec<Vec<u32>> = runs.collect();
        let row = |unknown: usize| -> Row {
            let near = &runs[unknown / NEIGHBOURS];
            let open = blocks.own(instance).share_of_rays(unknown, rays);
            let seen = found.rows.row(unknown);
            let seen = seen
                .map(|(place, value)| (number(place as u32), if open > 0.0 { value / open } else { 0.0 }));
            let mut row: BTreeMap<u32, f64> = seen.collect();
            for (column, value) in blocks.row(instance, unknown) {
                let on = self.sources.on_column[column].iter();
                let others = on.filter(|source| near.binary_search(source).is_err());
                others.for_each(|&source| *row.entry(source).or_default() += value);
            }
            row.into_iter().collect()
        };
        let unknowns = 0..self.coupler.placed.unknowns_of(instance);
        let rows: Vec<Row> = unknowns.into_par_iter().map(row).collect();
        single(self.sources.sources.len(), rows)
    }

    /// For each instance, for each of its runs of unknowns, the sources that face it.
    fn near(&self) -> Vec<Vec<Near>> {
        let sources = &self.sources.sources;
        let named = |run: Vec<u32>| -> Near {
            let mut near: Near =
                run.into_iter().map(|source| (sources[source as usize].identity(), source)).collect();
            near.sort_unstable();
            near
        };
        let runs = facing(self.coupler.placed, self.coupled, self.sources);
        runs.into_iter().map(|runs| runs.into_iter().map(named).collect()).collect()
    }
}

/// A block of such rows.
fn single(senders: usize, rows: impl IntoIterator<Item = Row>) -> Rows {
    let group = |row: Row| {
        let (columns, values) = row.into_iter().unzip();
        RowGroup { columns, values, receivers: 1 }
    };
    Rows::from_groups(senders, rows.into_iter().map(group), Precision::Single)
}
