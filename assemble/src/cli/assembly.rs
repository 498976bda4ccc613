//! A scene on the command line, and how to assemble it.

use super::values;
use crate::exchange::{Goal, Method};
use crate::gather::sky::Sky;
use crate::lightmap::{Units, Wanted};
use crate::proof::sample::ExactRows;
use crate::run::{Job, Pictures};
use clap::{Args, ValueEnum};
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
    /// Folder for the outputs; they go to DIR/<scene>/: pictures of the first eight rounds, of rounds
    /// 16, 32, 64 and so on, and of the last, some of them side by side; the result as a picture and as a model
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// How parts exchange light
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    exchange: Exchange,
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
    #[arg(long, value_name = "WHICH", default_value = "rounds")]
    pictures: Drawn,
    /// What shines from all around: a radiance in W/(m² sr), one number or R,G,B, or an equirectangular picture,
    /// .hdr or .exr, whose middle is -Z, right of that +X, and top +Y
    #[arg(long, value_name = "RADIANCE|FILE", value_parser = values::sky)]
    sky: Option<Sky>,
    /// What the intensities of the file's lights mean [default: what Blender's exporter writes if that wrote the file, else
    /// radiometric]
    #[arg(long, value_name = "UNITS")]
    light_units: Option<Intensities>,
    /// Write lightmaps: lightmap.exr and .png, what lies where in them, and models that carry them
    #[arg(long)]
    lightmaps: bool,
    /// Texels of lightmaps are at most so large [default: what makes about 1024 x 1024 of them]
    #[arg(long, value_name = "METRES", requires = "lightmaps", value_parser = values::texel_size)]
    texel_size: Option<f64>,
    /// What the numbers in lightmap.exr are
    #[arg(long, value_name = "UNITS", requires = "lightmaps", default_value = "irradiance")]
    lightmap_units: LightmapUnits,
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

/// The exchange's name on the command line.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Exchange {
    /// GMRES, with a coarse space where light goes to and fro for long
    Auto,
    /// All parts at once, as the paper does
    Jacobi,
    /// One part after the other, with the newest light
    GaussSeidel,
    /// GMRES, always with a coarse space of the parts' answers to light from outside
    Gmres,
}

/// The pictures' name on the command line.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Drawn {
    /// Of rounds, of the end, and of the elements
    Rounds,
    /// Of the end
    Last,
    /// None
    None,
}

/// The units of lights on the command line.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum Intensities {
    /// W/sr and W/m², number for number what the file calls candela and lux
    Radiometric,
    /// Candela and lux of light of 683 lm/W: what Blender writes by default (Standard)
    Photometric,
    /// Watts of whole lamps: what Blender writes with `Raw`, and did before version 3.4
    BlenderRaw,
}

/// The units' name on the command line.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum LightmapUnits {
    /// Irradiance, W/m², as three.js takes it
    Irradiance,
    /// Irradiance over pi, what Bevy multiplies by its lightmap_exposure (683 for watts) and takes for cd/m²
    Bevy,
}

impl From<Intensities> for LightUnits {
    fn from(units: Intensities) -> Self {
        match units {
            Intensities::Radiometric => Self::Radiometric,
            Intensities::Photometric => Self::Photometric,
            Intensities::BlenderRaw => Self::BlenderRaw,
        }
    }
}

impl Assembly {
    /// The job, with nothing explained and no picture asked for.
    pub fn job(&self) -> Job {
        let default_error = if self.verify { 0.0 } else { 1e-6 };
        Job {
            scene: self.scene.clone().expect("a task has a scene"),
            cache: self.options.cache.clone(),
            out: self.out.clone(),
            preparation: self.options.preparation(),
            method: match self.exchange {
                Exchange::Auto => Method::Auto,
                Exchange::Jacobi => Method::Jacobi,
                Exchange::GaussSeidel => Method::GaussSeidel,
                Exchange::Gmres => Method::Gmres,
            },
            goal: Goal {
                error: self.error.unwrap_or(default_error),
                rounds: self.rounds.unwrap_or(usize::MAX),
            },
            exact_rows: self.exact_rows,
            explain: false,
            verify: self.verify,
            warm: self.warm,
            pictures: match self.pictures {
                Drawn::Rounds => Pictures::Rounds,
                Drawn::Last => Pictures::Last,
                Drawn::None => Pictures::None,
            },
            light_units: self.light_units.map(Into::into),
            sky: self.sky.clone(),
            lightmaps: self.lightmaps.then_some(Wanted {
                texel_size: self.texel_size,
                directions: self.lightmap_directions,
                units: match self.lightmap_units {
                    LightmapUnits::Irradiance => Units::Irradiance,
                    LightmapUnits::Bevy => Units::Bevy,
                },
            }),
            shot: None,
            points: self.points.clone(),
            elements: self.elements.clone(),
            depfile: self.depfile.clone(),
            cache_limit: self.options.cache_limit,
        }
    }
}
