//! Options for a scene and its assembly.

use super::values;
use crate::exchange::settings::{Goal, Method};
use crate::gather::sky::Sky;
use crate::lightmap::{LightmapOptions, Units};
use crate::outputs::requests::{OutputRequests, Pictures};
use crate::proof::sample::ExactRows;
use crate::run::job::Job;
use crate::solve::settings::SolveSettings;
use clap::Args;
use equilux_bake::cli::options::SceneOptions;
use equilux_bake::oven::prepare::{Preparation, RowMethod};
use equilux_formats::LightUnits;
use std::path::PathBuf;

/// Options for a scene and its assembly.
#[derive(Args)]
pub struct AssemblyOptions {
    /// The scene, a .gltf or .glb file, or a folder with one
    #[arg(required = true, value_parser = values::scene)]
    pub scene: Option<PathBuf>,
    #[command(flatten)]
    pub options: SceneOptions,
    /// Folder for the outputs, written to DIR/SCENE/: the result as a picture and as a model, lightmaps and tables
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// How parts exchange light
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    exchange: Method,
    /// Maximum number of rounds
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// End the exchange when this error bound is proved, relative to the brightest radiosity; 0 continues until
    /// rounding [default: 1e-6, with --verify 0]
    #[arg(long, value_name = "BOUND", value_parser = values::error_bound)]
    error: Option<f64>,
    /// Compare about this many rows with exact ones: rows by rays, or those with clusters of --rows exact, of which a sharp bound is
    /// proved in all rows. By default 256 of the latter, and of rows by rays their noise alone; 0 measures nothing
    #[arg(long, value_name = "N|all", value_parser = values::exact_rows)]
    exact_rows: Option<ExactRows>,
    /// Start from the light of the last run with --warm instead of darkness, and store this run's light: fewer rounds
    /// after a small change. The bytes of the outputs then depend on earlier runs
    #[arg(long)]
    warm: bool,
    /// Pictures to draw; the result as a model is always written
    #[arg(long, value_name = "WHICH", default_value = "last")]
    pictures: Pictures,
    /// The sky: a radiance in W/(m² sr), one number or R,G,B, or an equirectangular picture, .hdr or .exr, with -Z in
    /// the middle, +X to the right of it, and +Y at the top
    #[arg(long, value_name = "RADIANCE|FILE", value_parser = values::sky)]
    sky: Option<Sky>,
    /// Units of the intensities of the file's lights [default: those of Blender's exporter for files that it wrote,
    /// otherwise radiometric]
    #[arg(long, value_name = "UNITS")]
    light_units: Option<LightUnits>,
    /// Write lightmaps: lightmap.exr and .png, a list of their contents, and models that carry them
    #[arg(long)]
    lightmaps: bool,
    /// Maximum size of texels of lightmaps [default: results in about 1024 x 1024 texels]
    #[arg(long, value_name = "METRES", requires = "lightmaps", value_parser = values::texel_size)]
    texel_size: Option<f64>,
    /// Maximum side of an image of lightmaps, a multiple of 4; what does not fit goes to further images
    #[arg(long, value_name = "TEXELS", requires = "lightmaps", value_parser = values::atlas_size, default_value = "4096")]
    atlas_size: u32,
    /// Units of the numbers in lightmap.exr
    #[arg(long, value_name = "UNITS", requires = "lightmaps", default_value = "irradiance")]
    lightmap_units: Units,
    /// Also write the mean direction of the light of each texel: lightmap_direction.exr
    #[arg(long, requires = "lightmaps")]
    lightmap_directions: bool,
    /// Also solve the classic whole-scene matrix and print the largest difference
    #[arg(long)]
    verify: bool,
    /// Also write the irradiance at the points of this table (columns x, y, z, nx, ny, nz), gathered anew at each:
    /// points.csv
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    /// Write a table of all elements, their optics and their light
    #[arg(long, value_name = "FILE.csv")]
    elements: Option<PathBuf>,
    /// Write a dependency file for Make, Ninja or CMake that lists the input files; its target is result.glb
    #[arg(long, value_name = "FILE")]
    depfile: Option<PathBuf>,
}

impl AssemblyOptions {
    /// The choices about elements and parts. The classic matrix is exact, so what is compared with it is too.
    fn preparation(&self) -> Preparation {
        let chosen = self.options.preparation();
        let rows = if self.verify { RowMethod::Exact } else { chosen.rows };
        Preparation { rows, ..chosen }
    }

    /// The job, without explanations and without a picture from a camera.
    pub fn job(&self) -> Job {
        let default = if self.verify { Goal { error: 0.0, ..Goal::default() } } else { Goal::default() };
        Job {
            scene: self.scene.clone().expect("a task has a scene"),
            settings: SolveSettings {
                cache: self.options.cache.clone(),
                preparation: self.preparation(),
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
                    atlas_size: self.atlas_size,
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
