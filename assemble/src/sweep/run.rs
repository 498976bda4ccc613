//! The result of one run: facts from the report that its process printed, and its light at the points. Kept as JSON, so that
//! a sweep that was stopped continues where it ended.

use super::setting::Setting;
use crate::report::seconds::Seconds;
use equilux_formats::Rgb;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A finished run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Run {
    /// The setting.
    pub setting: Setting,
    /// The command line that repeats it.
    pub command: String,
    /// Wall time of the whole process, seconds.
    pub wall: f64,
    /// Facts from its report.
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

/// The fields of a report that a sweep reads, under the same names.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Facts {
    /// Number of elements.
    pub elements: usize,
    /// Times.
    pub seconds: Seconds,
    /// Memory.
    pub bytes: Bytes,
    /// The exchange, round by round.
    pub rounds: Vec<Round>,
    /// Unknowns of the coarse space.
    pub coarse_unknowns: usize,
    /// Number of instances.
    pub instances: usize,
    /// Computed, reused and skipped blocks.
    pub blocks: Blocks,
    /// Shots of progressive refinement.
    pub shots: Option<usize>,
}

/// Memory.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Bytes {
    /// Size of the stored form factors.
    pub stored: usize,
    /// Peak memory of the process.
    pub peak_rss: Option<usize>,
}

/// A round.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Round {
    /// The proved bound, W/m²; null before there is one.
    pub error_bound: Option<f64>,
    /// The largest error of any element, W/m².
    pub true_error: Option<f64>,
}

/// Blocks.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Blocks {
    /// The number of blocks that were skipped because they change no radiosity, by reason.
    pub coupling_left_out: BTreeMap<String, usize>,
}
