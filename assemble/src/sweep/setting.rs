//! One point of the grid: which program task with which options.

use serde::{Deserialize, Serialize};

/// What computes the light.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Our parts, at a tolerance.
    Parts {
        /// `--tolerance`.
        tolerance: f64,
    },
    /// Our parts, compared round by round with the classic matrix; no point of the plots.
    Verified {
        /// `--tolerance`.
        tolerance: f64,
    },
    /// The classic dense matrix, exact.
    Dense,
    /// The classic dense matrix with so many rays a pair.
    Rays(u32),
    /// Progressive refinement, which keeps no matrix, down to a share of unshot light.
    Progressive {
        /// `--unshot`.
        unshot: f64,
    },
}

/// A point of the grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// What computes the light.
    pub kind: Kind,
    /// `--element-size`, metres.
    pub element_size: f64,
    /// Further options, where they are other than by default.
    pub more: Vec<String>,
}

impl Setting {
    /// With no further options.
    pub fn new(kind: Kind, element_size: f64) -> Self {
        Self { kind, element_size, more: vec![] }
    }

    /// With further options, such as `--exchange jacobi`.
    pub fn with(mut self, more: &str) -> Self {
        self.more.extend(more.split_whitespace().map(str::to_owned));
        self
    }

    /// Whether it is one of ours and a point of the plots.
    pub fn is_ours(&self) -> bool {
        matches!(self.kind, Kind::Parts { .. })
    }

    /// Whether it is one of the classic ways.
    pub fn is_classic(&self) -> bool {
        matches!(self.kind, Kind::Dense | Kind::Rays(_) | Kind::Progressive { .. })
    }

    /// Whether a person gets this without options, where elements are so large by default.
    pub fn is_default(&self, element_size: f64) -> bool {
        *self == Self::new(Kind::Parts { tolerance: DEFAULT_TOLERANCE }, element_size)
    }

    /// The arguments of `assemble` that change the light of `scene`, without those that say where to write.
    pub fn arguments(&self, scene: &str) -> Vec<String> {
        let words = match self.kind {
            Kind::Parts { tolerance } => format!("SCENE --tolerance {tolerance}"),
            Kind::Verified { tolerance } => format!("SCENE --tolerance {tolerance} --verify"),
            Kind::Dense => "classic SCENE".to_owned(),
            Kind::Rays(rays) => format!("classic SCENE --rays {rays}"),
            Kind::Progressive { unshot } => format!("classic SCENE --solver progressive --unshot {unshot}"),
        };
        let size = format!("{words} --element-size {}", self.element_size);
        let words = size.split_whitespace().map(|word| if word == "SCENE" { scene } else { word });
        words.map(str::to_owned).chain(self.more.iter().cloned()).collect()
    }

    /// For a person.
    pub fn label(&self) -> String {
        let what = match self.kind {
            Kind::Parts { tolerance } => format!("tolerance {tolerance}"),
            Kind::Verified { tolerance } => format!("tolerance {tolerance}, round by round"),
            Kind::Dense => "classic, dense exact".to_owned(),
            Kind::Rays(1) => "classic, dense, 1 ray a pair".to_owned(),
            Kind::Rays(rays) => format!("classic, dense, {rays} rays a pair"),
            Kind::Progressive { unshot } => format!("classic, progressive to {} % unshot", unshot * 100.0),
        };
        let more = self.more.join(" ").replace("--", "");
        let more = if more.is_empty() { more } else { format!(", {more}") };
        format!("{} m, {what}{more}", self.element_size)
    }
}

/// A setting that was not run.
#[derive(Debug, Clone)]
pub struct Skipped {
    /// The setting.
    pub setting: Setting,
    /// Why not.
    pub why: String,
}

/// What `--tolerance` is unless told.
pub const DEFAULT_TOLERANCE: f64 = 0.01;
