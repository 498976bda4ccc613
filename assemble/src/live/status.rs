//! The status of a run as text: its phase, and the state of its parts and blocks. Input: parts, instances and their
//! origins. Output: plain data for JSON.

use crate::equation::coupling::Coupled;
use crate::report::Report;
use crate::report::seconds::Seconds;
use equilux_bake::oven::Baked;
use equilux_bake::oven::cached::Origin;
use equilux_bake::oven::prepare::{Prepared, PreparedPart};
use equilux_formats::{Instance, Scene};
use serde::Serialize;

/// The phase of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Files are read, and parts are divided into elements.
    #[default]
    Reading,
    /// Form factors within parts are computed.
    Baking,
    /// Form factors between parts are computed.
    Coupling,
    /// Rounds of the exchange; the only phase that can end early.
    Exchange,
    /// Outputs are written.
    Writing,
    /// All is written.
    Done,
    /// The run ended with an error.
    Failed,
}

impl Phase {
    /// Whether the run is over.
    pub fn is_over(self) -> bool {
        matches!(self, Self::Done | Self::Failed)
    }
}

/// The state of a block.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BlockState {
    /// Not processed yet.
    #[default]
    Waiting,
    /// Read from the cache.
    Reused,
    /// Computed, entirely or in part.
    Computed,
}

impl From<&Origin> for BlockState {
    fn from(origin: &Origin) -> Self {
        if origin.is_reused() { Self::Reused } else { Self::Computed }
    }
}

/// A distinct part.
#[derive(Debug, Clone, Default, Serialize)]
pub struct PartStatus {
    /// Its name.
    pub name: String,
    /// Its elements.
    pub elements: usize,
    /// State of its self block.
    pub own: BlockState,
    /// The reason for this state, as a sentence.
    pub reason: String,
}

/// A placed part.
#[derive(Debug, Clone, Default, Serialize)]
pub struct InstanceStatus {
    /// Its name.
    pub name: String,
    /// The number of its part.
    pub part: usize,
    /// State of its coupling block.
    pub coupling: BlockState,
    /// The reason for this state, as a sentence.
    pub reason: String,
    /// State of its self block with other parts inside it, if there are any.
    pub inside: Option<BlockState>,
}

/// The status of a run, without its light.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Status {
    /// Number of the run of a watched scene; 1 for the first.
    pub run: u32,
    /// The run that last placed parts; 0 for none.
    pub placed: u32,
    /// The scene's name.
    pub scene: String,
    /// The phase of the run.
    pub phase: Phase,
    /// Whether the end of the exchange was requested.
    pub stopping: bool,
    /// Whether the run repeats when a file changes.
    pub watched: bool,
    /// Number of elements.
    pub elements: usize,
    /// The distinct parts.
    pub parts: Vec<PartStatus>,
    /// The placed parts.
    pub instances: Vec<InstanceStatus>,
    /// The times of the paper's steps so far.
    pub seconds: Seconds,
    /// Whether the required error bound is proved; none before the end.
    pub converged: Option<bool>,
    /// The paths of the outputs.
    pub outputs: Vec<String>,
    /// Notes of the report.
    pub notes: Vec<String>,
    /// The error, if the run failed.
    pub error: Option<String>,
}

impl Status {
    /// Record the parts and instances.
    pub fn prepare(&mut self, scene: &Scene, prepared: &Prepared) {
        self.scene.clone_from(&scene.name);
        self.phase = Phase::Baking;
        let part = |part: &PreparedPart| PartStatus {
            name: part.name.clone(),
            elements: part.geometry.elements.len(),
            ..PartStatus::default()
        };
        self.parts = prepared.parts.iter().map(part).collect();
        let instance = |instance: &Instance| InstanceStatus {
            name: instance.name.clone(),
            part: instance.part.index(),
            ..InstanceStatus::default()
        };
        self.instances = prepared.instances.iter().map(instance).collect();
        self.elements = self.instances.iter().map(|instance| self.parts[instance.part].elements).sum();
    }

    /// Record a baked part.
    pub fn bake(&mut self, number: usize, baked: &Baked) {
        let part = &mut self.parts[number];
        (part.own, part.reason) = (BlockState::from(&baked.form_factors), baked.form_factors.to_string());
    }

    /// Record the blocks of an instance.
    pub fn couple(&mut self, number: usize, coupled: &Coupled) {
        let instance = &mut self.instances[number];
        (instance.coupling, instance.reason) =
            (BlockState::from(&coupled.origin), coupled.origin.to_string());
        instance.inside = coupled.corrected.as_ref().map(|corrected| BlockState::from(&corrected.origin));
    }

    /// All is written.
    pub fn end(&mut self, report: &Report) {
        self.phase = Phase::Done;
        self.converged = Some(report.converged);
        self.seconds = report.seconds.clone();
        self.outputs.clone_from(&report.outputs);
        self.notes.clone_from(&report.notes);
    }
}
