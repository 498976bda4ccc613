//! Light that reaches unknowns by form factors of its own instead of along rows of counted rays: that of emitting surfaces, and
//! what the brightest places near them reflect at once.
//!
//! With B = A + B', only B' travels along the rows: B' = E + ρ (F B' + D) − A, D = F^a A. The form factors F^a, one column a source,
//! are kept like any block. What a source sends is in no key: a lamp that is dimmed costs no rays. Which places are secondary
//! sources follows from geometry alone, as in instant radiosity's (Keller 1997) first generation of virtual lights, but with areas.

use crate::equation::coupling::{Coupled, Coupler};
use crate::gather::glowing::{EmittingSurfaces, surfaces};
use crate::placed_parts::PlacedParts;
use equilux_bake::oven::cached::cached;
use equilux_bake::oven::placed_keys::{SECONDARY_SOURCES, SOURCES};
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::rays::sources::{Effort, Source, form_factors};
use equilux_formats::fingerprint::Content;
use equilux_formats::rows::{Precision, RowGroup};
use equilux_formats::{Element, Error, Result, Rgb, Rows};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Unknowns that share a list of the sources whose light they get by form factors: those that have a ray that ends on one of
/// them. The rays of a source say nothing about those of a receiver, so light of all others, which receivers get along their
/// rows, is neither lost nor counted twice.
const NEIGHBOURS: usize = 512;

/// Unknowns for which it is found out together what stands between them and a source. They share a list of sources.
const BUNDLE: usize = 32;

/// Above this share of the scene's area, emitting surfaces are no sources: nearly everything emits, and rows of counted
/// rays carry it better.
const MOST_EMITTING: f64 = 0.5;

/// Places that see this many times more of the sources than the scene does on average are secondary sources.
const BRIGHT: f64 = 4.0;

/// Secondary sources are at most this share of all elements, the brightest,
const MOST_SECONDARY: f64 = 0.02;

/// or this many in a small scene.
const FEW_SECONDARY: f64 = 64.0;

/// Sources of a scene.
#[derive(Debug)]
pub struct Sources {
    sources: Vec<Source>,
    /// W/m², one row a source; what the values that they were made of say.
    sent: Vec<Rgb>,
    /// For each element of the scene its source; u32::MAX if there is none.
    of_element: Vec<u32>,
    /// The sources on each column of the scene's blocks.
    on_column: Vec<Vec<u32>>,
    /// For each instance, for each run of its unknowns, the sources whose light they get by form factors.
    facing: OnceLock<Vec<Vec<Vec<u32>>>>,
    what: &'static str,
    effort: Effort,
}

impl Sources {
    /// The emitting surfaces of a scene; none if there are none, or almost everything emits. `emission` of all
    /// elements, W/m².
    pub fn emitting(placed: &PlacedParts, emission: &[Rgb]) -> Option<Self> {
        let elements = &placed.world.elements;
        let area = |emits: bool| -> f64 {
            let pairs = elements.iter().zip(emission).filter(|&(_, &e)| !emits || e != Rgb::BLACK);
            pairs.map(|(element, _)| element.area).sum()
        };
        let few = area(true) <= MOST_EMITTING * area(false);
        Self::of(placed, emission, SOURCES, Effort::DIRECT).filter(|_| few)
    }

    /// The places that see much of the sources; none if there are none. `seen`: the sum of the form factors of sources of all
    /// elements.
    pub fn secondary(placed: &PlacedParts, seen: &[f64]) -> Option<Self> {
        let elements = &placed.world.elements;
        let (sum, area) = seen.iter().zip(elements).fold((0.0, 0.0), |(sum, area), (&seen, element)| {
            (sum + seen * element.area, area + element.area)
        });
        let mean = sum / area;
        let most = (elements.len() as f64 * MOST_SECONDARY).max(FEW_SECONDARY) as usize;
        // Places of one surface become one source where they see about as much.
        let class = |seen: f64| (2.0 * (seen / mean).log2()).round();
        let least = brightest(seen, BRIGHT * mean, most);
        let classes = seen.iter().map(|&seen| Rgb([if seen > least { class(seen) } else { 0.0 }; 3]));
        let classes: Vec<Rgb> = classes.collect();
        Self::of(placed, &classes, SECONDARY_SOURCES, Effort::REFLECTED)
    }

    /// Sources where these values of all elements are not black.
    fn of(placed: &PlacedParts, values: &[Rgb], what: &'static str, effort: Effort) -> Option<Self> {
        // The elements of a patch are one source; others are joined where their values are equal.
        let mut single = values.to_vec();
        let mut patches: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        for k in 0..placed.instances.len() {
            let sizes = patch_sizes(placed, k);
            for (place, element) in placed.world.elements_of(k).enumerate() {
                let unknown = placed.unknown_of(k, place);
                if sizes[unknown] > 1 && values[element] != Rgb::BLACK {
                    single[element] = Rgb::BLACK;
                    patches.entry((k, unknown)).or_default().push(element);
                }
            }
        }
        let EmittingSurfaces { elements, emission, mut of_element, .. } = surfaces(placed, &single);
        let mut sources: Vec<Source> =
            elements.into_iter().map(|element| Source::new(vec![element])).collect();
        let mut sent = emission;
        for members in patches.values() {
            let own: Vec<Element> = members.iter().map(|&e| placed.world.elements[e]).collect();
            let area: f64 = own.iter().map(|element| element.area).sum();
            let weighted = members.iter().zip(&own).map(|(&e, element)| values[e] * (element.area / area));
            sent.push(weighted.fold(Rgb::BLACK, |sum, value| sum + value));
            members.iter().for_each(|&element| of_element[element] = sources.len() as u32);
            sources.push(Source::new(own));
        }
        let on_column = on_columns(placed, &of_element);
        (!sources.is_empty()).then_some(Self {
            sources,
            sent,
            of_element,
            on_column,
            facing: OnceLock::new(),
            what,
            effort,
        })
    }

    /// What emitting sources send, W/m².
    pub fn emission(&self) -> &[Rgb] {
        &self.sent
    }

    /// The means over the sources of values of all elements.
    pub fn means(&self, placed: &PlacedParts, values: &[Rgb]) -> Vec<Rgb> {
        let mut sums = vec![(Rgb::BLACK, 0.0); self.sources.len()];
        for ((&source, element), &value) in self.of_element.iter().zip(&placed.world.elements).zip(values) {
            if let Some((sum, area)) = sums.get_mut(source as usize) {
                *sum += value * element.area;
                *area += element.area;
            }
        }
        sums.into_iter().map(|(sum, area)| sum / area).collect()
    }

    /// For each element of the scene what its source sends; black where there is none.
    pub fn spread(&self, sent: &[Rgb]) -> Vec<Rgb> {
        let of = |&source: &u32| sent.get(source as usize).copied().unwrap_or(Rgb::BLACK);
        self.of_element.iter().map(of).collect()
    }

    /// F^a of an instance, `unknowns × sources`, and the number of form factors computed. Fails if the monitor was stopped.
    pub fn rows(
        &self,
        coupler: &Coupler,
        scenery: &Scenery,
        coupled: &[Coupled],
        instance: usize,
    ) -> Result<(Rows, usize)> {
        let which: Vec<u8> = self.of_element.iter().flat_map(|source| source.to_le_bytes()).collect();
        let sources = Content::new().bytes(which).digest();
        let manifest = coupler.manifest(instance, self.what).digest("sources", sources);
        let name = coupler.name(instance, self.what);
        let mut computed = 0;
        let (rows, _) = cached(coupler.store, &name, &manifest, coupler.monitor, || {
            let rows = self.traced(coupler, scenery, coupled, instance)?;
            computed = rows.stored();
            Ok(rows)
        })?;
        Ok((rows, computed))
    }

    fn traced(
        &self,
        coupler: &Coupler,
        scenery: &Scenery,
        coupled: &[Coupled],
        instance: usize,
    ) -> Result<Rows> {
        let (placed, monitor) = (coupler.placed, coupler.monitor);
        let blocks = Blocks { placed, coupled };
        let facing = self.facing.get_or_init(|| self.facing(&blocks));
        let rays = coupler.resolution.rays.unwrap_or(1);
        // The light is the average over what is not covered; what is not met by form factors arrives along the row.
        let row = |unknown: usize, near: &[u32], seen: Vec<(u32, f64)>| {
            let open = blocks.own(instance).share_of_rays(unknown, rays);
            let mut row: BTreeMap<u32, f64> = seen
                .into_iter()
                .map(|(source, value)| (source, if open > 0.0 { value / open } else { 0.0 }))
                .collect();
            for (column, value) in blocks.row(instance, unknown) {
                let others =
                    self.on_column[column].iter().filter(|source| near.binary_search(source).is_err());
                others.for_each(|&source| *row.entry(source).or_default() += value);
            }
            row.into_iter().collect()
        };
        let unknowns = placed.unknowns_of(instance);
        let bundle = |number: usize| -> Vec<Vec<(u32, f64)>> {
            if monitor.stopped() {
                return vec![];
            }
            let first = number * BUNDLE;
            let near = &facing[instance][first / NEIGHBOURS];
            let sources: Vec<(u32, &Source)> = near.iter().map(|&n| (n, &self.sources[n as usize])).collect();
            let bundle = first..unknowns.min(first + BUNDLE);
            let seen = form_factors(scenery, instance, bundle.clone(), &sources, self.effort);
            bundle.zip(seen).map(|(unknown, seen)| row(unknown, near, seen)).collect()
        };
        let bundles = (0..unknowns.div_ceil(BUNDLE)).into_par_iter();
        let rows: Vec<Vec<(u32, f64)>> = bundles.flat_map_iter(bundle).collect();
        if monitor.stopped() {
            return Err(Error::Stopped);
        }
        let group = |row: Vec<(u32, f64)>| {
            let (columns, values) = row.into_iter().unzip();
            RowGroup { columns, values, receivers: 1 }
        };
        Ok(Rows::from_groups(self.sources.len(), rows.into_iter().map(group), Precision::Single))
    }

    /// For each instance, for each of its runs of [`NEIGHBOURS`] unknowns, the sources that have a ray that ends on one of them.
    fn facing(&self, blocks: &Blocks) -> Vec<Vec<Vec<u32>>> {
        let placed = blocks.placed;
        let runs = |k: usize| vec![vec![]; placed.unknowns_of(k).div_ceil(NEIGHBOURS)];
        let mut facing: Vec<Vec<Vec<u32>>> = (0..placed.instances.len()).map(runs).collect();
        for instance in 0..placed.instances.len() {
            let first = placed.columns_of(instance).start;
            for unknown in 0..placed.unknowns_of(instance) {
                for &source in &self.on_column[first + unknown] {
                    for (column, _) in blocks.row(instance, unknown) {
                        let met = placed.instance_of_column(column);
                        let run = (column - placed.columns_of(met).start) / NEIGHBOURS;
                        let known: &mut Vec<u32> = &mut facing[met][run];
                        if known.last() != Some(&source) {
                            known.push(source);
                        }
                    }
                }
            }
        }
        for known in facing.iter_mut().flatten() {
            known.sort_unstable();
            known.dedup();
        }
        facing
    }
}

/// The blocks of a scene.
struct Blocks<'a> {
    placed: &'a PlacedParts,
    coupled: &'a [Coupled],
}

impl Blocks<'_> {
    /// F_kk of an instance.
    fn own(&self, instance: usize) -> &Rows {
        self.coupled[instance].self_block(&self.placed.part_of(instance).part.self_block)
    }

    /// The whole row of an unknown of an instance: columns of the scene and form factors.
    fn row(&self, instance: usize, unknown: usize) -> impl Iterator<Item = (usize, f64)> {
        let first = self.placed.columns_of(instance).start;
        let own = self.own(instance).row(unknown).map(move |(column, value)| (first + column, value));
        own.chain(self.coupled[instance].coupling.row(unknown))
    }
}

/// The value above `least` that no more than `most` of these values exceed.
fn brightest(values: &[f64], least: f64, most: usize) -> f64 {
    let mut above: Vec<f64> = values.iter().copied().filter(|&value| value > least).collect();
    above.sort_by(f64::total_cmp);
    above.len().checked_sub(most + 1).map_or(least, |last| above[last])
}

/// The number of elements of each unknown of an instance.
fn patch_sizes(placed: &PlacedParts, instance: usize) -> Vec<u32> {
    let mut sizes = vec![0; placed.unknowns_of(instance)];
    let elements = 0..placed.world.elements_of(instance).len();
    elements.for_each(|element| sizes[placed.unknown_of(instance, element)] += 1);
    sizes
}

/// The sources on each column of the scene's blocks.
fn on_columns(placed: &PlacedParts, of_element: &[u32]) -> Vec<Vec<u32>> {
    let mut on_column = vec![vec![]; placed.columns()];
    for instance in 0..placed.instances.len() {
        let first = placed.columns_of(instance).start;
        for (place, element) in placed.world.elements_of(instance).enumerate() {
            let source = of_element[element];
            let known: &mut Vec<u32> = &mut on_column[first + placed.unknown_of(instance, place)];
            if source != u32::MAX && !known.contains(&source) {
                known.push(source);
            }
        }
    }
    on_column
}
