//! A run in full: the scene, how to solve it, what to write.

use crate::gather::points::{self, Place};
use crate::gather::sky::Sky;
use crate::outputs::check_writable;
use crate::outputs::requests::OutputRequests;
use crate::picture::difference::Reference;
use crate::solve::settings::SolveSettings;
use equilux_bake::oven::stamp;
use equilux_formats::{Result, Scene};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// What to assemble, and how.
#[derive(Debug, Clone)]
pub struct Job {
    /// The scene's file.
    pub scene: PathBuf,
    /// How to solve it.
    pub settings: SolveSettings,
    /// What to write and to report.
    pub outputs: OutputRequests,
    /// The most bytes that the cache may hold after the run; none to let it grow.
    pub cache_limit: Option<u64>,
}

impl Job {
    /// The scene of this file, with default settings and outputs.
    pub fn new(scene: impl Into<PathBuf>) -> Self {
        let (settings, outputs) = (SolveSettings::default(), OutputRequests::default());
        Self { scene: scene.into(), settings, outputs, cache_limit: None }
    }

    /// The files that are read beside those of the scene.
    pub fn beside(&self) -> impl Iterator<Item = &Path> {
        let sky = self.settings.sky.as_ref().and_then(Sky::file);
        [sky, self.outputs.points.as_deref(), self.outputs.reference()].into_iter().flatten()
    }

    /// Fail where outputs could not be written or nothing could be seen, before hours are spent on them.
    pub fn check(&self, scene: &Scene) -> Result<()> {
        check_writable(&self.outputs, scene)?;
        self.outputs.depfile.as_deref().map(stamp::check).transpose()?;
        self.outputs.shot.as_ref().map_or(Ok(()), |shot| shot.check(&scene.cameras, &self.scene))
    }

    /// The points to compute light at and the light to compare with, where they are asked for, in scene coordinates, whose
    /// origin is `origin` in those of the tables.
    pub fn tables(&self, origin: DVec3) -> Result<(Option<Vec<Place>>, Option<Reference>)> {
        let places = self.outputs.points.as_deref().map(|file| points::read(file, origin)).transpose()?;
        Ok((places, self.outputs.reference().map(|file| Reference::read(file, origin)).transpose()?))
    }
}
