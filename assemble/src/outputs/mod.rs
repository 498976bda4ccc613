//! Writes the outputs of a run to `out/<scene>/`: pictures, the result as glTF, lightmaps and tables.

pub mod elements_csv;
pub mod model;
pub mod requests;
pub mod scene_light;

use crate::gather::points::{self, Place};
use crate::lightmap::atlas::Atlas;
use crate::lightmap::light::TexelLight;
use crate::lightmap::{self, Lightmap, by_rays};
use crate::output_file::WrittenFiles;
use crate::outputs::scene_light::SceneLight;
use crate::picture::camera::View;
use crate::picture::canvas::Canvas;
use crate::picture::difference::ReferenceLight;
use crate::picture::exposure::Exposure;
use crate::picture::shot;
use crate::picture::{shade, strip, wireframe, write_png};
use crate::receivers::Receivers;
use crate::report::process::{cpu_seconds, cpu_since};
use crate::solve::Solved;
use crate::statistics::mean_over_area;
use crate::verify::Classic;
use equilux_bake::monitor::Monitor;
use equilux_bake::rays::RayIndex;
use equilux_formats::{Element, Error, Result, Rgb, Scene, Store, unless_stopped};
use glam::DVec3;
use rayon::prelude::*;
use requests::{OutputRequests, Pictures};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The file name of the lit model.
pub const RESULT: &str = "result.glb";

/// The first rounds and the result in one picture.
const STRIP: &str = "rounds.png";

/// The edges of the elements.
const WIREFRAME: &str = "wireframe.png";

/// The classic solution.
const CLASSIC: &str = "classic.png";

/// Number of rounds in the strip.
const FIRST_ROUNDS: usize = 3;

/// The results of a run, to be written as outputs.
#[derive(Debug)]
pub struct RunResults<'a> {
    /// The solved scene.
    pub solved: &'a Solved,
    /// The cache.
    pub store: &'a Store,
    /// The classic solution, if requested.
    pub classic: Option<&'a Classic>,
    /// The layout of the lightmap, if requested.
    pub atlas: Option<&'a Atlas>,
    /// The points at which to compute light, if requested.
    pub places: Option<&'a [Place]>,
    /// The reference light for a picture, if requested.
    pub against: Option<&'a ReferenceLight>,
}

/// The written outputs.
#[derive(Debug)]
pub struct OutputRecord {
    /// The paths, as text for the report.
    pub paths: Vec<String>,
    /// Notes for the report, one sentence each.
    pub notes: Vec<String>,
    /// Wall time for the light at points.
    pub point_time: Duration,
    /// Processor time for the light at points, seconds, where the operating system reports it.
    pub point_cpu: Option<f64>,
}

/// The file name of the light at points.
pub const POINTS: &str = "points.csv";

/// Check before any long computation that the outputs can be written. Leaves no files behind. Fails if they cannot be
/// written.
pub fn check_writable(requests: &OutputRequests, scene: &Scene) -> Result<()> {
    let folder = requests.folder.join(&scene.name);
    let there = folder.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    tempfile::tempfile_in(there).map_err(|error| unusable(&folder, &error))?;
    let Some(table) = &requests.elements else { return Ok(()) };
    let beside = table.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    tempfile::tempfile_in(beside).map(drop).map_err(|error| {
        let remedy = "make the folder or choose another with --elements FILE.csv";
        Error::new(
            table,
            format!("cannot be written ({error})"),
            "a place in a folder that can be written to",
            remedy,
        )
    })
}

/// The error for an output folder that cannot be used.
pub fn unusable(folder: &Path, error: &std::io::Error) -> Error {
    Error::new(
        folder,
        format!("cannot be used for the outputs ({error})"),
        "a folder that can be written to",
        "choose another with --out DIR",
    )
}

/// Write all requested outputs. Fails if a file cannot be written.
pub fn write_all(
    requests: &OutputRequests,
    scene: &Scene,
    results: &RunResults,
    monitor: &Monitor,
) -> Result<OutputRecord> {
    let folder = requests.folder.join(&scene.name);
    prepare_folder(&folder)?;
    let elements = results.solved.elements();
    let mut lines = Vec::new();
    let exposure = if requests.pictures == Pictures::None {
        Exposure::choose(
            || 0..elements.len(),
            results.solved.radiosity(),
            &results.solved.equation.optics.emission,
        )
    } else {
        let index = RayIndex::new(elements);
        let canvas = Canvas::trace(View::of_scene(&scene.cameras, elements, &index), &index);
        let exposure = Exposure::choose(
            || canvas.elements(),
            results.solved.radiosity(),
            &results.solved.equation.optics.emission,
        );
        lines.extend(draw_all(requests, &folder, results, &canvas, exposure, monitor)?);
        exposure
    };
    let mut written = write_tables(requests, &folder, scene.origin, results, exposure)?;
    let lightmaps = write_lightmaps(requests, &folder, scene, results, exposure, monitor)?;
    let (start, cpu) = (Instant::now(), cpu_seconds());
    let points = write_points(&folder, scene, results, monitor)?;
    let (point_time, point_cpu) = (start.elapsed(), cpu_since(cpu));
    let mut notes = Vec::new();
    if let Some(shot) = &requests.shot {
        let drawn = shot::draw(shot, results.against, scene, results.solved, &folder)?;
        written.extend(drawn.paths);
        notes.extend(drawn.notes);
    }
    for saved in [lightmaps, points].into_iter().flatten() {
        written.extend(saved.paths);
        notes.extend(saved.notes);
    }
    lines.extend(written.iter().map(|path| path.display().to_string()));
    Ok(OutputRecord { paths: lines, notes, point_time, point_cpu })
}

fn write_points(
    folder: &Path,
    scene: &Scene,
    results: &RunResults,
    monitor: &Monitor,
) -> Result<Option<WrittenFiles>> {
    let Some(places) = results.places else { return Ok(None) };
    let gather = results.solved.gather();
    let elements = results.solved.elements();
    let receivers = Receivers::new(scene, results.solved, results.store, by_rays::RAYS, monitor);
    let irradiance = |points: &[Element]| match &receivers {
        Some(receivers) => {
            let reflected = receivers.reflected_at(points);
            gather.sharp(points).into_iter().zip(reflected).map(|(a, b)| a + b).collect()
        }
        None => gather.irradiance(points),
    };
    let Some(lights) = unless_stopped(points::light(irradiance, elements, places, monitor))? else {
        let note = format!("stopped: {POINTS} was not written; the file of an earlier run is unchanged");
        return Ok(Some(WrittenFiles { paths: vec![], notes: vec![note] }));
    };
    let path = folder.join(POINTS);
    points::write(&path, places, scene.origin, &lights, &results.solved.irradiance)?;
    let lost = lights.iter().filter(|light| light.is_none()).count();
    let notes = match lost {
        0 => vec![],
        1 => vec!["1 point lies on no surface that faces its normal; its line has no light".into()],
        _ => vec![format!(
            "{lost} points lie on no surface that faces their normals; their lines have no light"
        )],
    };
    Ok(Some(WrittenFiles { paths: vec![path], notes }))
}

fn write_lightmaps(
    requests: &OutputRequests,
    folder: &Path,
    scene: &Scene,
    results: &RunResults,
    exposure: Exposure,
    monitor: &Monitor,
) -> Result<Option<WrittenFiles>> {
    let (Some(options), Some(atlas)) = (&requests.lightmaps, results.atlas) else { return Ok(None) };
    let gather = results.solved.gather();
    let mean = mean_over_area(results.solved.elements(), &results.solved.irradiance);
    let texel_light = TexelLight::new(&gather, mean);
    let mut lightmap = match Receivers::new(scene, results.solved, results.store, by_rays::RAYS, monitor) {
        Some(receivers) => by_rays::irradiance(&receivers, atlas)
            .and_then(|values| Lightmap::of_values(scene, atlas, values, monitor)),
        None => Lightmap::new(scene, atlas, |texels| texel_light.irradiance(texels), monitor),
    };
    if options.directions {
        let directions = |texels: &_| texel_light.directions(texels);
        lightmap = lightmap.and_then(|lightmap| lightmap.with_directions(directions, monitor));
    }
    let Some(lightmap) = unless_stopped(lightmap)? else {
        let note = "stopped: no lightmaps were written; files of an earlier run are unchanged";
        return Ok(Some(WrittenFiles { paths: vec![], notes: vec![note.into()] }));
    };
    lightmap::write(folder, &lightmap, options.units, exposure).map(Some)
}

/// Draw the requested pictures. Returns the written paths as text.
fn draw_all(
    requests: &OutputRequests,
    folder: &Path,
    results: &RunResults,
    canvas: &Canvas,
    exposure: Exposure,
    monitor: &Monitor,
) -> Result<Vec<String>> {
    let draw = |name: &str, radiosity: &[Rgb]| {
        let path = folder.join(name);
        write_png(&path, &shade(canvas, radiosity, exposure)).map(|()| path)
    };
    let rounds =
        if requests.pictures == Pictures::Rounds { results.solved.outcome.rounds.as_slice() } else { &[] };
    let shown: Vec<(usize, &[Rgb])> =
        rounds.iter().filter_map(|round| Some((round.number, round.radiosity.as_deref()?))).collect();
    monitor.begin("pictures", shown.len(), 0.0);
    shown.par_iter().try_for_each(|(number, radiosity)| {
        draw(&picture_of(*number), radiosity)?;
        monitor.advance(1);
        Ok(())
    })?;
    let mut written: Vec<PathBuf> = vec![draw("final.png", results.solved.radiosity())?];
    if let Some(classic) = results.classic {
        written.push(draw(CLASSIC, &classic.radiosity)?);
    }
    if requests.pictures == Pictures::Rounds {
        let edges = folder.join(WIREFRAME);
        write_png(&edges, &wireframe(canvas, results.solved.elements()))?;
        written.push(edges);
        let first = shown.iter().take(FIRST_ROUNDS).map(|(_, radiosity)| *radiosity);
        let all = first.chain([results.solved.outcome.radiosity.as_slice()]);
        let rounds = folder.join(STRIP);
        write_png(&rounds, &strip(&all.map(|b| shade(canvas, b, exposure)).collect::<Vec<_>>()))?;
        written.push(rounds);
    }
    let mut lines: Vec<String> = written.iter().map(|path| path.display().to_string()).collect();
    if let Some((last, _)) = shown.last() {
        let first = folder.join(picture_of(1));
        lines.insert(0, format!("{} to {} ({} pictures)", first.display(), picture_of(*last), shown.len()));
    }
    Ok(lines)
}

fn picture_of(round: usize) -> String {
    format!("round-{round:03}.png")
}

fn write_tables(
    requests: &OutputRequests,
    folder: &Path,
    origin: DVec3,
    results: &RunResults,
    exposure: Exposure,
) -> Result<Vec<PathBuf>> {
    let placed = &results.solved.equation.placed;
    let part_names: Vec<String> =
        (0..placed.instances.len()).map(|k| placed.part_of(k).part.name.clone()).collect();
    let instance_names: Vec<String> = placed.instances.iter().map(|i| i.name.clone()).collect();
    let scene_light = SceneLight {
        world: &placed.world,
        origin,
        reflectance: &results.solved.equation.optics.reflectance,
        emission: &results.solved.equation.optics.emission,
        irradiance: &results.solved.irradiance,
        radiosity: results.solved.radiosity(),
        part_names: &part_names,
        instance_names: &instance_names,
    };
    let result = folder.join(RESULT);
    model::write(&result, &scene_light, exposure)?;
    let mut written = vec![result];
    if let Some(path) = &requests.elements {
        elements_csv::write(path, &scene_light)?;
        written.push(path.clone());
    }
    Ok(written)
}

/// Create the folder, and remove pictures of an earlier run that this run may not overwrite.
fn prepare_folder(folder: &Path) -> Result<()> {
    let failed = |error: std::io::Error| unusable(folder, &error);
    std::fs::create_dir_all(folder).map_err(failed)?;
    for entry in std::fs::read_dir(folder).map_err(failed)?.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let number = name.strip_prefix("round-").and_then(|rest| rest.strip_suffix(".png"));
        let is_round =
            number.is_some_and(|number| number.len() >= 3 && number.bytes().all(|b| b.is_ascii_digit()));
        if is_round || [STRIP, WIREFRAME, CLASSIC].contains(&name.as_ref()) {
            std::fs::remove_file(entry.path()).map_err(failed)?;
        }
    }
    Ok(())
}
