//! Parts exchange light until the whole is in equilibrium: steps 5–8 of the paper, round after round.
//!
//! B_k ← (I − ρF_kk)⁻¹ (E_k + ρ Σ_{l≠k} F_kl B_l). Debelov & Sevastyanov, §2.2.

mod bound;
pub mod coarse;
pub mod energy;
mod gather;
mod groups;
mod rounds;
mod sweep;
mod whole;

use crate::coupling::Coupled;
use crate::observer::{Observer, Unobserved};
use crate::placed::Placed;
use energy::Energy;
use equilux_bake::equilibrium::{LocalSystem, added, scaled, subtract};
use equilux_bake::monitor::Monitor;
use equilux_formats::{Answers, ClusterTree, Optics, Rgb, Rows};
use groups::groups;
use rounds::{Course, Judged};
use std::time::{Duration, Instant};
use whole::Whole;

/// How parts exchange light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// As `Gmres`, but without the coarse space where parts return so little light that few rounds do.
    Auto,
    /// All parts at once, each with what the others had a round ago: the paper's form.
    Jacobi,
    /// One part after the other, each with the newest of the others.
    GaussSeidel,
    /// Flexible GMRES, preconditioned by parts that take turns and by a coarse space of their answers to light from outside.
    Gmres,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The error bound asked for, relative to the brightest radiosity in each channel of each group of parts that exchange
    /// light; 0 asks for all that rounding allows.
    pub error: f64,
    /// At most this many rounds.
    pub rounds: usize,
}

/// One instance's share of the equation.
pub struct Node<'a> {
    /// Reflectance and emission in this place.
    pub optics: Optics,
    /// F_kk in the scene.
    pub self_block: &'a Rows,
    /// The hierarchy of the part's elements.
    pub clusters: &'a ClusterTree,
    /// F_kl for l ≠ k; columns count through all nodes of the scene.
    pub coupling: &'a Rows,
    /// Solves the instance on its own.
    pub local: LocalSystem<'a>,
    /// How it answers light from outside.
    pub answers: &'a Answers,
    /// Area of its elements in the scene, m².
    pub areas: Vec<f64>,
}

/// What a round left behind. Parts that exchange no light with each other have rounds of their own, which are counted
/// together.
#[derive(Debug, Clone)]
pub struct Round {
    /// 1 for the first.
    pub number: usize,
    /// What is known of the light after it.
    pub known: Known,
    /// Wall time of the round.
    pub time: Duration,
    /// Radiosity of all elements after the round, if there is to be a picture of it.
    pub radiosity: Option<Vec<Rgb>>,
}

/// What is known of light on its way to equilibrium.
#[derive(Debug, Clone, Copy, Default)]
pub struct Known {
    /// Largest residual, W/m².
    pub residual: f64,
    /// No radiosity is further than this from the solution with the form factors as they are kept, W/m².
    pub error_bound: f64,
    /// The bound over the brightest radiosity of the same group of parts and the same channel, the worst of all.
    pub relative_bound: f64,
    /// Where the power is.
    pub energy: Energy,
}

impl Known {
    /// The same with another group of parts.
    fn with(mut self, judged: &Judged) -> Self {
        self.residual = judged.residual.into_iter().fold(self.residual, f64::max);
        self.error_bound = judged.error_bound.into_iter().fold(self.error_bound, f64::max);
        self.relative_bound = self.relative_bound.max(judged.relative_bound());
        self.energy += judged.energy;
        self
    }
}

/// Time spent in the paper's steps 5 and 6 (local solves) and 7 and 8 (transfers), one entry an instance.
#[derive(Debug, Clone, Default)]
pub struct StepTimes {
    /// Equilibrium inside each instance.
    pub solve: Vec<Duration>,
    /// Transfer into each instance.
    pub transfer: Vec<Duration>,
    /// Everything else.
    pub overhead: Overhead,
}

/// Wall time of what the exchange does beside the paper's steps.
#[derive(Debug, Clone, Copy, Default)]
pub struct Overhead {
    /// Finding groups of parts, and the column sums of the energy account; once.
    pub account: Duration,
    /// Setting up the coarse space; once.
    pub coarse: Duration,
    /// Finding the vector that the bound needs; once.
    pub margin: Duration,
    /// Coarse corrections and the Krylov space; all rounds.
    pub krylov: Duration,
    /// Bounds and energy accounts; all rounds.
    pub judging: Duration,
    /// Residuals computed anew, and the last, sharper bound.
    pub proving: Duration,
}

impl Overhead {
    /// All of it.
    pub fn total(&self) -> Duration {
        self.account + self.coarse + self.margin + self.krylov + self.judging + self.proving
    }
}

/// Do some work and add the time it takes to `total`.
fn timed<T>(total: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    *total += start.elapsed();
    done
}

impl StepTimes {
    /// No time in so many instances.
    pub fn none(instances: usize) -> Self {
        let none = vec![Duration::ZERO; instances];
        Self { solve: none.clone(), transfer: none, overhead: Overhead::default() }
    }
}

/// The light in the end.
pub struct Outcome {
    /// Radiosity of all elements.
    pub radiosity: Vec<Rgb>,
    /// Irradiance of all elements.
    pub irradiance: Vec<Rgb>,
    /// The rounds; none if the light to start from already was within the bound.
    pub rounds: Vec<Round>,
    /// What is known of the light in the end.
    pub known: Known,
    /// Where time went.
    pub times: StepTimes,
    /// Whether the goal was met.
    pub converged: bool,
    /// What the rounds did not have to do.
    pub spared: Spared,
    /// Unknowns of the coarse space, all groups together.
    pub coarse_unknowns: usize,
    /// Number of groups of parts that exchange no light with each other.
    pub groups: usize,
    /// Least and largest share of what an element sends that arrives somewhere.
    pub column_sums: [f64; 2],
}

/// What changes no radiosity and was left out of the rounds.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spared {
    /// Rows of black receivers, gathered once in the end.
    pub black_rows: usize,
    /// Local equilibria of instances in which nothing shone, all rounds together.
    pub dark_solves: usize,
    /// Coarse spaces of groups of parts that return so little light that few rounds do without.
    pub coarse_spaces: usize,
}

/// The instances' shares of the equation.
pub fn nodes<'a>(placed: &'a Placed, coupled: &'a [Coupled], optics: &'a [Optics]) -> Vec<Node<'a>> {
    (0..coupled.len())
        .map(|k| {
            let part = &placed.part_of(k).part;
            let self_block = coupled[k].self_block(&part.self_block);
            let answered = coupled[k].local(placed.local_of(k));
            let local = LocalSystem::new(
                self_block,
                &part.geometry.clusters,
                &optics[k].reflectance,
                part.local.solver,
                answered.factors.as_ref(),
            );
            let elements = &placed.world.elements[placed.world.elements_of(k)];
            Node {
                optics: optics[k].clone(),
                self_block,
                clusters: &part.geometry.clusters,
                coupling: &coupled[k].coupling,
                local,
                answers: &answered.answers,
                areas: elements.iter().map(|element| element.area).collect(),
            }
        })
        .collect()
}

/// Exchange light until the goal is met, no progress is possible, or somebody stops it. Starts from `start`, one vector
/// of radiosities an instance, or from darkness, as the paper does.
pub fn exchange(
    nodes: &[Node],
    method: Method,
    goal: Goal,
    start: Option<&[Vec<Rgb>]>,
    monitor: &Monitor,
) -> Outcome {
    exchange_observed(nodes, method, goal, start, monitor, &Unobserved)
}

/// The same with somebody who sees every round, and may say that the light is good enough.
pub fn exchange_observed(
    nodes: &[Node],
    method: Method,
    goal: Goal,
    start: Option<&[Vec<Rgb>]>,
    monitor: &Monitor,
    observer: &dyn Observer,
) -> Outcome {
    let mut times = StepTimes::none(nodes.len());
    let groups = timed(&mut times.overhead.account, || groups(nodes));
    let mut whole = Whole::new(nodes);
    monitor.begin("exchange", 0);
    for group in &groups {
        let course = Course::new(group, method, goal, &mut times.overhead);
        let column_sums = course.column_sums();
        let start = start.map(|start| group.members.iter().flat_map(|&k| start[k].clone()).collect());
        let outcome = course.run(start, goal, &mut times, monitor, observer);
        let without = method == Method::Auto && group.members.len() > 1 && outcome.coarse == 0;
        whole.spared.black_rows += group.waiting();
        whole.spared.coarse_spaces += usize::from(without);
        whole.take(&group.members, column_sums, outcome);
    }
    whole.outcome(times)
}

/// Whether there is to be a picture of this round even if it is not the last: of the first eight, then of powers of two.
fn is_shown(round: usize) -> bool {
    round <= 8 || round.is_power_of_two()
}

/// r = E + ρH − B with the irradiance H of that B, W/m², one vector an instance.
pub fn residual(nodes: &[Node], radiosity: &[Vec<Rgb>], irradiance: &[Vec<Rgb>]) -> Vec<Vec<Rgb>> {
    let of = |node: &Node, b: &[Rgb], h: &[Rgb]| -> Vec<Rgb> {
        (0..b.len())
            .map(|i| {
                let right = added(node.optics.emission[i], scaled(node.optics.reflectance[i], h[i]));
                subtract(right, b[i])
            })
            .collect()
    };
    nodes.iter().zip(radiosity).zip(irradiance).map(|((node, b), h)| of(node, b, h)).collect()
}
