//! A scene on the command line, and how to assemble it.

use super::values;
use crate::exchange::settings::Goal;
use crate::exchange::settings::Method;
use crate::gather::sky::Sky;
use crate::lightmap::{LightmapOptions, Units};
use crate::outputs::requests::{OutputRequests, Pictures};
use crate::proof::sample::ExactRows;
use crate::run::job::Job;
use crate::solve::settings::SolveSettings;
use clap::Args;
use equilux_bake::cli::options::SceneOptions;
use equilux_formats::LightUnits;
use std::path::PathBuf;

/// A scene, and how to assemble it.
#[derive(Args)]
pub struct Assembly {
    /// The scene, a .gltf or .glb file, or a folder with one
    #[arg(required = true, value_parser = values::scene)]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub options: SceneOptions,
    /// Folder for the outputs; they go to DIR/SCENE/: the result as a picture and as a model, lightmaps and tables
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// How parts exchange light
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    exchange: Method,
    /// At most this many rounds
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// End the exchange when this error of it is proved, relative to the brightest radiosity; 0 goes
    /// on until rounding [default: 1e-6, with --verify 0]
    #[arg(long, value_name = "BOUND", value_parser = values::error_bound)]
    error: Option<f64>,
    /// Measure what --tolerance costs in about this many exact rows, or in all, which proves a sharp
    /// bound; 0 measures nothing
    #[arg(long, value_name = "N|all", default_value = "256", value_parser = values::exact_rows)]
    exact_rows: ExactRows,
    /// Start from the light of the last run with --warm instead of darkness, and keep this run's: fewer
    /// rounds after a small change. The bytes of the outputs then depend on what ran before
    #[arg(long)]
    warm: bool,
    /// Which pictures to draw; the result as a model is always written
    #[arg(long, value_name = "WHICH", default_value = "last")]
    pictures: Pictures,
    /// What shines from all around: a radiance in W/(m² sr), one number or R,G,B, or an equirectangular picture,
    /// .hdr or .exr, whose middle is -Z, right of that +X, and top +Y
    #[arg(long, value_name = "RADIANCE|FILE", value_parser = values::sky)]
    sky: Option<Sky>,
    /// What the intensities of the file's lights mean [default: what Blender's exporter writes if that wrote the file, else
    /// radiometric]
    #[arg(long, value_name = "UNITS")]
    light_units: Option<LightUnits>,
    /// Write lightmaps: lightmap.exr and .png, what lies where in them, and models that carry them
    #[arg(long)]
    lightmaps: bool,
    /// Texels of lightmaps are at most so large [default: what makes about 1024 x 1024 of them]
    #[arg(long, value_name = "METRES", requires = "lightmaps", value_parser = values::texel_size)]
    texel_size: Option<f64>,
    /// What the numbers in lightmap.exr are
    #[arg(long, value_name = "UNITS", requires = "lightmaps", default_value = "irradiance")]
    lightmap_units: Units,
    /// Also write where the light of each texel comes from: lightmap_direction.exr
    #[arg(long, requires = "lightmaps")]
    lightmap_directions: bool,
    /// Also solve the classic whole-scene matrix and print the largest difference
    #[arg(long)]
    verify: bool,
    /// Also write the irradiance at the points of this table (columns x, y, z, nx, ny, nz), gathered there with exact
    /// visibility: points.csv
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    /// Write a table of all elements, their optics and their light
    #[arg(long, value_name = "FILE.csv")]
    elements: Option<PathBuf>,
    /// Write for Make, Ninja or CMake which files were read; the target in it is the result.glb
    #[arg(long, value_name = "FILE")]
    depfile: Option<PathBuf>,
}

impl Assembly {
    /// The job, with nothing explained and no picture from a camera.
    pub fn job(&self) -> Job {
        let default = if self.verify { Goal { error: 0.0, ..Goal::default() } } else { Goal::default() };
        Job {
            scene: self.scene.clone().expect("a task has a scene"),
            settings: SolveSettings {
                cache: self.options.cache.clone(),
                preparation: self.options.preparation(),
                light_units: self.light_units,
                sky: self.sky.clone(),
                method: self.exchange,
                goal: Goal {
                    error: self.error.unwrap_or(default.error),
                    rounds: self.rounds.unwrap_or(default.rounds),
                },
                warm: self.warm,
            },
            outputs: OutputRequests {
                folder: self.out.clone(),
                pictures: self.pictures,
                shot: None,
                lightmaps: self.lightmaps.then_some(LightmapOptions {
                    texel_size: self.texel_size,
                    directions: self.lightmap_directions,
                    units: self.lightmap_units,
                }),
                points: self.points.clone(),
                elements: self.elements.clone(),
                depfile: self.depfile.clone(),
                exact_rows: self.exact_rows,
                verify: self.verify,
                explain: false,
            },
            cache_limit: self.options.cache_limit,
        }
    }
}
