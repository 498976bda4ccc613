//! The published state of a run. Input: the results of the run as they are computed, through [`Observer`]. Output:
//! snapshots and news for viewers. The run never waits for viewers: it copies its light at most once every [`MIN_PUBLISH_INTERVAL`],
//! and the server's thread does the rest.

use super::field::{Field, RoundLight, Snapshot, SnapshotValues, computed, row_sums};
use super::history::{History, Point};
use super::model::Model;
use super::status::{Phase, Status};
use crate::equation::coupling::Coupled;
use crate::equation::observer::Observer;
use crate::exchange::listener::{FinishedRound, Listener};
use crate::exchange::outcome::Outcome;
use crate::exchange::step_times::StepTimes;
use crate::placed_parts::PlacedParts;
use crate::report::Report;
use crate::report::seconds::{Seconds, rounds, seconds};
use equilux_bake::oven::Baked;
use equilux_bake::oven::prepare::Prepared;
use equilux_formats::{Camera, Optics, Rgb, Scene};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};
use tokio::sync::watch;

/// Minimum time between published lights.
pub const MIN_PUBLISH_INTERVAL: Duration = Duration::from_millis(100);

/// The published state of a run.
#[derive(Debug)]
pub struct Board {
    state: Mutex<BoardState>,
    /// Signals changes. Each receiver is a viewer.
    changed: watch::Sender<()>,
    end_requested: AtomicBool,
}

/// The state that viewers may see.
#[derive(Debug, Default)]
pub struct BoardState {
    /// Status of the run.
    pub status: Status,
    /// Version of the status.
    pub status_number: u64,
    /// The curve of the exchange.
    pub history: History,
    /// The scene, after its parts are placed.
    pub model: Option<Arc<Model>>,
    light: Option<RoundLight>,
    light_number: u32,
    row_sums: Arc<Vec<f32>>,
    computed: Arc<Vec<f32>>,
    group: usize,
    began: Option<Instant>,
    published: Option<Instant>,
}

impl Board {
    /// An empty board. `watched`: whether runs repeat when files change.
    pub fn new(watched: bool) -> Self {
        let status = Status { watched, ..Status::default() };
        Self {
            state: Mutex::new(BoardState { status, ..BoardState::default() }),
            changed: watch::Sender::new(()),
            end_requested: AtomicBool::new(false),
        }
    }

    /// Lock the state. The run may wait for the lock, so release it soon.
    pub fn state(&self) -> MutexGuard<'_, BoardState> {
        self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// A receiver that signals changes.
    pub fn viewer(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    /// Number of receivers that wait for changes.
    pub fn viewers(&self) -> usize {
        self.changed.receiver_count()
    }

    /// Begin a run. The state of the previous run remains visible until it is replaced.
    pub fn begin(&self) {
        self.end_requested.store(false, Ordering::Relaxed);
        self.change(|state| {
            let Status { run, placed, watched, .. } = state.status;
            state.status = Status { run: run + 1, placed, watched, ..Status::default() };
            state.history = History::default();
            (state.group, state.began) = (0, None);
        });
    }

    /// End a run.
    pub fn end(&self, outcome: Result<&Report, String>) {
        self.change(|state| match outcome {
            Ok(report) => state.status.end(report),
            Err(error) => {
                state.status.phase = Phase::Failed;
                state.status.error = Some(error);
            }
        });
    }

    /// End the exchange after its current round. Returns false if no exchange is running.
    pub fn stop(&self) -> bool {
        let is_exchange = self.state().status.phase == Phase::Exchange;
        if is_exchange {
            self.end_requested.store(true, Ordering::Relaxed);
            self.change(|state| state.status.stopping = true);
        }
        is_exchange
    }

    /// A snapshot of `field` with a number above `than`, if there is one.
    pub fn newer(&self, field: Field, than: u32) -> Option<Snapshot> {
        let state = self.state();
        let model = state.model.as_ref()?;
        let numbers = |numbers: &Arc<Vec<f32>>| {
            state.began.map(|_| (state.status.run, SnapshotValues::Numbers(Arc::clone(numbers))))
        };
        let (number, values) = match field {
            Field::RowSums => numbers(&state.row_sums)?,
            Field::Computed => numbers(&state.computed)?,
            _ => (state.light_number, SnapshotValues::Light(state.light.clone()?, field)),
        };
        (number > than).then_some(Snapshot { run: model.run, number, values })
    }

    fn change(&self, apply: impl FnOnce(&mut BoardState)) {
        let mut state = self.state();
        apply(&mut state);
        state.status_number += 1;
        drop(state);
        self.changed.send_replace(());
    }
}

impl BoardState {
    /// Copy the radiosity of some instances, W/m², into that of the scene.
    fn publish(&mut self, instances: &[usize], radiosity: &[Rgb]) {
        let Some(light) = &mut self.light else { return };
        light.round = self.history.last().map_or(0, |last| last.round);
        let all = Arc::make_mut(&mut light.radiosity);
        let mut rest = radiosity;
        for &instance in instances {
            let place = light.model.elements_of(instance);
            let (own, others) = rest.split_at(place.len());
            all[place].copy_from_slice(own);
            rest = others;
        }
        self.light_number += 1;
        self.published = Some(Instant::now());
    }

    fn is_due(&self) -> bool {
        self.published.is_none_or(|last| last.elapsed() >= MIN_PUBLISH_INTERVAL)
    }
}

impl Observer for Board {
    fn prepared(&self, scene: &Scene, prepared: &Prepared) {
        self.change(|state| state.status.prepare(scene, prepared));
    }

    fn baked(&self, number: usize, part: &Baked) {
        self.change(|state| state.status.bake(number, part));
    }

    fn placed(&self, placed: &PlacedParts, cameras: &[Camera]) {
        let run = self.state().status.run;
        let model = Arc::new(Model::new(run, placed, cameras));
        self.change(|state| {
            state.model = Some(model);
            state.light = None;
            state.status.placed = run;
            state.status.phase = Phase::Coupling;
        });
    }

    fn coupled(&self, instance: usize, coupled: &Coupled) {
        self.change(|state| state.status.couple(instance, coupled));
    }

    fn coupled_all(&self, placed: &PlacedParts, coupled: &[Coupled], optics: &Optics) {
        let (row_sums, computed) = (row_sums(placed, coupled), computed(placed, coupled));
        let seconds = seconds(placed, coupled, &StepTimes::none(coupled.len()));
        let optics = Arc::new(optics.clone());
        self.change(|state| {
            (state.row_sums, state.computed) = (Arc::new(row_sums), Arc::new(computed));
            (state.status.seconds, state.status.phase) = (seconds, Phase::Exchange);
            let radiosity = Arc::new(vec![Rgb::BLACK; optics.emission.len()]);
            let model = state.model.clone();
            state.light =
                model.map(|model| RoundLight { model, round: 0, radiosity, irradiance: None, optics });
            (state.began, state.published) = (Some(Instant::now()), None);
        });
    }

    fn settled(&self, outcome: &Outcome, irradiance: &[Rgb]) {
        self.change(|state| {
            let all: Vec<usize> = (0..state.status.instances.len()).collect();
            state.publish(&all, &outcome.radiosity);
            if let Some(light) = &mut state.light {
                light.irradiance = Some(Arc::new(irradiance.to_vec()));
            }
            state.status.phase = Phase::Writing;
        });
    }
}

impl Listener for Board {
    fn round(&self, finished: &FinishedRound) {
        let mut state = self.state();
        state.group += usize::from(finished.number == 1);
        let point = Point {
            group: state.group,
            round: finished.number,
            seconds: state.began.map_or(0.0, |began| began.elapsed().as_secs_f64()),
            bound: finished.convergence.error_bound,
            relative: finished.convergence.relative_bound,
            residual: finished.convergence.residual,
        };
        state.history.add(point);
        let is_due = state.is_due();
        if is_due || finished.is_last {
            state.publish(finished.instances, finished.radiosity);
            let Seconds { step5, step6, step7, step8, .. } = rounds(finished.times);
            state.status.seconds = Seconds { step5, step6, step7, step8, ..state.status.seconds.clone() };
        }
        drop(state);
        if is_due {
            self.changed.send_replace(());
        }
    }

    fn ends_exchange(&self) -> bool {
        self.end_requested.load(Ordering::Relaxed)
    }
}
