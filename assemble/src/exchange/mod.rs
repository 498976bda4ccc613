//! The exchange of light between parts until the scene is in equilibrium: rounds of steps 5–8 of the paper. Input:
//! blocks and optics. Output: radiosity. The exchange does not depend on files or scenes.
//!
//! B_k ← (I − ρF_kk)⁻¹ (E_k + ρ Σ_{l≠k} F_kl B_l). Debelov & Sevastyanov, §2.2.

mod active_rows;
mod block_correction;
mod bound;
pub mod coarse;
pub mod energy;
mod error_estimate;
mod group_solver;
mod groups;
pub mod listener;
pub mod outcome;
mod scene_outcome;
pub mod settings;
pub mod step_times;
pub mod system;

use equilux_bake::monitor::Monitor;
use equilux_formats::Rgb;
use group_solver::GroupSolver;
use groups::groups;
use listener::Listener;
use outcome::Outcome;
use scene_outcome::SceneOutcome;
use settings::{Goal, Method};
use step_times::{StepTimes, timed};
use system::InstanceSystem;

/// Cost of an exchange, in rows of form factors per element, for the progress display.
pub const ROWS_PER_ELEMENT: f64 = 0.05;

/// Exchange light until the goal is met, no further progress is possible, or `monitor` or `listener` stops it. Starts
/// from `start`, one vector of radiosities (W/m²) for each instance, or from zero, as the paper does.
pub fn exchange(
    systems: &[InstanceSystem],
    method: Method,
    goal: Goal,
    start: Option<&[Vec<Rgb>]>,
    monitor: &Monitor,
    listener: &dyn Listener,
) -> Outcome {
    let mut times = StepTimes::none(systems.len());
    let groups = timed(&mut times.overhead.account, || groups(systems));
    let elements: usize = systems.iter().map(|system| system.areas.len()).sum();
    let mut scene = SceneOutcome::new(systems);
    monitor.begin("exchange", 0, ROWS_PER_ELEMENT * elements as f64);
    for group in &groups {
        let solver = GroupSolver::new(group, method, goal, &mut times.overhead);
        let column_sums = solver.column_sums();
        let start = start.map(|start| group.members.iter().flat_map(|&k| start[k].clone()).collect());
        let outcome = solver.run(start, goal, &mut times, monitor, listener);
        let without = method == Method::Auto && group.members.len() > 1 && outcome.coarse == 0;
        scene.skipped.black_rows += group.skipped();
        scene.skipped.coarse_spaces += usize::from(without);
        scene.add(&group.members, column_sums, outcome);
    }
    scene.outcome(times)
}
