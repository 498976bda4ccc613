//! One point of the grid: the method and its options.

use equilux_bake::treecode::rays_for_tolerance;
use serde::{Deserialize, Serialize};

/// The method.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Parts, at a tolerance.
    Parts {
        /// `--tolerance`.
        tolerance: f64,
    },
    /// Parts, compared round by round with the classic matrix; not in the charts of errors.
    Verified {
        /// `--tolerance`.
        tolerance: f64,
    },
    /// The classic dense matrix, exact.
    Dense,
    /// The classic dense matrix with this many rays for each pair.
    Rays(u32),
    /// Progressive refinement, which stores no matrix, down to a share of unshot light.
    Progressive {
        /// `--unshot`.
        unshot: f64,
    },
}

/// A point of the grid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// The method.
    pub kind: Kind,
    /// `--element-size`, metres.
    pub element_size: f64,
    /// Further options that differ from the default.
    pub more: Vec<String>,
}

impl Setting {
    /// A setting without further options.
    pub fn new(kind: Kind, element_size: f64) -> Self {
        Self { kind, element_size, more: vec![] }
    }

    /// The same with further options, such as `--exchange jacobi`.
    pub fn with(mut self, more: &str) -> Self {
        self.more.extend(more.split_whitespace().map(str::to_owned));
        self
    }

    /// Whether it is a run of parts that competes in the charts.
    pub fn is_ours(&self) -> bool {
        matches!(self.kind, Kind::Parts { .. })
    }

    /// Whether it is a classic method.
    pub fn is_classic(&self) -> bool {
        matches!(self.kind, Kind::Dense | Kind::Rays(_) | Kind::Progressive { .. })
    }

    /// Whether these are the default settings of a scene with this element size by default, metres.
    pub fn is_default(&self, element_size: f64) -> bool {
        *self == Self::new(Kind::Parts { tolerance: DEFAULT_TOLERANCE }, element_size)
    }

    /// The arguments of `assemble` for the light of `scene`, without those for outputs.
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

    /// The setting in words.
    pub fn label(&self) -> String {
        let what = match self.kind {
            Kind::Parts { tolerance } if tolerance > 0.0 && self.more.is_empty() => {
                format!("tolerance {tolerance}, {} rays a row", rays_for_tolerance(tolerance))
            }
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
    /// The reason.
    pub why: String,
}

/// The default of `--tolerance`.
pub const DEFAULT_TOLERANCE: f64 = 0.01;
