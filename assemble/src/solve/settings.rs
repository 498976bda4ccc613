//! Settings of a solution: elements and parts, form factors, lights, and the exchange.

use crate::equation::environment::Environment;
use crate::exchange::settings::{Goal, Method};
use crate::gather::sky::Sky;
use equilux_bake::oven::prepare::Preparation;
use equilux_formats::{LightUnits, Result};
use std::path::PathBuf;

/// Settings of a solution. The default is that of the command line.
#[derive(Debug, Clone)]
pub struct SolveSettings {
    /// The cache folder.
    pub cache: PathBuf,
    /// Elements, parts, accuracy of form factors, and local solvers.
    pub preparation: Preparation,
    /// The units of the intensities of the file's lights; none for the units that each file suggests.
    pub light_units: Option<LightUnits>,
    /// Radiance from outside the scene; none for darkness.
    pub sky: Option<Sky>,
    /// How parts exchange light.
    pub method: Method,
    /// When the exchange ends.
    pub goal: Goal,
    /// Whether to start from the stored radiosity of the last warm run of the scene, and to store this one for the
    /// next.
    pub warm: bool,
}

impl Default for SolveSettings {
    fn default() -> Self {
        Self {
            cache: ".equilux".into(),
            preparation: Preparation::default(),
            light_units: None,
            sky: None,
            method: Method::Auto,
            goal: Goal::default(),
            warm: false,
        }
    }
}

impl SolveSettings {
    /// The light from outside the scene. Fails if the picture of the sky cannot be read.
    pub fn environment(&self) -> Result<Environment> {
        Environment::read(self.light_units, self.sky.as_ref())
    }
}
