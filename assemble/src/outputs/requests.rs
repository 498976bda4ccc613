//! What a run writes and reports beside the light itself.

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

/// What a run writes and reports. The default is that of the command line.
#[derive(Debug, Clone)]
pub struct OutputRequests {
    /// The folder that gets `<scene>/` with everything but the tables below.
    pub folder: PathBuf,
    /// Which pictures to draw.
    pub pictures: Pictures,
    /// A picture from a chosen camera; none for none.
    pub shot: Option<Shot>,
    /// Which lightmaps to write; none to write none.
    pub lightmaps: Option<LightmapOptions>,
    /// A table of points at which to compute light; none for none.
    pub points: Option<PathBuf>,
    /// Where to write the table of elements; none to write none.
    pub elements: Option<PathBuf>,
    /// Where to write for build tools which files were read; none to write nothing.
    pub depfile: Option<PathBuf>,
    /// Number of receivers whose rows are computed exactly, to measure the error of clusters.
    pub exact_rows: ExactRows,
    /// Whether to solve the classic matrix too, and to report the difference.
    pub verify: bool,
    /// Whether to report for each part and block whether it was computed or reused, and why.
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
            exact_rows: ExactRows::default(),
            verify: false,
            explain: false,
        }
    }
}

impl OutputRequests {
    /// The table of light that the picture is compared with, if there is one.
    pub fn reference(&self) -> Option<&Path> {
        self.shot.as_ref().and_then(|shot| shot.against.as_deref())
    }
}
