//! What one run in a process of its own told: its facts, from the report it printed, and its light at the points. Kept as
//! JSON so that a sweep that was stopped goes on where it was.

use super::setting::Setting;
use crate::report::seconds::Seconds;
use equilux_formats::Rgb;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A finished run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Run {
    /// What was asked for.
    pub setting: Setting,
    /// The command line, for a person to repeat it.
    pub command: String,
    /// Wall time of the whole process, seconds.
    pub wall: f64,
    /// What its report says.
    pub facts: Facts,
    /// Its light at the points, in their order; none for those that lie on no surface.
    pub light: Vec<Option<PointLight>>,
}

/// Light at a point.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PointLight {
    /// Irradiance gathered at the point itself, W/m².
    pub gathered: Rgb,
    /// Irradiance of the element it lies on, W/m².
    pub element: Rgb,
}

/// What a sweep reads of a report; the same names as there.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Facts {
    /// Number of elements.
    pub elements: usize,
    /// Where time went.
    pub seconds: Seconds,
    /// Memory.
    pub bytes: Bytes,
    /// The exchange, round by round.
    pub rounds: Vec<Round>,
    /// Unknowns of the coarse space.
    pub coarse_unknowns: usize,
    /// Number of instances.
    pub instances: usize,
    /// What became of blocks.
    pub blocks: Blocks,
    /// Shots of progressive refinement.
    pub shots: Option<usize>,
}

/// Memory.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Bytes {
    /// All form factors as they are kept.
    pub stored: usize,
    /// The most the process held.
    pub peak_rss: Option<usize>,
}

/// A round.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Round {
    /// What is proved, W/m²; null before anything is.
    pub error_bound: Option<f64>,
    /// The largest error of any element, W/m².
    pub true_error: Option<f64>,
}

/// Blocks.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Blocks {
    /// What was left out because it changes no radiosity, and how often, by reason.
    pub coupling_left_out: BTreeMap<String, usize>,
}
