//! What a viewer is told in words: how far a run is and what became of its parts. In go parts, instances and their origins; out
//! comes plain data for JSON.

use crate::equation::coupling::Coupled;
use crate::report::Report;
use crate::report::seconds::Seconds;
use equilux_bake::oven::Baked;
use equilux_bake::oven::cached::Origin;
use equilux_bake::oven::prepare::{Prepared, PreparedPart};
use equilux_formats::{Instance, Scene};
use serde::Serialize;

/// Where a run is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Files are read, parts get their elements.
    #[default]
    Reading,
    /// Form factors of parts.
    Baking,
    /// Form factors between parts.
    Coupling,
    /// Rounds: the only phase that may be ended early.
    Exchange,
    /// Outputs.
    Writing,
    /// All is written.
    Done,
    /// It ended with an error.
    Failed,
}

impl Phase {
    /// Whether nothing more happens.
    pub fn is_over(self) -> bool {
        matches!(self, Self::Done | Self::Failed)
    }
}

/// What became of some form factors.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BlockState {
    /// Not looked at yet.
    #[default]
    Waiting,
    /// They were in the cache.
    Reused,
    /// They were computed, all or some.
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
    /// What became of its own form factors.
    pub own: BlockState,
    /// The same in a sentence.
    pub reason: String,
}

/// A placed part.
#[derive(Debug, Clone, Default, Serialize)]
pub struct InstanceStatus {
    /// Its name.
    pub name: String,
    /// The number of its part.
    pub part: usize,
    /// What became of what couples it with all others.
    pub coupling: BlockState,
    /// The same in a sentence.
    pub reason: String,
    /// What became of its own form factors where something foreign stands inside it.
    pub inside: Option<BlockState>,
}

/// All of a run but its light.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Status {
    /// Counts the runs of a watched scene; 1 for the first.
    pub run: u32,
    /// The run that last put parts in their places; 0 for none.
    pub placed: u32,
    /// The scene's name.
    pub scene: String,
    /// Where the run is.
    pub phase: Phase,
    /// Whether somebody asked the exchange to end.
    pub stopping: bool,
    /// Whether another run follows when a file changes.
    pub watched: bool,
    /// Number of elements.
    pub elements: usize,
    /// The distinct parts.
    pub parts: Vec<PartStatus>,
    /// The placed parts.
    pub instances: Vec<InstanceStatus>,
    /// The paper's steps: what is known by now.
    pub seconds: Seconds,
    /// Whether the error asked for is proved; none before the end.
    pub converged: Option<bool>,
    /// The outputs, for a person.
    pub outputs: Vec<String>,
    /// What a person should know.
    pub notes: Vec<String>,
    /// Why the run failed.
    pub error: Option<String>,
}

impl Status {
    /// The parts and instances are known.
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

    /// A part is baked.
    pub fn bake(&mut self, number: usize, baked: &Baked) {
        let part = &mut self.parts[number];
        (part.own, part.reason) = (BlockState::from(&baked.form_factors), baked.form_factors.to_string());
    }

    /// An instance is coupled.
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
