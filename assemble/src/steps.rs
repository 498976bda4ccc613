//! The paper's table of steps from what was measured.

use crate::coupling::Coupled;
use crate::exchange::StepTimes;
use crate::placed::Placed;
use crate::report::Seconds;
use std::time::Duration;

/// Steps 1–8 and T₁, T₂, T₃. Steps 1–4 are summed over threads; what came from the cache took nothing. The first
/// instance is the paper's part 1, all others together its part 2.
pub fn seconds(placed: &Placed, coupled: &[Coupled], times: &StepTimes) -> Seconds {
    let mut baked = vec![false; placed.parts.len()];
    let own: Vec<f64> = (0..coupled.len())
        .map(|k| {
            let part = placed.instances[k].part.index();
            // A part that stands in several places was baked once: the time belongs to the first.
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

/// Steps 5–8 alone: what rounds take.
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
