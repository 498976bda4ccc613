//! The command line of `assemble`.

use crate::advice::advise;
use crate::baseline;
use crate::exchange::{Goal, Method};
use crate::gather::outside::LightUnits;
use crate::gather::sky::Sky;
use crate::lightmap::{Units, Wanted};
use crate::plan::{Plan, plan};
use crate::proof::sample::ExactRows;
use crate::render::{Eye, Shading, Shot};
use crate::report::Report;
use crate::run::{Job, Pictures, run};
use crate::sweep;
use crate::watch::watch;
use clap::{Args, Parser, Subcommand, ValueEnum};
use equilux_bake::cli::{options::SceneOptions, progress};
use equilux_bake::monitor::Monitor;
use glam::DVec3;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

/// Assemble a scene from baked parts, let them exchange light until equilibrium, and write pictures and a report.
#[derive(Parser)]
#[command(name = "assemble", version, after_help = EXAMPLES)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Task>,
    #[command(flatten)]
    assembly: Assembly,
    /// Say in a sentence for every part and block whether it was computed, reused or left out, and why
    #[arg(long)]
    explain: bool,
    /// Choose element size and tolerance so that light at points of surfaces, as --lightmaps and --points have it, is off by no
    /// more than this, as a root mean square over the mean: solves with finer and finer elements until it stays
    #[arg(long, value_name = "ERROR", value_parser = target_error, conflicts_with_all = ["element_size", "tolerance"])]
    target_error: Option<f64>,
    /// Assemble again whenever a file of the scene changes, until Ctrl-C; a line or two a run
    #[arg(long)]
    watch: bool,
}

/// What to do other than assemble.
#[derive(Subcommand)]
enum Task {
    /// Say what the same command without `plan` would compute, reuse and leave out, and why
    Plan(Assembly),
    /// Draw the result from a camera: render.png, and how far it is from a reference: error.png
    Render(Render),
    /// Try settings for a while and report error against run time
    Sweep(sweep::cli::Arguments),
    /// Solve the scene with one matrix of all pairs of elements, or by progressive refinement: what to compare with
    Classic(baseline::cli::Arguments),
}

/// A scene, and how to assemble it.
#[derive(Args)]
struct Assembly {
    /// The scene, a .gltf or .glb file
    #[arg(required = true)]
    scene: Option<PathBuf>,
    #[command(flatten)]
    options: SceneOptions,
    /// Folder for the outputs; they go to DIR/<scene>/: pictures of the first eight rounds, of rounds
    /// 16, 32, 64 and so on, and of the last; the result as a picture and as a model
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
    #[arg(long, value_name = "BOUND", value_parser = error_bound)]
    error: Option<f64>,
    /// Measure what --tolerance costs in about this many exact rows, or in all, which proves a sharp
    /// bound; 0 measures nothing
    #[arg(long, value_name = "N|all", default_value = "256", value_parser = exact_rows)]
    exact_rows: ExactRows,
    /// Start from the light of the last run with --warm instead of darkness, and keep this run's: fewer
    /// rounds after a small change. The bytes of the outputs then depend on what ran before
    #[arg(long)]
    warm: bool,
    /// Which pictures to draw; the result as a model is always written
    #[arg(long, value_name = "WHICH", default_value = "rounds")]
    pictures: Drawn,
    /// What shines from all around: a radiance in W/(m² sr), one number or R,G,B, or an equirectangular picture,
    /// .hdr or .exr, whose middle is -Z and top +Y
    #[arg(long, value_name = "RADIANCE|FILE", value_parser = sky)]
    sky: Option<Sky>,
    /// What the intensities of the file's lights mean
    #[arg(long, value_name = "UNITS", default_value = "radiometric")]
    light_units: Intensities,
    /// Write lightmaps: lightmap.exr and .png, what lies where in them, and models that carry them
    #[arg(long)]
    lightmaps: bool,
    /// Texels of lightmaps are at most so large [default: what makes about 1024 x 1024 of them]
    #[arg(long, value_name = "METRES", requires = "lightmaps", value_parser = texel_size)]
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

/// A picture.
#[derive(Args)]
struct Render {
    #[command(flatten)]
    assembly: Assembly,
    /// The scene's camera of this name, or of this number from 1 [default: the first, or one that shows everything]
    #[arg(long, value_name = "NAME|N")]
    camera: Option<String>,
    /// Look from this point, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "to", conflicts_with = "camera")]
    from: Option<DVec3>,
    /// Look at this point, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "from")]
    to: Option<DVec3>,
    /// Vertical field of view of --from, degrees
    #[arg(long, value_name = "DEGREES", default_value = "45", value_parser = field_of_view)]
    fov: f64,
    /// Width and height, pixels [default: 720 high, and as wide as the camera says]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// How light is drawn
    #[arg(long, value_name = "HOW", default_value = "smooth")]
    shading: Shaded,
    /// So many stops brighter than what suits the scene, or darker
    #[arg(long, value_name = "STOPS", default_value = "0", value_parser = stops, allow_hyphen_values = true)]
    exposure: f64,
    /// Also show in false colours how far irradiance is from that of this table: truth.csv of a scene, or what --elements or
    /// --points wrote
    #[arg(long, value_name = "FILE.csv")]
    against: Option<PathBuf>,
}

/// The shading's name on the command line.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Shaded {
    /// Each element in one colour
    Flat,
    /// Interpolated between elements that see each other
    Smooth,
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
pub(crate) enum Intensities {
    /// W/sr and W/m², number for number what the file calls candela and lux
    Radiometric,
    /// Candela and lux of light of 683 lm/W: what Blender writes by default
    Photometric,
    /// Watts of whole lamps: what Blender writes with `Raw`
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

const EXAMPLES: &str = "\
Examples:
  assemble scenes/shadow/shadow.glb                    pictures of its rounds in out/shadow/
  assemble scenes/house/house.gltf --element-size 0.3  a level from part files
  assemble scenes/wood/wood.glb --bisect 8 --verify    parts by planes, compared with the whole
  assemble scenes/cornell/cornell.glb --target-error 1%  settings that are as exact as that
  assemble render scenes/house/house.gltf              a picture from its camera
  assemble plan scenes/house/house.gltf                what would be computed, and why
  assemble scenes/house/house.gltf --lightmaps         with lightmaps for game engines
  assemble sweep scenes/house/house.gltf               error against run time, in out/house/sweep/
  assemble scenes/house/house.gltf --watch             again whenever one of its files is saved
Ctrl-C ends the exchange after the current round; everything is still written. Later it ends lightmaps, and\nonly they are not. A second one ends the program at once.";

/// Run the program: 0 done, 1 something is wrong with an input or the environment, 2 the command line is.
pub fn main() -> ExitCode {
    let Arguments { command, assembly, explain, target_error, watch } = Arguments::parse();
    let wanted = |job: Job| Wish { job: Job { explain, ..job }, target_error };
    let outcome = match command {
        None if watch => watched(&assembly, &wanted(assembly.job())).map(|()| String::new()),
        Some(Task::Plan(assembly)) => plan(&assembly.job())
            .map_err(Into::into)
            .map(|plan| said(assembly.options.json, &plan, Plan::text)),
        Some(Task::Render(render)) => {
            let monitor = progress::monitor_for_program();
            let wish = Wish { job: render.job(), target_error: None };
            let report = render.assembly.options.set_threads().and_then(|()| assemble(&wish, &monitor));
            report.map(|report| said(render.assembly.options.json, &report, Report::outputs_text))
        }
        Some(Task::Sweep(arguments)) => shown(|monitor| arguments.run(monitor).map_err(Into::into))
            .map(|summary| said(arguments.json, &summary, |summary| arguments.text(summary))),
        Some(Task::Classic(arguments)) => shown(|monitor| arguments.run(monitor))
            .map(|report| said(arguments.json, &report, baseline::Report::text)),
        None => {
            let monitor = progress::monitor_for_program();
            let report =
                assembly.options.set_threads().and_then(|()| assemble(&wanted(assembly.job()), &monitor));
            report.map(|report| said(assembly.options.json, &report, Report::text))
        }
    };
    match outcome {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Do something with progress shown, until Ctrl-C.
fn shown<T>(work: impl FnOnce(&Monitor) -> anyhow::Result<T>) -> anyhow::Result<T> {
    let monitor = progress::monitor_for_program();
    let progress = progress::show(&monitor);
    let done = work(&monitor);
    progress.finish();
    done
}

/// A job, and the error that its settings are to be chosen for.
struct Wish {
    job: Job,
    target_error: Option<f64>,
}

fn assemble(wish: &Wish, monitor: &Arc<Monitor>) -> anyhow::Result<Report> {
    let progress = progress::show(monitor);
    let report = advised(wish, monitor);
    progress.finish();
    Ok(report?)
}

fn advised(wish: &Wish, monitor: &Monitor) -> equilux_formats::Result<Report> {
    let Some(target) = wish.target_error else { return run(&wish.job, monitor) };
    let (job, advice) = advise(&wish.job, target, monitor)?;
    Ok(Report { advice: Some(advice), ..run(&job, monitor)? })
}

/// Assemble again and again. Errors in the scene are printed, and it goes on.
fn watched(assembly: &Assembly, wish: &Wish) -> anyhow::Result<()> {
    assembly.options.set_threads()?;
    let monitor = progress::monitor_for_program();
    let mut last_notes = Vec::new();
    watch(&wish.job.scene, &wish.job.beside().collect::<Vec<_>>(), &monitor, |why| {
        match assemble(wish, &monitor) {
            Ok(report) => {
                print!("{}", said(assembly.options.json, &report, |report| short(why, report, &last_notes)));
                last_notes = report.notes;
            }
            Err(error) => eprintln!("error: {error:#}"),
        }
    })?;
    Ok(())
}

/// The report in a line, with what is asked for or new.
fn short(why: &str, report: &Report, last_notes: &[String]) -> String {
    let baked = report.blocks.self_baked;
    let mut text = format!(
        "{why}: {baked} part{} baked, {} form factors computed, {} rounds, {:.2} s\n",
        if baked == 1 { "" } else { "s" },
        report.form_factors_computed,
        report.rounds.len(),
        report.seconds.total
    );
    let notes = report.notes.iter().filter(|note| !last_notes.contains(note));
    let lines = report.explained.iter().cloned().chain(notes.map(|note| format!("note: {note}")));
    lines.for_each(|line| text += &(line + "\n"));
    text
}

/// What goes to stdout: for machines if they asked, else for people.
fn said<T: Serialize>(json: bool, what: &T, text: impl Fn(&T) -> String) -> String {
    if json { serde_json::to_string(what).expect("a report is plain data") + "\n" } else { text(what) }
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

impl Render {
    fn job(&self) -> Job {
        let eye = match (&self.camera, self.from, self.to) {
            (Some(name), ..) => Eye::Camera(name.clone()),
            (None, Some(from), Some(to)) => Eye::Points { from, to, field_of_view: self.fov.to_radians() },
            _ => Eye::Scene,
        };
        let shading = match self.shading {
            Shaded::Flat => Shading::Flat,
            Shaded::Smooth => Shading::Smooth,
        };
        let (size, stops, against) = (self.size, self.exposure, self.against.clone());
        let shot = Some(Shot { eye, size, shading, stops, against });
        Job { shot, pictures: Pictures::None, ..self.assembly.job() }
    }
}

impl Assembly {
    fn job(&self) -> Job {
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
            light_units: self.light_units.into(),
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

fn exact_rows(text: &str) -> Result<ExactRows, String> {
    match text.parse() {
        _ if text == "all" => Ok(ExactRows::All),
        Ok(rows) => Ok(ExactRows::About(rows)),
        Err(_) => Err("exact rows are a whole number of them, or `all`".into()),
    }
}

pub(crate) fn sky(text: &str) -> Result<Sky, String> {
    let numbers: Vec<Option<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers[..] {
        [Some(all)] if all >= 0.0 && all.is_finite() => Ok(Sky::Uniform([all; 3])),
        [Some(r), Some(g), Some(b)] if [r, g, b].iter().all(|l| *l >= 0.0 && l.is_finite()) => {
            Ok(Sky::Uniform([r, g, b]))
        }
        [None] => Ok(Sky::Picture(text.into())),
        _ => Err("a sky is one number or three with commas between them, 0 or more, or a picture".into()),
    }
}

/// `1%` or `0.01`.
fn target_error(text: &str) -> Result<f64, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |percent| (percent.trim(), 0.01));
    match number.parse::<f64>().map(|number| number * unit) {
        Ok(error) if error > 0.0 && error < 1.0 => Ok(error),
        _ => Err("an error is a share of the mean light between 0 and 1, such as 1% or 0.01".into()),
    }
}

fn point(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|v| v.is_finite()) => Ok(DVec3::new(x, y, z)),
        _ => Err("a point is three numbers with commas between them, metres, such as 1,1.6,-2".into()),
    }
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').map(|(width, height)| [width.parse().ok(), height.parse().ok()]);
    match sides {
        Some([Some(width), Some(height)]) if [width, height].iter().all(|side| (1..=8192).contains(side)) => {
            Ok([width, height])
        }
        _ => Err("a size is two numbers of pixels from 1 to 8192, such as 1280x720".into()),
    }
}

fn field_of_view(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("a field of view is an angle between 0 and 180 degrees".into()),
    }
}

fn stops(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(stops) if stops.abs() <= 100.0 => Ok(stops),
        _ => Err("an exposure is a number of stops, such as 1 for twice as bright".into()),
    }
}

fn texel_size(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(size) if size.is_finite() && size > 0.0 => Ok(size),
        _ => Err("a texel size is a length above zero, metres".into()),
    }
}

fn error_bound(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(error) if error >= 0.0 => Ok(error),
        _ => Err("an error bound is a number, zero or more".into()),
    }
}
