//! Which surfaces are sources: their light reaches unknowns by form factors of its own instead of along rows of counted rays. They
//! are emitting surfaces, and the brightest places near them for what these reflect at once.
//!
//! With B = A + B', only B' travels along the rows: B' = E + ρ (F B' + D) − A, D = F^a A. Which places are secondary sources follows
//! from geometry alone, as in instant radiosity's (Keller 1997) first generation of virtual lights, but with areas.

use crate::gather::glowing::{EmittingSurfaces, surfaces};
use crate::placed_parts::PlacedParts;
use equilux_bake::geometry::disjoint_sets::DisjointSets;
use equilux_bake::oven::placed_keys::{SECONDARY_SOURCES, SOURCES};
use equilux_bake::rays::sources::{Effort, Source};
use equilux_formats::fingerprint::{Content, Digest};
use equilux_formats::{Element, Rgb};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Above this share of the scene's area, emitting surfaces are no sources: nearly everything emits, and rows of counted
/// rays carry it better.
const MOST_EMITTING: f64 = 0.5;

/// Places that see this many times more of the sources than the scene does on average are secondary sources.
const BRIGHT: f64 = 4.0;

/// Secondary sources are at most this share of all elements, the brightest,
const MOST_SECONDARY: f64 = 0.02;

/// or this many in a small scene.
const FEW_SECONDARY: f64 = 64.0;

/// The most sources that are one body.
const MOST_OF_BODY: usize = 16;

/// Sources of a scene.
#[derive(Debug)]
pub struct Sources {
    /// The surfaces, in scene coordinates.
    pub sources: Vec<Source>,
    /// W/m², one row a source; what the values that they were made of say.
    sent: Vec<Rgb>,
    /// For each element of the scene its source; u32::MAX if there is none.
    of_element: Vec<u32>,
    /// The sources on each column of the scene's blocks.
    pub on_column: Vec<Vec<u32>>,
    /// For each source those of its body.
    pub body_of: Vec<Vec<u32>>,
    /// The kind of the blocks of form factors to them.
    pub what: &'static str,
    /// The number of shadow rays.
    pub effort: Effort,
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
        let sources = Self::of(placed, emission, SOURCES, Effort::DIRECT).filter(|_| few)?;
        Some(Self { body_of: bodies(&sources.sources), ..sources })
    }

    /// The places that see much of the sources; none if there are none. `seen`: the sum of the form factors of sources of all
    /// elements.
    pub fn secondary(placed: &PlacedParts, seen: &[f64]) -> Option<Self> {
        let elements = &placed.world.elements;
        let (sum, area) = seen.iter().zip(elements).fold((0.0, 0.0), |(sum, area), (&seen, element)| {
            (sum + seen * element.area, area + element.area)
        });
        // In steps, so that an edit seldom changes which places far from it are sources.
        let mean = in_steps(sum / area, f64::round);
        let most = (elements.len() as f64 * MOST_SECONDARY).max(FEW_SECONDARY) as usize;
        // Places of one surface become one source where they see about as much.
        let class = |seen: f64| (2.0 * (seen / mean).log2()).round();
        let least = in_steps(brightest(seen, BRIGHT * mean, most), f64::ceil);
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
        let sources = told_apart(sources);
        let on_column = on_columns(placed, &of_element);
        let body_of = (0..sources.len() as u32).map(|source| vec![source]).collect();
        (!sources.is_empty()).then_some(Self { sources, sent, of_element, on_column, body_of, what, effort })
    }

    /// The source of an element of the scene.
    pub fn of_element_at(&self, element: usize) -> Option<u32> {
        Some(self.of_element[element]).filter(|&source| source != u32::MAX)
    }

    /// What the keys of their blocks record: which elements of the scene belong to which source.
    pub fn digest(&self) -> Digest {
        let which: Vec<u8> = self.of_element.iter().flat_map(|source| source.to_le_bytes()).collect();
        Content::new().bytes(which).digest()
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
}

/// The value above `least` that no more than `most` of these values exceed.
fn brightest(values: &[f64], least: f64, most: usize) -> f64 {
    let mut above: Vec<f64> = values.iter().copied().filter(|&value| value > least).collect();
    above.sort_by(f64::total_cmp);
    above.len().checked_sub(most + 1).map_or(least, |last| above[last])
}

/// A number rounded to a power of two, or of these steps between powers of two.
fn in_steps(number: f64, round: fn(f64) -> f64) -> f64 {
    const STEPS: f64 = 8.0;
    (round(number.log2() * STEPS) / STEPS).exp2()
}

/// For each source those that are joined to it by common corners, such as the sides of a lamp; itself alone if they are many.
fn bodies(sources: &[Source]) -> Vec<Vec<u32>> {
    let (mut sets, mut at) = (DisjointSets::new(sources.len()), HashMap::new());
    for (number, source) in sources.iter().enumerate() {
        for corner in source.corners() {
            let corner = (corner + 0.0).to_array().map(f64::to_bits);
            sets.join(number, *at.entry(corner).or_insert(number));
        }
    }
    let mut body_of = vec![vec![]; sources.len()];
    for set in sets.into_sets() {
        let all: Vec<u32> = set.iter().map(|&source| source as u32).collect();
        for &source in &set {
            body_of[source] = if set.len() <= MOST_OF_BODY { all.clone() } else { vec![source as u32] };
        }
    }
    body_of
}

/// Each with an identity of its own, also where several are at one place.
fn told_apart(sources: Vec<Source>) -> Vec<Source> {
    let mut known = HashSet::new();
    let apart = sources.into_iter().map(|mut source| {
        while !known.insert(source.identity()) {
            source = source.next_twin();
        }
        source
    });
    apart.collect()
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
