//! A complete run: the scene, the settings of its solution, and the outputs.

use crate::gather::points::{self, Place};
use crate::gather::sky::Sky;
use crate::outputs::check_writable;
use crate::outputs::requests::OutputRequests;
use crate::picture::difference::ReferenceLight;
use crate::solve::settings::SolveSettings;
use equilux_bake::oven::stamp;
use equilux_formats::{Result, Scene};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// The description of a run.
#[derive(Debug, Clone)]
pub struct Job {
    /// The scene's file.
    pub scene: PathBuf,
    /// Settings of the solution.
    pub settings: SolveSettings,
    /// The outputs and the contents of the report.
    pub outputs: OutputRequests,
    /// Maximum size of the cache after the run, bytes; none for no limit.
    pub cache_limit: Option<u64>,
}

impl Job {
    /// A job for this scene with default settings and outputs.
    pub fn new(scene: impl Into<PathBuf>) -> Self {
        let (settings, outputs) = (SolveSettings::default(), OutputRequests::default());
        Self { scene: scene.into(), settings, outputs, cache_limit: None }
    }

    /// The input files that do not belong to the scene itself.
    pub fn beside(&self) -> impl Iterator<Item = &Path> {
        let sky = self.settings.sky.as_ref().and_then(Sky::file);
        [sky, self.outputs.points.as_deref(), self.outputs.reference()].into_iter().flatten()
    }

    /// Check before any long computation that outputs can be written and that the camera shows something. Fails
    /// otherwise.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        check_writable(&self.outputs, scene)?;
        self.outputs.depfile.as_deref().map(stamp::check).transpose()?;
        self.outputs.shot.as_ref().map_or(Ok(()), |shot| shot.check(&scene.cameras, &self.scene))
    }

    /// The points at which to compute light and the reference light, if requested, in scene coordinates. `origin`:
    /// the origin of the scene in the tables' coordinates, metres. Fails if a table cannot be read.
    pub fn tables(&self, origin: DVec3) -> Result<(Option<Vec<Place>>, Option<ReferenceLight>)> {
        let places = self.outputs.points.as_deref().map(|file| points::read(file, origin)).transpose()?;
        Ok((places, self.outputs.reference().map(|file| ReferenceLight::read(file, origin)).transpose()?))
    }
}
