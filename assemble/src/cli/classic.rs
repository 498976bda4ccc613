//! The command line of `assemble classic`.

use crate::classic::{ClassicJob, ClassicMethod, ClassicReport, run};
use crate::cli::values::{self, sky};
use crate::gather::sky::Sky;
use clap::{Args, ValueEnum};
use equilux_bake::cli::options::element_size;
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_formats::LightUnits;
use std::path::PathBuf;

/// Options for a scene and its classic solution.
#[derive(Args)]
pub struct Arguments {
    /// The scene, a .gltf or .glb file, or a folder with one
    #[arg(value_parser = values::scene)]
    scene: PathBuf,
    /// Largest edge of an element in metres, or `mesh` for the mesh's own faces [default: suits the scene]
    #[arg(long, value_name = "METRES|mesh", value_parser = element_size)]
    element_size: Option<ElementSize>,
    /// Test visibility with this many rays for each pair instead of exactly
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    rays: Option<u32>,
    /// Solver
    #[arg(long, value_name = "SOLVER", default_value = "matrix")]
    solver: Solver,
    /// Progressive refinement ends when this share of the emitted power is unshot
    #[arg(long, value_name = "SHARE", default_value = "0.01", value_parser = share)]
    unshot: f64,
    /// Folder for the outputs, written to DIR/SCENE/
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Gather light at the points in this table, as without `classic`
    #[arg(long, value_name = "FILE.csv")]
    points: Option<PathBuf>,
    /// The sky, as without `classic`
    #[arg(long, value_name = "RADIANCE|FILE", value_parser = sky)]
    sky: Option<Sky>,
    /// Units of the intensities of the file's lights, as without `classic`
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
    /// The dense matrix of all pairs of elements, solved by GMRES
    Matrix,
    /// Progressive refinement: the elements with the most unshot power shoot first, with exact form factors that are
    /// not stored
    Progressive,
}

impl Arguments {
    /// Solve the scene.
    pub fn run(&self, monitor: &Monitor) -> anyhow::Result<ClassicReport> {
        if let Some(threads) = self.threads {
            rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global()?;
        }
        let method = match (self.solver, self.rays) {
            (Solver::Matrix, None) => ClassicMethod::Exact,
            (Solver::Matrix, Some(rays)) => ClassicMethod::Rays(rays),
            (Solver::Progressive, _) => ClassicMethod::Progressive(self.unshot),
        };
        let job = ClassicJob {
            scene: self.scene.clone(),
            element_size: self.element_size,
            method,
            light_units: self.light_units,
            sky: self.sky.clone(),
            out: self.out.clone(),
            points: self.points.clone(),
        };
        Ok(run(&job, monitor)?)
    }
}

impl ClassicReport {
    /// The report as text.
    pub fn text(&self) -> String {
        let seconds = &self.seconds;
        let shots = self.shots.map(|shots| format!(", {shots} shots")).unwrap_or_default();
        let mut text = format!(
            "{}: {} elements, classic radiosity: light in {:.2} s (form factors {:.2} s summed over threads{shots}), matrix of {} bytes\n",
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
