//! Classic radiosity, for comparison: one dense matrix of the whole scene, exact or with sampled visibility, or
//! progressive refinement, which stores no matrix. Uses no parts, clusters or cache. The light is written by the same
//! code as that of the exchange.

mod dense;
mod progressive;
pub mod rays;

use crate::equation::coupling::Coupler;
use crate::equation::direct::{direct, driven, with_direct};
use crate::equation::optics::{joined, whole_optics};
use crate::gather::Gather;
use crate::gather::outside::lights;
use crate::gather::points::{self, Place, PointLight};
use crate::gather::sky::Sky;
use crate::outputs::{POINTS, unusable};
use crate::placed_parts::PlacedParts;
use crate::report::light_notes::light_notes;
use crate::report::process::{cpu_seconds, cpu_since, peak_rss};
use dense::Dense;
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::cached::Origin;
use equilux_bake::oven::prepare::{Division, Preparation, Prepared, PreparedPart, RowMethod, prepare};
use equilux_bake::oven::{Baked, Oven, geometry_manifest};
use equilux_bake::treecode::EXACT;
use equilux_formats::baked::{BoundaryResponses, Escapes, LocalEquilibrium};
use equilux_formats::{BakedPart, Error, LightUnits, Optics, Result, Rgb, Rows, Store};
use glam::DVec3;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// The method of solution.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClassicMethod {
    /// The exact matrix.
    Exact,
    /// The matrix with this many rays for each pair.
    Rays(u32),
    /// Progressive refinement until this share of the emitted power is unshot.
    Progressive(f64),
}

/// The description of a classic solution.
#[derive(Debug, Clone)]
pub struct ClassicJob {
    /// The scene's file.
    pub scene: PathBuf,
    /// Size of elements; none for a size that suits the scene.
    pub element_size: Option<ElementSize>,
    /// The method.
    pub method: ClassicMethod,
    /// The units of the intensities of the file's lights; none for the units that each file suggests.
    pub light_units: Option<LightUnits>,
    /// The sky, if there is one.
    pub sky: Option<Sky>,
    /// The folder in which `<scene>/` is created.
    pub out: PathBuf,
    /// A table of points at which to gather light.
    pub points: Option<PathBuf>,
}

/// The report; its fields are named as in the report of `assemble`.
#[derive(Debug, Clone, Serialize)]
pub struct ClassicReport {
    /// The scene's name.
    pub scene: String,
    /// Number of elements.
    pub elements: usize,
    /// Time spent.
    pub seconds: ClassicSeconds,
    /// Memory.
    pub bytes: ClassicBytes,
    /// Number of shots of progressive refinement.
    pub shots: Option<usize>,
    /// Notes on the scene's light.
    pub notes: Vec<String>,
    /// The paths of the written files.
    pub outputs: Vec<String>,
}

/// Time spent, seconds.
#[derive(Debug, Clone, Serialize)]
pub struct ClassicSeconds {
    /// Form factors, summed over threads.
    pub form_factors: f64,
    /// Wall time from the file to the light of all elements.
    pub solve: f64,
    /// Processor time for the same work, where the operating system reports it.
    pub solve_cpu: Option<f64>,
    /// Wall time to gather light at points.
    pub points: f64,
    /// Processor time to gather light at points, where the operating system reports it.
    pub points_cpu: Option<f64>,
    /// Wall time of the run.
    pub total: f64,
}

/// Memory.
#[derive(Debug, Clone, Serialize)]
pub struct ClassicBytes {
    /// The matrix, bytes.
    pub stored: usize,
    /// Peak memory of the process until the solution was available, bytes.
    pub peak_rss: Option<usize>,
}

/// The light of all elements, and its cost.
struct ClassicSolution {
    /// Radiosity, W/m².
    radiosity: Vec<Rgb>,
    /// Irradiance from elements, W/m².
    irradiance: Vec<Rgb>,
    form_factor_time: Duration,
    matrix_bytes: usize,
    shots: Option<usize>,
}

/// Run the job. All outputs are written when this returns. Fails if the scene cannot be read or solved, or an output
/// cannot be written.
pub fn run(job: &ClassicJob, monitor: &Monitor) -> Result<ClassicReport> {
    let start = Instant::now();
    let scene = import_scene(&job.scene)?;
    let places = job.points.as_deref().map(|file| points::read(file, scene.origin)).transpose()?;
    let preparation = Preparation {
        element_size: job.element_size,
        division: Division::Authored,
        resolution: EXACT,
        rows: RowMethod::Exact,
        ..Preparation::default()
    };
    let placed = unbaked(prepare(&scene, &preparation)?);
    let sky = job.sky.as_ref().map(Sky::read).transpose()?;
    let lights = lights(&scene.lights, job.light_units, sky.as_ref(), &placed.world);
    let temporary_cache = tempfile::tempdir().map_err(|error| {
        let found = format!("cannot be used ({error})");
        Error::new(std::env::temp_dir(), found, "a folder for temporary files", "set TMPDIR to one")
    })?;
    let store = Store::open(temporary_cache.path())?;
    let oven = Oven { store: &store, file: &job.scene, resolution: EXACT, monitor };
    let coupler = Coupler::new(&oven, &placed);
    let direct = direct(&coupler, &lights)?;
    let each: Vec<Optics> = (0..placed.instances.len())
        .map(|k| driven(&placed.optics_of(k), &direct.irradiance[k], &direct.apart[k]))
        .collect();
    let mut solved = solve(job, &placed, &joined(&each), monitor)?;
    with_direct(&mut solved.irradiance, &direct.irradiance);
    let (solve, solve_cpu, peak) = (start.elapsed().as_secs_f64(), cpu_seconds(), peak_rss());

    let gathering = Instant::now();
    let emission = whole_optics(&placed).emission;
    let gather = Gather::new(&placed, &emission, &solved.radiosity, &lights, EXACT);
    let outputs = match &places {
        Some(places) => {
            let lights =
                points::light(|points| gather.irradiance(points), &placed.world.elements, places, monitor)?;
            vec![write_points(&job.out.join(&scene.name), places, scene.origin, &lights, &solved.irradiance)?]
        }
        None => vec![],
    };
    Ok(ClassicReport {
        notes: light_notes(&scene, job.light_units, job.sky.as_ref()),
        scene: scene.name,
        elements: placed.world.elements.len(),
        seconds: ClassicSeconds {
            form_factors: solved.form_factor_time.as_secs_f64(),
            solve,
            solve_cpu,
            points: gathering.elapsed().as_secs_f64(),
            points_cpu: cpu_since(solve_cpu),
            total: start.elapsed().as_secs_f64(),
        },
        bytes: ClassicBytes { stored: solved.matrix_bytes, peak_rss: peak },
        shots: solved.shots,
        outputs,
    })
}

/// The light of all elements. Fails if the monitor was stopped or there is no solution.
fn solve(
    job: &ClassicJob,
    placed: &PlacedParts,
    optics: &Optics,
    monitor: &Monitor,
) -> Result<ClassicSolution> {
    let matrix = match job.method {
        ClassicMethod::Exact => Dense::exact(&placed.world, monitor),
        ClassicMethod::Rays(count) => Dense::by_rays(&placed.world.elements, count as usize, monitor),
        ClassicMethod::Progressive(unshot) => {
            return progressive::solve(&placed.world, optics, unshot, monitor);
        }
    }?;
    if matrix.is_endless(optics) {
        let found = "no equilibrium exists: the scene is closed, reflects all light and emits, so its light grows without end";
        let remedy = "lower a base colour below 1, or switch the emission off";
        return Err(Error::new(&job.scene, found, "a reflectance below 1 or an opening somewhere", remedy));
    }
    let radiosity = matrix.solve(optics);
    let irradiance = matrix.irradiance(&radiosity);
    let (form_factor_time, matrix_bytes) = (matrix.time, matrix.bytes());
    Ok(ClassicSolution { irradiance, radiosity, form_factor_time, matrix_bytes, shots: None })
}

/// The placed parts, without form factors.
fn unbaked(prepared: Prepared) -> PlacedParts {
    let parts = prepared.parts.into_iter().map(without_light).collect();
    PlacedParts::new(parts, prepared.instances)
}

fn without_light(part: PreparedPart) -> Baked {
    let key = geometry_manifest(&part, EXACT).key();
    let nothing = || Origin::Computed("not at all".into());
    let receivers = part.geometry.elements.len();
    let local = LocalEquilibrium {
        solver: part.solver,
        radiosity: part.optics.emission.clone(),
        factors: None,
        answers: BoundaryResponses::default(),
    };
    Baked {
        surfaces: OnceLock::new(),
        part: BakedPart {
            self_block: Rows::from_rows(part.geometry.clusters.nodes(), vec![vec![]; receivers]),
            escapes: Escapes::default(),
            name: part.name,
            geometry: part.geometry,
            optics: part.optics,
            tints: part.tints,
            materials: part.materials,
            local,
        },
        key,
        form_factors: nothing(),
        light: nothing(),
        form_factor_time: Duration::ZERO,
        light_time: Duration::ZERO,
    }
}

/// Write the light at points; returns the path as text.
fn write_points(
    folder: &Path,
    places: &[Place],
    origin: DVec3,
    lights: &[Option<PointLight>],
    irradiance: &[Rgb],
) -> Result<String> {
    std::fs::create_dir_all(folder).map_err(|error| unusable(folder, &error))?;
    let path = folder.join(POINTS);
    points::write(&path, places, origin, lights, irradiance)?;
    Ok(path.display().to_string())
}
