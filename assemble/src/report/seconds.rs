//! The paper's table of steps, from measured times.

use crate::equation::coupling::Coupled;
use crate::exchange::step_times::StepTimes;
use crate::placed_parts::PlacedParts;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// The paper's steps: 1, 2 self blocks of the first part and of the others; 3, 4 coupling into the first and into the
/// others; 5, 6 local equilibria of the first and of the others; 7 transfer to the others, 8 to the first. All in
/// seconds.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Seconds {
    /// F₁₁.
    pub step1: f64,
    /// F₂₂ (all other parts).
    pub step2: f64,
    /// F₁₂.
    pub step3: f64,
    /// F₂₁.
    pub step4: f64,
    /// Equilibrium in part 1.
    pub step5: f64,
    /// Equilibrium in part 2 (all others).
    pub step6: f64,
    /// Transfer from 1 to 2.
    pub step7: f64,
    /// Transfer from 2 to 1.
    pub step8: f64,
    /// All steps in sequence.
    pub t1: f64,
    /// Self blocks and local equilibria of the parts in parallel.
    pub t2: f64,
    /// All independent steps in parallel: the longest chain.
    pub t3: f64,
    /// Exchange outside steps 5–8: coarse and Krylov spaces, bounds and power balances; wall time.
    pub exchange_overhead: f64,
    /// Light at requested points; wall time.
    pub points: f64,
    /// Light at requested points; processor time, where the operating system reports it.
    pub points_cpu: Option<f64>,
    /// Wall time from the scene's file to the light of all elements: everything except proofs and outputs.
    pub solve: f64,
    /// Processor time for the same work, where the operating system reports it.
    pub solve_cpu: Option<f64>,
    /// Wall time of the run.
    pub total: f64,
}

/// Steps 1–8 and T₁, T₂, T₃. Steps 1–4 are summed over threads; blocks from the cache count as 0. The first instance
/// is the paper's part 1, all others together are its part 2.
pub fn seconds(placed: &PlacedParts, coupled: &[Coupled], times: &StepTimes) -> Seconds {
    let mut baked = vec![false; placed.parts.len()];
    let own: Vec<f64> = (0..coupled.len())
        .map(|k| {
            let part = placed.instances[k].part.index();
            // A part with several instances was baked once: the time belongs to the first instance.
            let first = !std::mem::replace(&mut baked[part], true);
            let bake = if first { placed.parts[part].form_factor_time } else { Duration::ZERO };
            (bake + coupled[k].corrected.as_ref().map_or(Duration::ZERO, |c| c.time)).as_secs_f64()
        })
        .collect();
    let coupling: Vec<f64> = coupled.iter().map(|c| c.time.as_secs_f64()).collect();
    let [solve, transfer] = [&times.solve, &times.transfer].map(|steps| in_seconds(steps));

    let total = |steps: &[f64]| steps.iter().sum::<f64>();
    let longest = |steps: &[f64]| steps.iter().copied().fold(0.0, f64::max);
    let ((step1, step2), (step3, step4)) = (split(&own), split(&coupling));
    let Seconds { step5, step6, step7, step8, .. } = rounds(times);
    Seconds {
        step1,
        step2,
        step3,
        step4,
        step5,
        step6,
        step7,
        step8,
        t1: total(&own) + total(&coupling) + total(&solve) + total(&transfer),
        t2: longest(&own) + total(&coupling) + longest(&solve) + total(&transfer),
        t3: longest(&own).max(longest(&coupling)) + longest(&solve) + longest(&transfer),
        exchange_overhead: times.overhead.total().as_secs_f64(),
        points: 0.0,
        points_cpu: None,
        solve: 0.0,
        solve_cpu: None,
        total: 0.0,
    }
}

/// Steps 5–8 alone, the times of rounds.
pub fn rounds(times: &StepTimes) -> Seconds {
    let ((step5, step6), (step8, step7)) =
        (split(&in_seconds(&times.solve)), split(&in_seconds(&times.transfer)));
    Seconds { step5, step6, step7, step8, ..Seconds::default() }
}

fn in_seconds(steps: &[Duration]) -> Vec<f64> {
    steps.iter().map(Duration::as_secs_f64).collect()
}

/// The first instance's time and that of all others.
fn split(steps: &[f64]) -> (f64, f64) {
    (steps.first().copied().unwrap_or(0.0), steps.iter().skip(1).sum())
}
