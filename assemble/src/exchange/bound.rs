//! The proved error bound of a round: |B − B̃| ≤ max_i(|r_i| / (A w)_i) w, with the residual r = E + ρF B̃ − B̃ and
//! any w > 0 with A w > 0.
//!
//! A = I − ρF has non-positive off-diagonals, so such a w makes A⁻¹ ≥ 0 and bounds it (Berman & Plemmons 1994, ch. 6,
//! on M-matrices). With w = 1, (A w)_i is the share of light that element i removes from the scene. Where elements
//! differ strongly in that share, an approximate solution of A w = 1 proves a much smaller bound.

use crate::exchange::block_correction::BlockCorrection;
use crate::exchange::coarse::Coarse;
use crate::exchange::groups::Group;
use crate::exchange::step_times::StepTimes;
use equilux_bake::equilibrium::krylov::Space;
use equilux_bake::equilibrium::largest;
use equilux_formats::Rgb;

/// w = 1 is rejected where the smallest (A w)_i is below this share of the mean.
const MIN_LOSS_SHARE: f64 = 0.2;

/// A w only needs to be positive: the search for w ends when no component of A w is further than this from 1.
const MARGIN_TOLERANCE: f64 = 0.5;

/// Number of Krylov spaces after which the search for w gives up: nothing removes light from the scene.
const MAX_KRYLOV_SPACES: usize = 4;

/// Rounding error of a row's sum relative to the sum: the part of the residual that rounding may hide.
const ROUNDING_SHARE: f64 = 4.0 * f64::EPSILON;

/// Another bounce is computed if the last one lowered the bound below this share of its former value.
const MIN_IMPROVEMENT_RATIO: f64 = 0.7;

/// The vector w that turns residuals into error bounds for a group of parts. Vectors of the group.
pub struct Margin {
    /// w.
    vector: Vec<Rgb>,
    /// A w.
    image: Vec<Rgb>,
}

impl Margin {
    /// The margin for a group's elements. If w has to be solved for, parts are solved in `turns` turns.
    pub fn of(group: &Group, coarse: Option<&Coarse>, turns: usize) -> Self {
        let constant = Self::by(group, vec![Rgb::WHITE; group.elements()]);
        if constant.is_even() {
            return constant;
        }
        match solved(group, coarse, turns) {
            Some(vector) => constant.or_better(Self::by(group, vector)),
            None => constant,
        }
    }

    fn by(group: &Group, vector: Vec<Rgb>) -> Self {
        Self { image: group.image(&vector, &group.irradiance(&vector)), vector }
    }

    /// `better` in the channels in which it is valid, otherwise this margin.
    fn or_better(self, better: Self) -> Self {
        let holds = |c: usize| {
            let mut pairs = better.image.iter().zip(&better.vector);
            pairs.all(|(aw, w)| aw[c] > 0.0 && w[c] > 0.0)
        };
        let holds: [bool; 3] = std::array::from_fn(holds);
        let choose = |constant: Vec<Rgb>, better: &[Rgb]| -> Vec<Rgb> {
            let pairs = constant.iter().zip(better);
            pairs.map(|(a, b)| Rgb::from_fn(|c| if holds[c] { b[c] } else { a[c] })).collect()
        };
        Self { vector: choose(self.vector, &better.vector), image: choose(self.image, &better.image) }
    }

    /// Whether w = 1 suffices: no (A w)_i is much smaller than the mean.
    fn is_even(&self) -> bool {
        let count = self.image.len().max(1) as f64;
        (0..3).all(|c| {
            let least = self.image.iter().map(|aw| aw[c]).fold(f64::INFINITY, f64::min);
            let mean = self.image.iter().map(|aw| aw[c]).sum::<f64>() / count;
            least >= MIN_LOSS_SHARE * mean
        })
    }

    /// Upper bound on the distance of any radiosity from the solution, W/m², channel by channel; infinite where no
    /// bound can be proved.
    pub fn bound(&self, residual: &[Rgb], radiosity: &[Rgb]) -> Rgb {
        times(self.factor_of(&sizes(residual, radiosity)), largest(&self.vector))
    }

    /// A sharper bound from a few bounces of the residual: with s = |r|, A⁻¹s = s + A⁻¹ρFs gives |B − B̃| ≤ s + ρFs +
    /// … + θ w, with θ from the last bounce. Bounces are smoother than residuals. Each bounce costs as much as one
    /// residual.
    pub fn sharp_bound(&self, group: &Group, residual: &[Rgb], radiosity: &[Rgb]) -> Rgb {
        let mut bounce = sizes(residual, radiosity);
        let mut sum = vec![Rgb::BLACK; bounce.len()];
        let mut best = self.bound(residual, radiosity);
        loop {
            sum.iter_mut().zip(&bounce).for_each(|(sum, &s)| *sum += s);
            let reflected = group.irradiance(&bounce);
            let rows = group.systems().flat_map(|system| &system.optics.reflectance).zip(reflected);
            bounce = rows.map(|(&rho, h)| rho * h).collect();
            let factor = self.factor_of(&bounce);
            let found = sum.iter().zip(&self.vector).map(|(&sum, &w)| sum + times(factor, w));
            let found = largest(&found.collect::<Vec<_>>());
            let pays = (0..3).any(|c| found[c] < MIN_IMPROVEMENT_RATIO * best[c]);
            best = Rgb::from_fn(|c| best[c].min(found[c]));
            if !pays {
                return best;
            }
        }
    }

    /// The smallest θ with `sizes` ≤ θ A w.
    fn factor_of(&self, sizes: &[Rgb]) -> Rgb {
        let quotient = |size: f64, aw: f64| match size {
            0.0 => 0.0,
            _ if aw > 0.0 => size / aw,
            _ => f64::INFINITY,
        };
        self.image
            .iter()
            .zip(sizes)
            .fold(Rgb::BLACK, |most: Rgb, (aw, size)| Rgb::from_fn(|c| most[c].max(quotient(size[c], aw[c]))))
    }
}

/// θ w; zero for θ = 0 even where w is infinite.
fn times(factor: Rgb, w: Rgb) -> Rgb {
    Rgb::from_fn(|c| if factor[c] == 0.0 { 0.0 } else { factor[c] * w[c] })
}

/// r| plus the part that rounding may hide.
fn sizes(residual: &[Rgb], radiosity: &[Rgb]) -> Vec<Rgb> {
    let pairs = residual.iter().zip(radiosity);
    pairs.map(|(r, b)| Rgb::from_fn(|c| r[c].abs() + ROUNDING_SHARE * b[c].abs())).collect()
}

/// w with |A w − 1| ≤ [`MARGIN_TOLERANCE`] everywhere; none after [`MAX_KRYLOV_SPACES`] Krylov spaces.
fn solved(group: &Group, coarse: Option<&Coarse>, turns: usize) -> Option<Vec<Rgb>> {
    let mut correction = BlockCorrection::new(group, turns, Some(MARGIN_TOLERANCE / 10.0));
    let mut times = StepTimes::none(group.scene_instances());
    let mut vector = vec![Rgb::BLACK; group.elements()];
    let mut residual = vec![Rgb::WHITE; group.elements()];
    let is_found = |residual: &[Rgb]| largest(residual).into_iter().all(|left| left <= MARGIN_TOLERANCE);
    for _ in 0..MAX_KRYLOV_SPACES {
        let mut space = Space::new(&residual);
        while !space.is_full() && !is_found(&residual) {
            let start = coarse.and_then(|coarse| coarse.correct(space.newest()));
            let (z, az) = correction.correct(space.newest(), start, &mut times);
            space.add(z, az);
            residual = space.residual();
        }
        vector.iter_mut().zip(space.correction()).for_each(|(w, z)| *w += z);
        if is_found(&residual) {
            return Some(vector);
        }
    }
    None
}
