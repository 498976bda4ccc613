//! A scene through the whole program: written as glTF, baked, coupled, exchanged, and its table of elements read again.

use crate::cases::Finding;
use crate::model::{Model, Node};
use crate::table::Table;
use crate::workshop::Workshop;
use equilux_assemble::exchange::settings::Goal;
use equilux_assemble::report::Report;
use equilux_assemble::run::run;
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::Division;
use equilux_formats::{Result, Rgb};
use glam::DVec3;

/// The largest number of rounds: no case may take minutes.
const MOST_ROUNDS: usize = 3000;

/// The settings of a run.
#[derive(Debug, Clone)]
pub struct Setting {
    size: ElementSize,
    division: Division,
    error: f64,
    verify: bool,
}

impl Setting {
    /// Elements of at most `size` metres, authored parts, solved to rounding.
    pub fn metres(size: f64) -> Self {
        let size = ElementSize::Metres(size);
        Self { size, division: Division::Authored, error: 0.0, verify: false }
    }

    /// Each face of the mesh one element.
    pub fn mesh() -> Self {
        Self { size: ElementSize::Mesh, ..Self::metres(1.0) }
    }

    /// With this many cells instead of the authored parts; 1 keeps those.
    pub fn cut(self, cells: usize) -> Self {
        let division = if cells == 1 { Division::Authored } else { Division::Bisect(cells) };
        Self { division, ..self }
    }

    /// Solved until the error is proved to be below `error` of the brightest radiosity.
    pub fn to(self, error: f64) -> Self {
        Self { error, ..self }
    }

    /// With the classic whole-scene solution for comparison.
    pub fn verified(self) -> Self {
        Self { verify: true, ..self }
    }
}

/// An element and its light, W/m², linear RGB. Reflectance and emission are as rounded by the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lit {
    /// Its centroid, metres.
    pub centroid: DVec3,
    /// Its unit normal.
    pub normal: DVec3,
    /// Its area, m².
    pub area: f64,
    /// Reflectance ρ.
    pub reflectance: Rgb,
    /// Emission E.
    pub emission: Rgb,
    /// Radiosity B.
    pub radiosity: Rgb,
}

/// The solution.
#[derive(Debug)]
pub struct Solved {
    /// All elements, instance after instance.
    pub elements: Vec<Lit>,
    /// The report of the run.
    pub report: Report,
}

/// Solves a scene of these nodes.
pub fn solved(nodes: &[Node], setting: &Setting) -> Result<Solved> {
    solved_file(&Model::of(nodes), setting)
}

/// Solves a scene file.
pub fn solved_file(model: &Model, setting: &Setting) -> Result<Solved> {
    let workshop = Workshop::new();
    model.write(&workshop.path("scene.glb"));
    let table = workshop.path("table.csv");
    let mut job = workshop.job(setting.division.clone());
    job.settings.preparation.element_size = Some(setting.size);
    job.settings.goal = Goal { error: setting.error, rounds: MOST_ROUNDS };
    job.outputs.verify = setting.verify;
    job.outputs.elements = Some(table.clone());
    let report = run(&job, &Monitor::default())?;
    Ok(Solved { elements: lit(&Table::read(&table)), report })
}

/// The light of a scene that must have a solution.
pub fn light(nodes: &[Node], setting: &Setting) -> Solved {
    solved(nodes, setting).unwrap_or_else(|error| panic!("{error}"))
}

impl Solved {
    /// Rounds of exchange, if there was anything to exchange.
    pub fn rounds(&self) -> Option<usize> {
        (self.report.instances > 1).then_some(self.report.rounds.len())
    }

    /// The element furthest from what it should be in any channel, relative to that.
    pub fn worst(&self, expected: impl Fn(&Lit) -> Rgb) -> Finding {
        let pairs = self.elements.iter().flat_map(|lit| {
            let expected = expected(lit);
            (0..3).map(move |c| (expected[c], lit.radiosity[c]))
        });
        Finding::worst_relative(pairs).after(self.rounds())
    }

    /// How far the worst row is from summing to one.
    pub fn row_sums(&self) -> Finding {
        Finding::of(
            "rows sum to 1",
            format!("1 ± {:.1e}", self.report.row_sum_defect.max),
            self.report.row_sum_defect.max,
        )
    }
}

/// B = E / (1 − ρ): where everything reflects and emits the same and no light gets out.
pub fn uniform(lit: &Lit) -> Rgb {
    Rgb::from_fn(|c| lit.emission[c] / (1.0 - lit.reflectance[c]))
}

fn lit(table: &Table) -> Vec<Lit> {
    let [centroids, normals] = [["x", "y", "z"], ["nx", "ny", "nz"]].map(|names| table.vectors(names));
    let rgb =
        |row: usize, name: &str| Rgb(["r", "g", "b"].map(|c| table.number(row, &format!("{name}_{c}"))));
    (0..table.rows())
        .map(|row| Lit {
            centroid: centroids[row],
            normal: normals[row],
            area: table.number(row, "area"),
            reflectance: rgb(row, "rho"),
            emission: rgb(row, "E"),
            radiosity: rgb(row, "B"),
        })
        .collect()
}
