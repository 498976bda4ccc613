//! What is proved about a round: |B − B̃| ≤ max_i(|r_i| / (A w)_i) w, with the residual r = E + ρF B̃ − B̃ and any w > 0 with
//! A w > 0.
//!
//! A = I − ρF has non-positive off-diagonals, so such a w makes A⁻¹ ≥ 0 and bounds it (Berman & Plemmons 1994, ch. 6, on
//! M-matrices). With w = 1, (A w)_i is the share of light that element i takes out of the scene. Where elements differ
//! much in that, a w that solves A w = 1 roughly proves far more.

use crate::exchange::block_correction::BlockCorrection;
use crate::exchange::coarse::Coarse;
use crate::exchange::groups::Group;
use crate::exchange::step_times::StepTimes;
use equilux_bake::equilibrium::krylov::Space;
use equilux_bake::equilibrium::largest;
use equilux_formats::Rgb;

/// Where the element that loses least loses less than this share of the mean, w = 1 is given up.
const UNEVEN: f64 = 0.2;

/// A w may be anything positive; rounds end when nowhere more than this is missing from 1.
const ROUGH: f64 = 0.5;

/// Krylov spaces after which no w is found: nothing takes light out of the scene.
const PATIENCE: usize = 4;

/// Roundings of a row's sum, of its own size: what a computed residual may hide.
const ROUNDINGS: f64 = 4.0 * f64::EPSILON;

/// Another bounce is looked at if the last one lowered the bound to less than this share.
const WORTH: f64 = 0.7;

/// How residuals prove bounds in a group of parts. Vectors of the group.
pub struct Margin {
    /// w.
    vector: Vec<Rgb>,
    /// A w.
    image: Vec<Rgb>,
}

impl Margin {
    /// The margin of a group's elements; parts take `turns` where w has to be found.
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

    /// The other margin in the channels in which it holds.
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

    /// Whether w = 1 does: no element loses much less than the mean.
    fn is_even(&self) -> bool {
        let count = self.image.len().max(1) as f64;
        (0..3).all(|c| {
            let least = self.image.iter().map(|aw| aw[c]).fold(f64::INFINITY, f64::min);
            let mean = self.image.iter().map(|aw| aw[c]).sum::<f64>() / count;
            least >= UNEVEN * mean
        })
    }

    /// No radiosity is further than this from the solution, W/m², channel by channel; infinite where nothing can be proved.
    pub fn bound(&self, residual: &[Rgb], radiosity: &[Rgb]) -> Rgb {
        times(self.factor_of(&sizes(residual, radiosity)), largest(&self.vector))
    }

    /// The same from a few bounces of what is missed: with s = |r|, from A⁻¹s = s + A⁻¹ρFs follows
    /// |B − B̃| ≤ s + ρFs + … + θ w, θ from the last bounce, and bounces are smoother than residuals. Each costs as much as
    /// computing a residual.
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
            let pays = (0..3).any(|c| found[c] < WORTH * best[c]);
            best = Rgb::from_fn(|c| best[c].min(found[c]));
            if !pays {
                return best;
            }
        }
    }

    /// θ with sizes ≤ θ A w.
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

/// θ w; nothing of nothing, even where w is without bound.
fn times(factor: Rgb, w: Rgb) -> Rgb {
    Rgb::from_fn(|c| if factor[c] == 0.0 { 0.0 } else { factor[c] * w[c] })
}

/// |r| with what rounding may hide of it.
fn sizes(residual: &[Rgb], radiosity: &[Rgb]) -> Vec<Rgb> {
    let pairs = residual.iter().zip(radiosity);
    pairs.map(|(r, b)| Rgb::from_fn(|c| r[c].abs() + ROUNDINGS * b[c].abs())).collect()
}

/// w with |A w − 1| ≤ [`ROUGH`] everywhere; none if that takes too long.
fn solved(group: &Group, coarse: Option<&Coarse>, turns: usize) -> Option<Vec<Rgb>> {
    let mut sweep = BlockCorrection::new(group, turns, Some(ROUGH / 10.0));
    let mut times = StepTimes::none(group.scene_instances());
    let mut vector = vec![Rgb::BLACK; group.elements()];
    let mut missing = vec![Rgb::WHITE; group.elements()];
    let is_found = |missing: &[Rgb]| largest(missing).into_iter().all(|left| left <= ROUGH);
    for _ in 0..PATIENCE {
        let mut space = Space::new(&missing);
        while !space.is_full() && !is_found(&missing) {
            let start = coarse.and_then(|coarse| coarse.correct(space.newest()));
            let (z, az) = sweep.correct(space.newest(), start, &mut times);
            space.add(z, az);
            missing = space.residual();
        }
        vector.iter_mut().zip(space.correction()).for_each(|(w, z)| *w += z);
        if is_found(&missing) {
            return Some(vector);
        }
    }
    None
}
