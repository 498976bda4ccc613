//! The command line of `assemble classic`.

use crate::classic::{ClassicJob, ClassicReport, Way, run};
use crate::cli::values::{self, sky};
use crate::gather::sky::Sky;
use clap::{Args, ValueEnum};
use equilux_bake::cli::options::element_size;
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_formats::LightUnits;
use std::path::PathBuf;

/// A scene, and how to solve it the classic way.
#[derive(Args)]
pub struct Arguments {
    /// The scene, a .gltf or .glb file, or a folder with one
    #[arg(value_parser = values::scene)]
    scene: PathBuf,
    /// Largest edge of an element in metres, or `mesh` for the mesh's own faces [default: suits the scene]
    #[arg(long, value_name = "METRES|mesh", value_parser = element_size)]
    element_size: Option<ElementSize>,
    /// Tell what sees what with this many rays a pair instead of exactly
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    rays: Option<u32>,
    /// Who finds the light
    #[arg(long, value_name = "SOLVER", default_value = "matrix")]
    solver: Solver,
    /// Progressive refinement ends when this share of the emitted light is left unshot
    #[arg(long, value_name = "SHARE", default_value = "0.01", value_parser = share)]
    unshot: f64,
    /// Folder for the outputs; they go to DIR/SCENE/
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Gather light at the points in this table, as without `classic`
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    /// What shines from all around, as without `classic`
    #[arg(long, value_name = "RADIANCE|FILE", value_parser = sky)]
    sky: Option<Sky>,
    /// What the intensities of the file's lights mean, as without `classic`
    #[arg(long, value_name = "UNITS")]
    light_units: Option<LightUnits>,
    /// Threads to use [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
    /// Print one JSON object on stdout and nothing else
    #[arg(long)]
    pub json: bool,
}

/// The classic solvers.
#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Solver {
    /// The dense matrix of all pairs, and GMRES on it
    Matrix,
    /// Progressive refinement: the brightest unshot elements first, exact form factors when they shoot, nothing kept
    Progressive,
}

impl Arguments {
    /// Solve the scene.
    pub fn run(&self, monitor: &Monitor) -> anyhow::Result<ClassicReport> {
        if let Some(threads) = self.threads {
            rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global()?;
        }
        let way = match (self.solver, self.rays) {
            (Solver::Matrix, None) => Way::Exact,
            (Solver::Matrix, Some(rays)) => Way::Rays(rays),
            (Solver::Progressive, _) => Way::Progressive(self.unshot),
        };
        let job = ClassicJob {
            scene: self.scene.clone(),
            element_size: self.element_size,
            way,
            light_units: self.light_units,
            sky: self.sky.clone(),
            out: self.out.clone(),
            points: self.points.clone(),
        };
        Ok(run(&job, monitor)?)
    }
}

impl ClassicReport {
    /// For a person.
    pub fn text(&self) -> String {
        let seconds = &self.seconds;
        let shots = self.shots.map(|shots| format!(", {shots} shots")).unwrap_or_default();
        let mut text = format!(
            "{}: {} elements, the classic way: light in {:.2} s (form factors {:.2} s summed over threads{shots}), matrix of {} bytes\n",
            self.scene, self.elements, seconds.solve, seconds.form_factors, self.bytes.stored
        );
        self.notes.iter().for_each(|note| text += &format!("note: {note}\n"));
        self.outputs.iter().for_each(|path| text += &format!("{path}\n"));
        text
    }
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if share > 0.0 && share < 1.0 => Ok(share),
        _ => Err("a share is a number between 0 and 1".into()),
    }
}
