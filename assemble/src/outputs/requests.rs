//! Requested outputs and contents of the report.

use crate::lightmap::LightmapOptions;
use crate::picture::shot::Shot;
use crate::proof::sample::ExactRows;
use std::path::{Path, PathBuf};

/// Which pictures are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Pictures {
    /// The result, rounds 1 to 8, 16, 32 and so on, the first of them side by side, and the elements
    Rounds,
    /// The result
    #[default]
    Last,
    /// None
    None,
}

/// The outputs and the contents of the report of a run. The default is that of the command line.
#[derive(Debug, Clone)]
pub struct OutputRequests {
    /// The folder in which `<scene>/` is created, for all outputs except the tables below.
    pub folder: PathBuf,
    /// Which pictures to draw.
    pub pictures: Pictures,
    /// A picture from a chosen camera, if requested.
    pub shot: Option<Shot>,
    /// Options of the lightmaps, if requested.
    pub lightmaps: Option<LightmapOptions>,
    /// A table of points at which to compute light, if requested.
    pub points: Option<PathBuf>,
    /// The path of the table of elements, if requested.
    pub elements: Option<PathBuf>,
    /// The path of a dependency file for build tools, if requested.
    pub depfile: Option<PathBuf>,
    /// Number of receivers whose rows are computed exactly, to measure the error of clusters or of rows by rays. By default the
    /// former, and of the latter the noise alone; if none, nothing is measured.
    pub exact_rows: Option<ExactRows>,
    /// Whether to solve the classic matrix too, and report the difference.
    pub verify: bool,
    /// Whether to report for each part and block whether it was computed, reused or skipped, and why.
    pub explain: bool,
}

impl Default for OutputRequests {
    fn default() -> Self {
        Self {
            folder: "out".into(),
            pictures: Pictures::default(),
            shot: None,
            lightmaps: None,
            points: None,
            elements: None,
            depfile: None,
            exact_rows: None,
            verify: false,
            explain: false,
        }
    }
}

impl OutputRequests {
    /// The reference light for the picture, if there is one.
    pub fn reference(&self) -> Option<&Path> {
        self.shot.as_ref().and_then(|shot| shot.against.as_deref())
    }
}
