//! The form factor from an unknown to a source, a polygon that shines: the contour integral averaged over the unknown, times the
//! share of shadow rays between the two that nothing stops. Light of small, bright sources arrives without the noise that a
//! hemisphere of rays would give it.
//!
//! ```text
//! F = (1/A) ∫_A contour(x, source) dx × Σ g V / Σ g,   g = cosθ cosθ' / d²
//! ```
//!
//! over pairs of points, one on the unknown and one on the source (Cohen & Wallace 1993, §4.4 for the contour; Campbell & Fussell
//! 1990 for the product).

mod areas;
mod effort;
mod source;

use super::hemisphere::Emitters;
use super::obstacles::{Barrier, Between, Eight, Few, Hull, LANES, between, stopped};
use super::scenery::Scenery;
use super::sobol;
use super::wide_tree::Ray;
use crate::form_factor::contour::form_factor;
use crate::geometry::aabb::Aabb;
use crate::geometry::polygon::{Clipped, clip, distance};
use equilux_formats::Rgb;
use glam::DVec3;
use std::f64::consts::PI;
use std::ops::Range;
use std::sync::LazyLock;

pub use areas::{form_factors_of_areas, in_view, mean_of_point};
pub use effort::Effort;
pub use source::Source;

/// Where the first rays agree, one receiver in so many goes on, and its result counts as often: else what few rays meet
/// would be left out on average.
const GO_ON: u32 = 8;

/// First rays from pieces of surface where each looks for what stops it; neighbours find what these miss.
const FEW_IN_CROWDS: u32 = 16;

/// The finest grid of points at which the contour is taken, along a side.
const FINEST: usize = 16;

/// The fewest points on an unknown that is no parallelogram.
const FEWEST_SCATTERED: usize = 16;

/// Below this many there is one point.
const ONE_POINT: f64 = 0.3;

/// Diameters of an unknown over its distance from the source, for each two points of the grid.
const POINTS_PER_NEARNESS: f64 = 1.5;

/// The form factors from each of some neighbouring unknowns of an instance to those of `sources` that it sees, with their places
/// among them.
pub fn form_factors(
    scenery: &Scenery,
    instance: usize,
    unknowns: Range<usize>,
    sources: &[(u32, &Source)],
    effort: Effort,
) -> Vec<Vec<(u32, f64)>> {
    // The widest vector instructions of the machine; the order of operations, and with it the result, does not change.
    let receivers = Receivers::Unknowns(unknowns);
    pulp::Arch::new().dispatch(Neighbours { scenery, instance, receivers, sources, effort })
}

/// Whether anything within these boxes, in scene coordinates, may bear on the form factors from some neighbouring unknowns of an
/// instance to `sources`.
pub fn bear_on(
    boxes: &[Aabb],
    scenery: &Scenery,
    instance: usize,
    unknowns: Range<usize>,
    sources: &[(u32, &Source)],
) -> bool {
    let here = Hull::around(unknowns.map(|unknown| scenery.surfaces_of(instance).emitters(unknown)));
    let to_here = scenery.placement_of(instance).inverse();
    let is_reached = |&(_, source): &(u32, &Source)| {
        let there = Hull::around(std::iter::once(&source.moved(to_here).places));
        let reached = here.around_both(&there, scenery, instance);
        boxes.iter().any(|bounds| bounds.meets(&reached))
    };
    !boxes.is_empty() && sources.iter().any(is_reached)
}

/// The mean of `light` over so many places on an unknown of an instance: of a place and its normal, in scene coordinates.
pub fn mean_over(
    scenery: &Scenery,
    (instance, unknown): (usize, usize),
    places: u32,
    light: impl Fn(DVec3, DVec3) -> Rgb,
) -> Rgb {
    let receiver = Receiver::new(scenery, instance, unknown);
    let placement = scenery.placement_of(instance);
    let at = |k: u32| {
        let (u, v) = receiver.scattered(k as usize);
        let (place, normal) = receiver.area.place(u, v);
        light(placement.transform_point3(place), placement.transform_vector3(normal).normalize())
    };
    (0..places).map(at).fold(Rgb::BLACK, |sum, light| sum + light) / f64::from(places)
}

/// For each receiver the sources that it sees, and the form factors.
type Rows = Vec<Vec<(u32, f64)>>;

/// What receives light.
enum Receivers<'a> {
    /// Unknowns of the instance.
    Unknowns(Range<usize>),
    /// Pieces of its surface, and a number that chooses places on all of them.
    Areas { areas: &'a [&'a Emitters], number: u32 },
}

impl<'a> Receivers<'a> {
    fn all(&self, scenery: &'a Scenery, instance: usize) -> Vec<Receiver<'a>> {
        match self {
            Self::Unknowns(unknowns) => {
                unknowns.clone().map(|unknown| Receiver::new(scenery, instance, unknown)).collect()
            }
            &Self::Areas { areas, number } => {
                let receiver = |&area| Receiver { scenery, instance, number, area, goes_on: false };
                areas.iter().map(receiver).collect()
            }
        }
    }
}

struct Neighbours<'a> {
    scenery: &'a Scenery,
    instance: usize,
    receivers: Receivers<'a>,
    sources: &'a [(u32, &'a Source)],
    effort: Effort,
}

impl pulp::NullaryFnOnce for Neighbours<'_> {
    type Output = Rows;

    #[inline(always)]
    fn call(self) -> Rows {
        let Self { scenery, instance, receivers, sources, effort } = self;
        let receivers = receivers.all(scenery, instance);
        let here = Hull::around(receivers.iter().map(|receiver| receiver.area));
        let to_here = scenery.placement_of(instance).inverse();
        let mut candidates = Vec::with_capacity(sources.len());
        for &(number, source) in sources {
            let source = source.moved(to_here);
            let hull = Hull::around(std::iter::once(&source.places));
            let between = between(scenery, instance, &here, &hull);
            if !matches!(between, Between::Hidden) {
                candidates.push(Candidate { number, source, hull, between });
            }
        }
        let mut rows = Vec::with_capacity(receivers.len());
        for receiver in &receivers {
            rows.push(receiver.form_factors(&candidates, effort));
        }
        rows
    }
}

/// A source that some neighbouring unknowns may see, in the coordinates of their instance.
struct Candidate {
    number: u32,
    source: Source,
    hull: Hull,
    between: Between<Vec<Barrier>>,
}

/// An unknown of an instance, or a piece of its surface, in the coordinates of that.
struct Receiver<'a> {
    scenery: &'a Scenery,
    instance: usize,
    /// Chooses places on it.
    number: u32,
    area: &'a Emitters,
    /// Whether some more rays are traced where the first agree.
    goes_on: bool,
}

impl<'a> Receiver<'a> {
    fn new(scenery: &'a Scenery, instance: usize, unknown: usize) -> Self {
        let area = scenery.surfaces_of(instance).emitters(unknown);
        Self { scenery, instance, number: area.number(), area, goes_on: true }
    }

    #[inline(always)]
    fn form_factors(&self, candidates: &[Candidate], effort: Effort) -> Vec<(u32, f64)> {
        let hull = Hull::around(std::iter::once(self.area));
        let mut open = Vec::with_capacity(candidates.len());
        for candidate in candidates {
            let between = candidate.between.narrowed(&hull, &candidate.hull);
            if matches!(between, Between::Hidden) {
                continue;
            }
            let unoccluded = self.unoccluded(&candidate.source);
            if unoccluded > 0.0 {
                open.push((Sight { receiver: self, candidate, between }, unoccluded));
            }
        }
        let most = open.iter().map(|&(_, f)| f).fold(0.0, f64::max);
        let mut seen = Vec::with_capacity(open.len());
        for (sight, unoccluded) in &open {
            // Errors of independent sources add up as squares, so the weaker need fewer rays.
            let importance = unoccluded / most;
            let importance = if self.goes_on { importance.sqrt() } else { importance };
            let rays = [0, 1].map(|k| (effort.most[k] * importance).max(effort.fewest[k]).ceil() as u32);
            let Candidate { number, source, .. } = sight.candidate;
            let value = match source.polygon() {
                Some(_) => unoccluded * sight.visible(rays),
                None => sight.counted(rays[1]),
            };
            if value != 0.0 {
                seen.push((*number, value));
            }
        }
        seen
    }

    /// The average of the contour integral over it, nothing being in the way. Of several polygons a rough value, which decides
    /// on the number of rays alone.
    fn unoccluded(&self, source: &Source) -> f64 {
        let Some(polygon) = source.polygon() else { return self.roughly(source) };
        let corners = polygon.corners.as_slice();
        let bounds = self.area.bounds();
        let size = bounds.diagonal();
        let apart = (distance(bounds.centre(), corners) - size / 2.0).max(size / 16.0);
        let nearness = POINTS_PER_NEARNESS * size / apart;
        let pairs = (nearness.ceil() as usize).clamp(1, FINEST / 2);
        // Two Gauss points in each interval; one if it is small and far.
        let points = if nearness < ONE_POINT { 1 } else { 2 * pairs };
        let at = |k: usize| {
            let off = if k.is_multiple_of(2) { 0.211_324_865_405_187_1 } else { 0.788_675_134_594_812_9 };
            if points == 1 { 0.5 } else { ((k / 2) as f64 + off) / pairs as f64 }
        };
        // A grid would meet only some pieces of a patch, and not the middle of a triangle.
        let is_grid = self.area.is_parallelogram();
        let count = if is_grid { points * points } else { FEWEST_SCATTERED.max(points * points) };
        let mut sum = 0.0;
        for k in 0..count {
            let (u, v) = if is_grid { (at(k % points), at(k / points)) } else { self.scattered(k) };
            let (point, normal) = self.area.place(u, v);
            if polygon.normal.dot(point - corners[0]) <= 0.0 {
                continue;
            }
            let seen: smallvec::SmallVec<[DVec3; 8]> = corners.iter().map(|&p| p - point).collect();
            sum += match clip(&seen, |p| normal.dot(p)) {
                Clipped::All => form_factor(&seen, normal),
                Clipped::Piece(above) => form_factor(&above, normal),
                Clipped::None => 0.0,
            };
        }
        sum / count as f64
    }

    /// The kth of places that are spread evenly over it, whatever its form.
    fn scattered(&self, k: usize) -> (f64, f64) {
        let [u, v, ..] = places(k as u32, self.seed(0));
        (u, v)
    }

    /// A/π d², at most 1.
    fn roughly(&self, source: &Source) -> f64 {
        let apart = (source.places.bounds().centre() - self.area.bounds().centre()).length_squared();
        source.area / (source.area + PI * apart)
    }

    /// A number for the rays to a source of this identity.
    #[inline(always)]
    fn seed(&self, source: u64) -> u32 {
        sobol::hash(self.number ^ sobol::hash(source as u32 ^ 0x2545_f491))
    }
}

/// A source from an unknown.
struct Sight<'a> {
    receiver: &'a Receiver<'a>,
    candidate: &'a Candidate,
    between: Between<Few<'a>>,
}

impl Sight<'_> {
    /// The share of the light of a polygon that arrives, by so many rays at first and in all.
    #[inline(always)]
    fn visible(&self, [mut first, all]: [u32; 2]) -> f64 {
        if matches!(self.between, Between::Crowd) && !self.receiver.goes_on {
            first = first.min(FEW_IN_CROWDS);
        }
        if matches!(&self.between, Between::Plates(few) if few.is_empty()) {
            return 1.0;
        }
        let [sum, open] = self.shadow_rays(0..first);
        let (mut agreed, mut weight_of_more) = (0.0, 1.0);
        if sum > 0.0 && (open == 0.0 || open == sum) {
            // What the first rays agree on, and how much a later disagreement counts.
            agreed = open / sum;
            let seed = self.receiver.seed(self.candidate.source.identity);
            if first >= all || !self.receiver.goes_on || !seed.is_multiple_of(GO_ON) {
                return agreed;
            }
            weight_of_more = f64::from(GO_ON);
        }
        let [more, more_open] = self.shadow_rays(first..all);
        let (sum, open) = (sum + more, open + more_open);
        if sum > 0.0 { agreed + (open / sum - agreed) * weight_of_more } else { 0.0 }
    }

    /// The form factor of several polygons by so many rays.
    #[inline(always)]
    fn counted(&self, rays: u32) -> f64 {
        let [_, open] = self.shadow_rays(0..rays);
        self.candidate.source.area / PI * open / f64::from(rays)
    }

    /// The sums of g and of g V over these pairs of points.
    #[inline(always)]
    fn shadow_rays(&self, range: Range<u32>) -> [f64; 2] {
        let mut sums = [0.0; 2];
        let mut start = range.start;
        while start < range.end {
            let (from, to, weights) = self.pairs(start..range.end.min(start + LANES as u32));
            let is_stopped = match &self.between {
                Between::Plates(few) => stopped(few, &from, &to),
                _ => self.stopped_by_any(&from, &to, &weights),
            };
            for k in 0..LANES {
                sums[0] += weights[k];
                sums[1] += if is_stopped[k] { 0.0 } else { weights[k] };
            }
            start += LANES as u32;
        }
        sums
    }

    /// Up to eight pairs of points, with g = cosθ cosθ' / d²; the others have none.
    #[inline(always)]
    fn pairs(&self, range: Range<u32>) -> (Eight, Eight, [f64; LANES]) {
        let Self { receiver, candidate, .. } = self;
        let seed = receiver.seed(candidate.source.identity);
        let (mut from, mut to, mut weights) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3], [0.0; LANES]);
        for (k, number) in range.enumerate() {
            let [a, b, c, d] = places(number, seed);
            let ((p, normal), (q, normal_there)) =
                (receiver.area.place(a, b), candidate.source.places.place(c, d));
            let along = q - p;
            let (cosine, cosine_there) = (normal.dot(along), -normal_there.dot(along));
            if cosine > 0.0 && cosine_there > 0.0 {
                weights[k] = cosine * cosine_there / along.length_squared().powi(2);
            }
            for axis in 0..3 {
                (from[axis][k], to[axis][k]) = (p[axis], q[axis]);
            }
        }
        (from, to, weights)
    }

    /// Which of these pairs anything in the scene stands between.
    #[inline(always)]
    fn stopped_by_any(&self, from: &Eight, to: &Eight, weights: &[f64; LANES]) -> [bool; LANES] {
        let mut stopped = [false; LANES];
        for k in 0..LANES {
            if weights[k] > 0.0 {
                let [origin, end] = [from, to].map(|[x, y, z]| DVec3::new(x[k], y[k], z[k]));
                let ray = Ray { origin, direction: end - origin };
                stopped[k] = self.receiver.scenery.is_blocked(self.receiver.instance, &ray);
            }
        }
        stopped
    }
}

/// Scrambled point sets, and points in each.
const SETS: (u32, u32) = (16, 256);

/// Pairs of places on a receiver and a source, made once.
static PLACES: LazyLock<Vec<[f64; 4]>> = LazyLock::new(|| {
    let set = |set: u32| (0..SETS.1).map(move |k| sobol::point(k, sobol::hash(set ^ 0x9e37_79b9)));
    (0..SETS.0).flat_map(set).collect()
});

/// The kth pair of places of a seed, as four numbers in 0..1: a point of one of the sets, shifted.
#[inline(always)]
fn places(k: u32, seed: u32) -> [f64; 4] {
    let point = PLACES[(seed % SETS.0 * SETS.1 + k % SETS.1) as usize];
    let shifts = [sobol::hash(seed), sobol::hash(seed ^ 0x68bc_21eb)];
    std::array::from_fn(|d| {
        let shift = f64::from(shifts[d / 2] >> (16 * (d % 2)) & 0xffff) / 65536.0;
        let moved = point[d] + shift;
        if moved >= 1.0 { moved - 1.0 } else { moved }
    })
}
