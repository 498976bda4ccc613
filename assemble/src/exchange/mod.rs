//! Parts exchange light until the whole is in equilibrium: steps 5–8 of the paper, round after round.
//!
//! B_k ← (I − ρF_kk)⁻¹ (E_k + ρ Σ_{l≠k} F_kl B_l). Debelov & Sevastyanov, §2.2.

pub mod bound;
mod gather;
mod sweep;

use crate::coupling::Coupled;
use crate::placed::Placed;
use bound::{Margin, residual};
use equilux_bake::equilibrium::{LocalSystem, added, largest, scaled};
use equilux_bake::monitor::Monitor;
use equilux_formats::{ClusterTree, Optics, Rgb, Rows};
use std::time::{Duration, Instant};

/// In which order parts hear of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// All parts at once, each with what the others had a round ago: the paper's form.
    Jacobi,
    /// One part after the other, each with the newest of the others.
    GaussSeidel,
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// The error bound asked for, relative to the brightest radiosity; 0 asks for all that rounding allows.
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
}

/// What a round left behind.
#[derive(Debug, Clone)]
pub struct Round {
    /// 1 for the first.
    pub number: usize,
    /// Largest residual, W/m².
    pub residual: f64,
    /// No radiosity is further than this from the solution with the form factors as they are kept, W/m².
    pub error_bound: f64,
    /// The bound over the brightest radiosity.
    pub relative_bound: f64,
    /// Wall time of the round.
    pub time: Duration,
    /// Radiosity of all elements after the round, if there is to be a picture of it.
    pub radiosity: Option<Vec<Rgb>>,
}

/// Time spent in the paper's steps 5 and 6 (local solves) and 7 and 8 (transfers), one entry an instance.
#[derive(Debug, Clone, Default)]
pub struct StepTimes {
    /// Equilibrium inside each instance.
    pub solve: Vec<Duration>,
    /// Transfer into each instance.
    pub transfer: Vec<Duration>,
}

/// The light in the end.
pub struct Outcome {
    /// Radiosity of all elements.
    pub radiosity: Vec<Rgb>,
    /// Irradiance of all elements.
    pub irradiance: Vec<Rgb>,
    /// The rounds.
    pub rounds: Vec<Round>,
    /// Where time went.
    pub times: StepTimes,
    /// Whether the goal was met.
    pub converged: bool,
    /// What the rounds did not have to do.
    pub spared: Spared,
}

/// What changes no radiosity and was left out of the rounds.
#[derive(Debug, Clone, Copy, Default)]
pub struct Spared {
    /// Rows of black receivers, gathered once in the end.
    pub black_rows: usize,
    /// Local equilibria of instances in which nothing shone, all rounds together.
    pub dark_solves: usize,
}

/// Rounding is reached when the bound is below the first number, relative to the brightest radiosity, and at least the
/// third number of rounds before it was hardly larger (by the second). The bound of block Jacobi may rise and fall by
/// turns, so the last round alone tells nothing.
const STALLED: (f64, f64, usize) = (1e-9, 0.95, 3);

/// The instances' shares of the equation.
pub fn nodes<'a>(placed: &'a Placed, coupled: &'a [Coupled], optics: &'a [Optics]) -> Vec<Node<'a>> {
    (0..coupled.len())
        .map(|k| {
            let part = &placed.part_of(k).part;
            let self_block = coupled[k].self_block(&part.self_block);
            let factors = coupled[k].factors(&part.local);
            let local = LocalSystem::new(
                self_block,
                &part.geometry.clusters,
                &optics[k].reflectance,
                part.local.solver,
                factors,
            );
            Node {
                optics: optics[k].clone(),
                self_block,
                clusters: &part.geometry.clusters,
                coupling: &coupled[k].coupling,
                local,
            }
        })
        .collect()
}

/// Exchange light until the goal is met, no progress is possible, or somebody stops it. Starts from darkness, as the
/// paper does.
pub fn exchange(nodes: &[Node], method: Method, goal: Goal, monitor: &Monitor) -> Outcome {
    let margin = Margin::of(nodes);
    let mut state = sweep::State::dark(nodes);
    let mut rounds: Vec<Round> = Vec::new();
    let mut times =
        StepTimes { solve: vec![Duration::ZERO; nodes.len()], transfer: vec![Duration::ZERO; nodes.len()] };
    let mut converged = false;
    monitor.begin("exchange", 0);
    while rounds.len() < goal.rounds && !converged && !monitor.stopped() {
        let start = Instant::now();
        match method {
            Method::Jacobi => state.jacobi(&mut times),
            Method::GaussSeidel => state.gauss_seidel(&mut times),
        }
        let residual = residual(nodes, &state.radiosity, &state.irradiance());
        let error_bound = margin.bound(&residual);
        let brightest = largest(&state.flat()).into_iter().fold(0.0, f64::max);
        let relative_bound = if error_bound == 0.0 { 0.0 } else { error_bound / brightest };
        converged = relative_bound <= goal.error;
        let stalled = has_stalled(&rounds, relative_bound);
        if let Some(before) = rounds.last_mut().filter(|round| !is_shown(round.number)) {
            before.radiosity = None;
        }
        rounds.push(Round {
            number: rounds.len() + 1,
            residual: residual.iter().flatten().flatten().fold(0.0, |most: f64, r| most.max(r.abs())),
            error_bound,
            relative_bound,
            time: start.elapsed(),
            radiosity: Some(state.flat()),
        });
        monitor.advance(1);
        if stalled {
            converged = goal.error == 0.0;
            break;
        }
    }
    let spared = Spared { black_rows: state.waiting(), dark_solves: state.idle };
    let irradiance = state.whole_irradiance().concat();
    Outcome { radiosity: state.flat(), irradiance, rounds, times, converged, spared }
}

/// Whether there is to be a picture of this round even if it is not the last: of the first eight, then of powers of two.
fn is_shown(round: usize) -> bool {
    round <= 8 || round.is_power_of_two()
}

fn has_stalled(rounds: &[Round], bound: f64) -> bool {
    let (small, share, back) = STALLED;
    let earlier = &rounds[..rounds.len().saturating_sub(back)];
    bound < small && earlier.iter().any(|round| bound > share * round.relative_bound)
}

/// E + ρ × irradiance.
fn sources(optics: &Optics, arriving: &[Rgb]) -> Vec<Rgb> {
    let reflected = optics.reflectance.iter().zip(arriving).map(|(&rho, &h)| scaled(rho, h));
    optics.emission.iter().zip(reflected).map(|(&e, r)| added(e, r)).collect()
}
