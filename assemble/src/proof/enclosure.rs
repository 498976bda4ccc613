//! Bounds that hold element by element. In go the form factors as they are kept and what an answer misses at most; out
//! comes w with |B − B̃| ≤ w.
//!
//! A = I − ρF has no positive off-diagonal, so A⁻¹ ≥ 0, and A w ≥ |r| makes |A⁻¹ r| ≤ w (Berman & Plemmons 1994, ch. 6, on
//! M-matrices). The constant θ = max |r_i|/(A1)_i is such a w, and w ← |r| + ρF w lowers it and leaves it one: from
//! w ≥ |r| + ρF w =: w' follows w' ≥ |r| + ρF w'. F itself is not known where an entry stands for a cluster, but with the
//! cluster's largest w in place of each F w only grows, and then all of this holds the more.

use crate::exchange::system::InstanceSystem;
use equilux_bake::equilibrium::{apply, largest};
use equilux_bake::treecode::MISSED;
use equilux_formats::{ClusterTree, Precision, Rgb, SINGLE_ROUNDING};
use rayon::prelude::*;

/// Sweeps end when they lower the bound by less than this share, and after so many.
const SWEEPS: (f64, usize) = (1e-2, 200);

/// Whether entries may stand for clusters, rounded to f32.
pub fn is_compressed(systems: &[InstanceSystem]) -> bool {
    systems.iter().any(|system| system.self_block.precision() == Precision::Single)
}

/// The form factors of a scene as they are kept.
#[derive(Debug)]
pub struct StoredFormFactors<'a> {
    systems: &'a [InstanceSystem<'a>],
}

/// What a row's entries may be off by because they are kept as f32, and what it may miss, all entries together. The entries
/// of a row sum to 1 at most.
pub const OFF: f64 = SINGLE_ROUNDING + MISSED;

impl<'a> StoredFormFactors<'a> {
    /// The form factors that an exchange used.
    pub fn of(systems: &'a [InstanceSystem<'a>]) -> Self {
        Self { systems }
    }

    /// How far the light that clusters reflect, each as one radiosity, can be from what their elements reflect, W/m²: a
    /// cluster of mean radiosity B̄ stands for Σ_j F_ij B_j = F_iC B̄ + Σ_j F_ij (B_j − B̄), and the second term is at most
    /// F_iC max_j |B_j − B̄|. It adds up what mostly cancels.
    pub fn spread(&self, radiosity: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let spreads = |(system, b): (&InstanceSystem, &Vec<Rgb>)| {
            let mut spreads = Vec::new();
            system.clusters.append_spreads(&system.clusters.means(b), &mut spreads);
            spreads
        };
        let spreads: Vec<Vec<Rgb>> = self.systems.iter().zip(radiosity).map(spreads).collect();
        // What an entry is off by goes with the mean and with the spread; neither is above the cluster's brightest.
        let twice: Vec<Vec<Rgb>> = radiosity.iter().map(|b| b.iter().map(|&b| b * 2.0).collect()).collect();
        self.reflected(&spreads, &twice)
    }

    /// w with |A⁻¹ r| ≤ w for every r with |r| ≤ `sizes`, W/m², one vector an instance; infinite in a channel in which
    /// it cannot be shown that every element takes light out of the scene.
    pub fn enclose(&self, sizes: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let ones: Vec<Vec<Rgb>> = sizes.iter().map(|s| vec![Rgb::WHITE; s.len()]).collect();
        let theta = constant(sizes, &self.reflected_at_most(&ones));
        let provable = theta.0.map(f64::is_finite);
        let start = Rgb::from_fn(|c| if provable[c] { theta[c] } else { 0.0 });
        let mut w: Vec<Vec<Rgb>> = sizes.iter().map(|s| vec![start; s.len()]).collect();
        let (share, most) = SWEEPS;
        for _ in 0..most {
            let before = total(&w);
            let reflected = self.reflected_at_most(&w);
            let rows = w.iter_mut().flatten().zip(sizes.iter().flatten()).zip(reflected.iter().flatten());
            rows.for_each(|((w, &size), &more)| *w = smaller(*w, size + more));
            if total(&w) > (1.0 - share) * before {
                break;
            }
        }
        let unproved = |w: &mut Rgb| *w = Rgb::from_fn(|c| if provable[c] { w[c] } else { f64::INFINITY });
        w.iter_mut().flatten().for_each(unproved);
        w
    }

    /// ρF w at most, W/m², for w ≥ 0.
    fn reflected_at_most(&self, w: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let maxima: Vec<Vec<Rgb>> =
            self.systems.par_iter().zip(w).map(|(system, w)| maxima(system.clusters, w)).collect();
        self.reflected(&maxima, w)
    }

    /// ρF `values` (≥ 0, of all nodes of each instance) and what entries that are off or missing add to it at most where
    /// the elements have the radiosities `rounded`; W/m².
    fn reflected(&self, values: &[Vec<Rgb>], rounded: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let (all, elements) = (values.concat(), rounded.concat());
        let most = largest(&elements);
        let of = |(k, system): (usize, &InstanceSystem)| -> Vec<Rgb> {
            let (own, others) = (apply(system.self_block, &values[k]), apply(system.coupling, &all));
            let row = |i: usize| {
                let off = most * OFF;
                system.optics.reflectance[i] * (own[i] + others[i] + off)
            };
            (0..own.len()).map(row).collect()
        };
        self.systems.par_iter().enumerate().map(of).collect()
    }
}

/// θ = max size_i / (1 − seen_i): infinite where an element that misses something keeps all its light.
fn constant(sizes: &[Vec<Rgb>], seen: &[Vec<Rgb>]) -> Rgb {
    let pairs = sizes.iter().flatten().zip(seen.iter().flatten());
    let quotient = |size: f64, seen: f64| match size {
        0.0 => 0.0,
        _ if seen < 1.0 => size / (1.0 - seen),
        _ => f64::INFINITY,
    };
    pairs
        .fold(Rgb::BLACK, |most: Rgb, (size, seen)| Rgb::from_fn(|c| most[c].max(quotient(size[c], seen[c]))))
}

/// The values of all nodes: an element's own, the largest in a cluster.
fn maxima(clusters: &ClusterTree, elements: &[Rgb]) -> Vec<Rgb> {
    let mut values = elements.to_vec();
    values.resize(clusters.nodes(), Rgb::BLACK);
    for (cluster, pair) in clusters.children().iter().enumerate().rev() {
        let [left, right] = pair.map(|child| values[child as usize]);
        values[elements.len() + cluster] = Rgb::from_fn(|c| left[c].max(right[c]));
    }
    values
}

fn smaller(a: Rgb, b: Rgb) -> Rgb {
    Rgb::from_fn(|c| a[c].min(b[c]))
}

fn total(values: &[Vec<Rgb>]) -> f64 {
    values.iter().flatten().flatten().sum()
}
