//! Everything a run leaves in `out/<scene>/`: pictures of rounds, of the end, of the elements, and the result as glTF.

use crate::account::mean_over_area;
use crate::camera::View;
use crate::canvas::Canvas;
use crate::classic::Classic;
use crate::equation::Equation;
use crate::exchange::Outcome;
use crate::exposure::Exposure;
use crate::lightmap::atlas::Atlas;
use crate::lightmap::light::TexelLight;
use crate::lightmap::{self, Lightmap, Saved};
use crate::picture::{shade, strip, wireframe, write_png};
use crate::points::{self, Place};
use crate::render::{self, Reference};
use crate::run::{Job, Pictures};
use crate::scene_light::SceneLight;
use crate::{elements_csv, gltf_export};
use equilux_bake::monitor::Monitor;
use equilux_bake::rays::RayIndex;
use equilux_formats::{Error, Result, Rgb, Scene};
use glam::DVec3;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The file name of the lit model.
pub const RESULT: &str = "result.glb";

/// The first rounds and the end in one picture.
const STRIP: &str = "rounds.png";

/// So many rounds are in it.
const FIRST_ROUNDS: usize = 3;

/// What there is to show.
pub struct Light<'a> {
    /// What was solved.
    pub equation: &'a Equation,
    /// The exchange.
    pub outcome: &'a Outcome,
    /// The classic solution, if asked for.
    pub classic: Option<&'a Classic>,
    /// The plan of the lightmap, if asked for.
    pub atlas: Option<&'a Atlas>,
    /// The places of which to tell the light, if asked for.
    pub places: Option<&'a [Place]>,
    /// What to compare a picture with, if asked for.
    pub against: Option<&'a Reference>,
}

/// What was written.
pub struct Written {
    /// The paths, for a person.
    pub paths: Vec<String>,
    /// What a person should know of them.
    pub notes: Vec<String>,
    /// What the light of points took.
    pub point_time: Duration,
}

/// The file name of the light of points.
pub const POINTS: &str = "points.csv";

/// Fail where the outputs could not be written, before hours are spent on them. Leaves nothing behind.
pub fn check_writable(job: &Job, scene: &Scene) -> Result<()> {
    let folder = job.out.join(&scene.name);
    let there = folder.ancestors().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    tempfile::tempfile_in(there).map_err(|error| unusable(&folder, &error))?;
    let Some(table) = &job.elements else { return Ok(()) };
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

/// The error of a folder for outputs that cannot be used.
pub fn unusable(folder: &Path, error: &std::io::Error) -> Error {
    Error::new(
        folder,
        format!("cannot be used for the outputs ({error})"),
        "a folder that can be written to",
        "choose another with --out DIR",
    )
}

/// Write all outputs.
pub fn write_all(job: &Job, scene: &Scene, light: &Light, monitor: &Monitor) -> Result<Written> {
    let folder = job.out.join(&scene.name);
    prepare_folder(&folder)?;
    let elements = &light.equation.placed.world.elements;
    let mut lines = Vec::new();
    let exposure = if job.pictures == Pictures::None {
        Exposure::choose(|| 0..elements.len(), &light.outcome.radiosity, &light.equation.optics.emission)
    } else {
        let index = RayIndex::new(elements);
        let canvas = Canvas::trace(View::of_scene(&scene.cameras, elements, &index), &index);
        let exposure =
            Exposure::choose(|| canvas.elements(), &light.outcome.radiosity, &light.equation.optics.emission);
        lines.extend(draw_all(job, &folder, light, &canvas, exposure, monitor)?);
        exposure
    };
    let mut written = write_tables(job, &folder, scene.origin, light, exposure)?;
    let lightmaps = write_lightmaps(job, &folder, scene, light, exposure, monitor)?;
    let start = Instant::now();
    let points = write_points(&folder, scene.origin, light, monitor)?;
    let point_time = start.elapsed();
    let mut notes = Vec::new();
    if let Some(shot) = &job.shot {
        let lit = (light.equation, light.outcome);
        let drawn = render::draw(shot, light.against, scene, lit, &folder)?;
        written.extend(drawn.paths);
        notes.extend(drawn.notes);
    }
    for saved in [lightmaps, points].into_iter().flatten() {
        written.extend(saved.paths);
        notes.extend(saved.notes);
    }
    lines.extend(written.iter().map(|path| path.display().to_string()));
    Ok(Written { paths: lines, notes, point_time })
}

fn write_points(folder: &Path, origin: DVec3, light: &Light, monitor: &Monitor) -> Result<Option<Saved>> {
    let Some(places) = light.places else { return Ok(None) };
    let gather = light.equation.gather(&light.outcome.radiosity);
    let elements = &light.equation.placed.world.elements;
    let Some(lights) = points::light(&gather, elements, places, monitor) else {
        let note = format!("stopped: {POINTS} was not written; that of an earlier run is as it was");
        return Ok(Some(Saved { paths: vec![], notes: vec![note] }));
    };
    let path = folder.join(POINTS);
    points::write(&path, places, origin, &lights, &light.outcome.irradiance)?;
    let lost = lights.iter().filter(|light| light.is_none()).count();
    let notes = match lost {
        0 => vec![],
        1 => vec!["1 point lies on no surface that looks its way; its line has no light".into()],
        _ => vec![format!("{lost} points lie on no surface that looks their way; their lines have no light")],
    };
    Ok(Some(Saved { paths: vec![path], notes }))
}

fn write_lightmaps(
    job: &Job,
    folder: &Path,
    scene: &Scene,
    light: &Light,
    exposure: Exposure,
    monitor: &Monitor,
) -> Result<Option<Saved>> {
    let (Some(wanted), Some(atlas)) = (&job.lightmaps, light.atlas) else { return Ok(None) };
    let gather = light.equation.gather(&light.outcome.radiosity);
    let mean = mean_over_area(&light.equation.placed, &light.outcome.irradiance);
    let texel_light = TexelLight::new(&gather, mean);
    let mut lightmap = Lightmap::new(scene, atlas, |texels| texel_light.irradiance(texels), monitor);
    if wanted.directions {
        let directions = |texels: &_| texel_light.directions(texels);
        lightmap = lightmap.and_then(|lightmap| lightmap.with_directions(directions, monitor));
    }
    let Some(lightmap) = lightmap else {
        let note = "stopped: no lightmaps were written; those of an earlier run are as they were";
        return Ok(Some(Saved { paths: vec![], notes: vec![note.into()] }));
    };
    lightmap::write(folder, &lightmap, wanted.units, exposure).map(Some)
}

/// Draw the pictures that are wanted; returns the paths written, for a person.
fn draw_all(
    job: &Job,
    folder: &Path,
    light: &Light,
    canvas: &Canvas,
    exposure: Exposure,
    monitor: &Monitor,
) -> Result<Vec<String>> {
    let draw = |name: &str, radiosity: &[Rgb]| {
        let path = folder.join(name);
        write_png(&path, &shade(canvas, radiosity, exposure)).map(|()| path)
    };
    let rounds = if job.pictures == Pictures::Rounds { light.outcome.rounds.as_slice() } else { &[] };
    let shown: Vec<(usize, &[Rgb])> =
        rounds.iter().filter_map(|round| Some((round.number, round.radiosity.as_deref()?))).collect();
    monitor.begin("pictures", shown.len());
    shown.par_iter().try_for_each(|(number, radiosity)| {
        draw(&picture_of(*number), radiosity)?;
        monitor.advance(1);
        Ok(())
    })?;
    let mut written: Vec<PathBuf> = vec![draw("final.png", &light.outcome.radiosity)?];
    if let Some(classic) = light.classic {
        written.push(draw("classic.png", &classic.radiosity)?);
    }
    if job.pictures == Pictures::Rounds {
        let edges = folder.join("wireframe.png");
        write_png(&edges, &wireframe(canvas, &light.equation.placed.world.elements))?;
        written.push(edges);
        let first = shown.iter().take(FIRST_ROUNDS).map(|(_, radiosity)| *radiosity);
        let all = first.chain([light.outcome.radiosity.as_slice()]);
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
    job: &Job,
    folder: &Path,
    origin: DVec3,
    light: &Light,
    exposure: Exposure,
) -> Result<Vec<PathBuf>> {
    let placed = &light.equation.placed;
    let part_names: Vec<String> =
        (0..placed.instances.len()).map(|k| placed.part_of(k).part.name.clone()).collect();
    let instance_names: Vec<String> = placed.instances.iter().map(|i| i.name.clone()).collect();
    let scene_light = SceneLight {
        world: &placed.world,
        origin,
        reflectance: &light.equation.optics.reflectance,
        emission: &light.equation.optics.emission,
        irradiance: &light.outcome.irradiance,
        radiosity: &light.outcome.radiosity,
        part_names: &part_names,
        instance_names: &instance_names,
    };
    let result = folder.join(RESULT);
    gltf_export::write(&result, &scene_light, exposure)?;
    let mut written = vec![result];
    if let Some(path) = &job.elements {
        elements_csv::write(path, &scene_light)?;
        written.push(path.clone());
    }
    Ok(written)
}

/// Make the folder, and take away the rounds of an earlier run, which may have had more of them.
fn prepare_folder(folder: &Path) -> Result<()> {
    let failed = |error: std::io::Error| unusable(folder, &error);
    std::fs::create_dir_all(folder).map_err(failed)?;
    for entry in std::fs::read_dir(folder).map_err(failed)?.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let number = name.strip_prefix("round-").and_then(|rest| rest.strip_suffix(".png"));
        let is_round =
            number.is_some_and(|number| number.len() >= 3 && number.bytes().all(|b| b.is_ascii_digit()));
        if is_round || name == STRIP {
            std::fs::remove_file(entry.path()).map_err(failed)?;
        }
    }
    Ok(())
}
