//! The blocks of an instance by rays: what its escaped rays meet in the scene, and its self block where another instance may
//! stand in between. Whole numbers, the same as from nothing, also where an earlier block is brought up to date.

use crate::equation::coupling::{Corrected, Coupled, Coupler};
use crate::equation::earlier::{EarlierScene, Since};
use crate::gather::sky::SkyCells;
use crate::placed_parts::PlacedParts;
use equilux_bake::oven::cached::{NewValue, Origin, cached_or_revised};
use equilux_bake::oven::placed_keys::{CORRECTED, COUPLING};
use equilux_bake::rays::counts::{PlacedRows, SceneColumns, may_be_blocked, placed};
use equilux_bake::rays::recounts::{Edit, Known, Side};
use equilux_bake::rays::samples::Samples;
use equilux_bake::rays::scenery::Scenery;
use equilux_formats::fingerprint::Key;
use equilux_formats::store::Lookup;
use equilux_formats::{Result, Rows};
use glam::DVec3;
use rayon::prelude::*;
use std::cell::OnceCell;
use std::time::{Duration, Instant};

/// A scene for rays.
#[derive(Debug)]
pub struct RayTracer<'a> {
    /// The surfaces in their places.
    scenery: &'a Scenery,
    /// The rays of a row.
    samples: Samples,
    /// The first column of each instance, and then their number.
    first: Vec<u32>,
    /// The scene of the last run, if it was another, with its columns.
    earlier: Option<(EarlierScene, Vec<u32>)>,
}

/// The cell of the sky in a direction.
fn cell(direction: DVec3) -> u32 {
    SkyCells::towards(direction) as u32
}

/// A scene with columns.
fn side<'a>(scenery: &'a Scenery, first: &'a [u32]) -> Side<'a> {
    let (&unknowns, first) = first.split_last().expect("the number of columns");
    (scenery, SceneColumns { first, unknowns: unknowns as usize, cells: SkyCells::COUNT, cell: &cell })
}

/// Where each of so many columns begins, and the number of all.
fn starts(counts: impl Iterator<Item = usize>) -> Vec<u32> {
    let end = counts.scan(0, |end, count| {
        *end += count as u32;
        Some(*end)
    });
    std::iter::once(0).chain(end).collect()
}

impl<'a> RayTracer<'a> {
    /// The placed parts of a coupler, with so many rays a row.
    pub fn new(coupler: &Coupler<'a>, scenery: &'a Scenery, rays: u32) -> Self {
        let placed: &PlacedParts = coupler.placed;
        let first = starts((0..placed.instances.len()).map(|k| placed.columns_of(k).len()));
        let earlier = EarlierScene::last(coupler, scenery).map(|earlier| {
            let counts = (0..earlier.stays.len()).map(|k| earlier.keys.part_of(k).senders);
            let first = starts(counts);
            (earlier, first)
        });
        let tracer = Self { scenery, samples: Samples::new(rays), first, earlier };
        tracer.read_ahead(coupler);
        tracer
    }

    /// Reads the blocks of the earlier scene on all threads, where those of the present one are missing.
    fn read_ahead(&self, coupler: &Coupler) {
        let Some((earlier, _)) = &self.earlier else { return };
        let blocks = (0..earlier.stays.len()).into_par_iter();
        let missing = |&(present, _): &(Key, Key)| !coupler.store.has::<Rows>(&present);
        let keys = blocks
            .filter_map(|k| Some((k, earlier.stays[k]?)))
            .flat_map_iter(|(k, now)| {
                [COUPLING, CORRECTED]
                    .map(|what| (coupler.manifest(now, what).key(), earlier.keys.manifest(k, what).key()))
            })
            .filter(missing)
            .map(|(_, key)| key);
        coupler.store.read_ahead::<Rows>(&keys.collect::<Vec<_>>());
    }

    /// What changed since the last run; none if nothing did, or too much.
    pub fn edit(&self) -> Option<Edit<'_>> {
        let (earlier, first) = self.earlier.as_ref()?;
        Some(Edit::new(side(&earlier.scenery, first), side(self.scenery, &self.first), &earlier.stays))
    }

    /// The same as light of sources has to know it. `edit`: of this tracer.
    pub fn since<'b>(&'b self, edit: Option<&'b Edit>) -> Since<'b> {
        let earlier = self.earlier.as_ref().zip(edit);
        earlier.map_or(Since::default(), |((earlier, _), edit)| Since::new(earlier, edit.changed()))
    }
}

/// New rows of an instance, and those that they were made from.
struct Traced {
    rows: PlacedRows,
    earlier: Option<Earlier>,
}

/// The blocks of an instance in the earlier scene.
struct Earlier {
    number: usize,
    self_block: Option<Rows>,
    others: Rows,
    /// Of the coupling, and of the self block.
    keys: [Key; 2],
}

impl Coupler<'_> {
    /// Trace or read the blocks of one instance. `edit`: of the tracer. Fails if the monitor was stopped.
    pub fn couple_by_rays(
        &self,
        instance: usize,
        tracer: &RayTracer,
        edit: Option<&Edit>,
    ) -> Result<Coupled> {
        let part = &self.placed.part_of(instance).part;
        let (traced, time) = (OnceCell::new(), OnceCell::new());
        let rows = || -> Result<&Traced> {
            if traced.get().is_none() {
                let start = Instant::now();
                let _ = traced.set(self.traced(instance, tracer, edit)?);
                let _ = time.set(start.elapsed() * rayon::current_num_threads() as u32);
            }
            Ok(traced.get().expect("just traced"))
        };
        let (others, origin) = self.stored(instance, COUPLING, || {
            let Traced { rows, earlier } = rows()?;
            Ok(made(rows.others.clone(), earlier.as_ref().map(|e| (Some(&e.others), e.keys[0]))))
        })?;
        let corrected = may_be_blocked(tracer.scenery, instance, &part.escapes).then(|| {
            self.stored(instance, CORRECTED, || {
                let Traced { rows, earlier } = rows()?;
                let changes =
                    |own: Option<&Rows>| own.unwrap_or(&part.self_block).changes_from(&part.self_block);
                let before = earlier
                    .as_ref()
                    .map(|e| (e.self_block.as_ref().map(|own| changes(Some(own))), e.keys[1]));
                Ok(made(
                    changes(rows.self_block.as_ref()),
                    before.as_ref().map(|(before, key)| (before.as_ref(), *key)),
                ))
            })
        });
        // What only touches the part often changes nothing.
        let corrected = corrected
            .transpose()?
            .and_then(|(changes, origin)| Some((changes.applied_to(&part.self_block)?, origin)))
            .map(|block| self.corrected(instance, block))
            .transpose()?;
        let [coupling, sky] = others.parted(self.placed.columns());
        let computed_by_row = traced.get().map_or(vec![], |traced| traced.rows.traced.clone());
        let rays = computed_by_row.iter().map(|&rays| rays as usize).sum();
        let is_new = !origin.is_reused();
        Ok(Coupled {
            computed: if is_new { coupling.stored() + sky.stored() } else { 0 },
            coupling,
            sky: Some(sky),
            origin,
            computed_by_row,
            rays,
            corrected,
            time: time.get().copied().unwrap_or(Duration::ZERO),
        })
    }

    /// A block of an instance, read or made.
    fn stored(
        &self,
        instance: usize,
        what: &str,
        make: impl FnOnce() -> Result<NewValue<Rows>>,
    ) -> Result<(Rows, Origin)> {
        let (name, manifest) = (self.name(instance, what), self.manifest(instance, what));
        let (rows, origin) = cached_or_revised(self.store, &name, &manifest, self.monitor, make)?;
        Ok((rows, self.explained(origin)))
    }

    /// The rows of an instance, brought up to date or from nothing.
    fn traced(&self, instance: usize, tracer: &RayTracer, edit: Option<&Edit>) -> Result<Traced> {
        let part = &self.placed.part_of(instance).part;
        let name = &self.placed.instances[instance].name;
        let count = self.placed.unknowns_of(instance);
        self.monitor.begin(format!("rays of {name}"), count, count as f64);
        if let Some((edit, earlier)) = edit.zip(self.earlier(instance, tracer)) {
            let known = Known {
                baked: &part.self_block,
                escapes: &part.escapes,
                self_block: earlier.self_block.as_ref(),
                others: &earlier.others,
            };
            let numbers = [earlier.number, instance];
            let rows = edit.recounted(&tracer.samples, numbers, known, self.monitor)?;
            let same = || PlacedRows {
                self_block: earlier.self_block.clone(),
                others: earlier.others.clone(),
                traced: vec![0; count],
            };
            return Ok(Traced { rows: rows.unwrap_or_else(same), earlier: Some(earlier) });
        }
        let (scenery, columns) = side(tracer.scenery, &tracer.first);
        let alone = (&part.self_block, &part.escapes);
        let rows = placed(scenery, &tracer.samples, instance, alone, columns, self.monitor)?;
        Ok(Traced { rows, earlier: None })
    }

    /// The blocks that an instance had in the earlier scene, if it was there and they are in the cache.
    fn earlier(&self, instance: usize, tracer: &RayTracer) -> Option<Earlier> {
        let (earlier, first) = tracer.earlier.as_ref()?;
        let number = earlier.number_of(instance)?;
        let keys =
            [COUPLING, CORRECTED].map(|what| self.store.target(&earlier.keys.manifest(number, what).key()));
        let receivers = self.placed.unknowns_of(instance);
        let load = |key: &Key, senders: usize| match self.store.load::<Rows>(key) {
            // What the cache says of the earlier scene need not agree.
            Lookup::Found(rows) => {
                (rows.receivers() == receivers && rows.senders() == senders).then_some(rows)
            }
            Lookup::Missing | Lookup::Damaged(_) => None,
        };
        let part = &self.placed.part_of(instance).part;
        let is_corrected = may_be_blocked(&earlier.scenery, number, &part.escapes);
        let self_block = if is_corrected {
            let changes = load(&keys[1], receivers)?;
            Some(changes.applied_to(&part.self_block).unwrap_or_else(|| part.self_block.clone()))
        } else {
            None
        };
        let senders = *first.last()? as usize + SkyCells::COUNT;
        Some(Earlier { number, self_block, others: load(&keys[0], senders)?, keys })
    }

    /// The self block of an instance with others between its surfaces, and its local equilibrium.
    fn corrected(&self, instance: usize, (self_block, origin): (Rows, Origin)) -> Result<Corrected> {
        let key = self.store.target(&self.manifest(instance, CORRECTED).key());
        let local = self.corrected_light(instance, key, &self_block)?;
        let intruders = self.intruders(instance);
        let (computed, computed_by_row, time) = (0, vec![], Duration::ZERO);
        Ok(Corrected { self_block, local, intruders, origin, computed, computed_by_row, time })
    }
}

/// The cache entry for a block. `earlier`: the block that it was made from, if there was one, and its key.
fn made(block: Rows, earlier: Option<(Option<&Rows>, Key)>) -> NewValue<Rows> {
    match earlier {
        Some((Some(before), key)) if *before == block => NewValue::AsUnder(key, block),
        Some(_) => NewValue::Revised(block, "rays that the edit concerns".into()),
        None => NewValue::Whole(block),
    }
}
