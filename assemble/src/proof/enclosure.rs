//! Error bounds for every element. Input: the stored form factors and an upper bound of the residual. Output: w with
//! |B − B̃| ≤ w.
//!
//! A = I − ρF has no positive off-diagonal entry, so A⁻¹ ≥ 0, and A w ≥ |r| implies |A⁻¹ r| ≤ w (Berman & Plemmons
//! 1994, ch. 6, on M-matrices). The constant θ = max |r_i|/(A1)_i is such a w. The iteration w ← |r| + ρF w lowers it
//! and keeps it valid: w ≥ |r| + ρF w =: w' implies w' ≥ |r| + ρF w'. Where an entry represents a cluster, F itself
//! is unknown; replacing each element's w by the largest w of its cluster only increases w, so the bound remains
//! valid.

use crate::exchange::system::InstanceSystem;
use equilux_bake::equilibrium::{apply, largest};
use equilux_bake::treecode::MISSED;
use equilux_formats::rows::{Precision, SINGLE_ROUNDING};
use equilux_formats::{ClusterTree, Rgb};
use rayon::prelude::*;

/// The iteration ends when a step lowers the bound by less than this share.
const MIN_REDUCTION: f64 = 1e-2;

/// Maximum number of iterations.
const MAX_ITERATIONS: usize = 200;

/// Whether entries may represent clusters, rounded to f32.
pub fn is_compressed(systems: &[InstanceSystem]) -> bool {
    systems.iter().any(|system| system.self_block.precision() == Precision::Single)
}

/// The stored form factors of a scene.
#[derive(Debug)]
pub struct StoredFormFactors<'a> {
    systems: &'a [InstanceSystem<'a>],
}

/// Maximum error of a row's entries, all together: rounding to f32, and form factors that the search may miss. The
/// entries of a row sum to at most 1.
pub const MAX_ROW_ERROR: f64 = SINGLE_ROUNDING + MISSED;

impl<'a> StoredFormFactors<'a> {
    /// The form factors of these block rows.
    pub fn of(systems: &'a [InstanceSystem<'a>]) -> Self {
        Self { systems }
    }

    /// Upper bound, W/m², on the difference between the light that clusters reflect, each with one radiosity, and the
    /// light that their elements reflect. A cluster of mean radiosity B̄ represents Σ_j F_ij B_j = F_iC B̄ + Σ_j F_ij
    /// (B_j − B̄), and the second term is at most F_iC max_j |B_j − B̄|. The bound adds errors that mostly cancel.
    pub fn spread(&self, radiosity: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let spreads = |(system, b): (&InstanceSystem, &Vec<Rgb>)| {
            let mut spreads = Vec::new();
            system.clusters.append_spreads(&system.clusters.means(b), &mut spreads);
            spreads
        };
        let spreads: Vec<Vec<Rgb>> = self.systems.iter().zip(radiosity).map(spreads).collect();
        // The error of an entry multiplies the mean and the spread; neither exceeds the cluster's brightest element.
        let twice: Vec<Vec<Rgb>> = radiosity.iter().map(|b| b.iter().map(|&b| b * 2.0).collect()).collect();
        self.reflected(&spreads, &twice)
    }

    /// w with |A⁻¹ r| ≤ w for every r with |r| ≤ `sizes`, W/m², one vector for each instance. Infinite in a channel
    /// in which it cannot be shown that every element removes light from the scene.
    pub fn enclose(&self, sizes: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let ones: Vec<Vec<Rgb>> = sizes.iter().map(|s| vec![Rgb::WHITE; s.len()]).collect();
        let theta = constant(sizes, &self.reflected_at_most(&ones));
        let provable = theta.0.map(f64::is_finite);
        let start = Rgb::from_fn(|c| if provable[c] { theta[c] } else { 0.0 });
        let mut w: Vec<Vec<Rgb>> = sizes.iter().map(|s| vec![start; s.len()]).collect();
        for _ in 0..MAX_ITERATIONS {
            let before = total(&w);
            let reflected = self.reflected_at_most(&w);
            let rows = w.iter_mut().flatten().zip(sizes.iter().flatten()).zip(reflected.iter().flatten());
            rows.for_each(|((w, &size), &more)| *w = smaller(*w, size + more));
            if total(&w) > (1.0 - MIN_REDUCTION) * before {
                break;
            }
        }
        let unproved = |w: &mut Rgb| *w = Rgb::from_fn(|c| if provable[c] { w[c] } else { f64::INFINITY });
        w.iter_mut().flatten().for_each(unproved);
        w
    }

    /// Upper bound of ρF w, W/m², for w ≥ 0.
    fn reflected_at_most(&self, w: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let maxima: Vec<Vec<Rgb>> =
            self.systems.par_iter().zip(w).map(|(system, w)| maxima(system.clusters, w)).collect();
        self.reflected(&maxima, w)
    }

    /// ρF `values` (≥ 0, of all nodes of each instance), plus the maximum contribution of rounded or missing entries
    /// for elements with the radiosities `rounded`; W/m².
    fn reflected(&self, values: &[Vec<Rgb>], rounded: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
        let (all, elements) = (values.concat(), rounded.concat());
        let most = largest(&elements);
        let of = |(k, system): (usize, &InstanceSystem)| -> Vec<Rgb> {
            let (own, others) = (apply(system.self_block, &values[k]), apply(system.coupling, &all));
            let row = |i: usize| {
                let off = most * MAX_ROW_ERROR;
                system.optics.reflectance[i] * (own[i] + others[i] + off)
            };
            (0..own.len()).map(row).collect()
        };
        self.systems.par_iter().enumerate().map(of).collect()
    }
}

/// θ = max size_i / (1 − seen_i): infinite where an element with a residual keeps all its light.
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

/// The values of all nodes: each element's own, and the largest in each cluster.
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
