//! The folder of a sweep: its lock, the points at which light is compared, and the files of the results.

use super::page::page;
use super::points::surface_points;
use super::summary::Summary;
use super::table::{csv, points_csv};
use crate::output_file;
use equilux_bake::elements::{ElementSize, subdivide};
use equilux_bake::world::World;
use equilux_formats::fingerprint::Content;
use equilux_formats::{Error, Result, Scene};
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// The number of points at which light is compared without a table of truth.
const POINTS: usize = 1000;

/// Make the folder, and lock it for as long as the returned file lives. Fails if another sweep has locked it.
pub fn alone(folder: &Path) -> Result<File> {
    let unusable = |error: std::io::Error| {
        let found = format!("cannot be used for the outputs ({error})");
        Error::new(folder, found, "a folder that can be written to", "choose another with --out DIR")
    };
    fs::create_dir_all(folder.join("runs")).map_err(unusable)?;
    let lock = File::create(folder.join("lock")).map_err(unusable)?;
    lock.try_lock().map_err(|_| {
        let remedy = "wait for it, or choose another folder with --out DIR";
        Error::new(folder, "another sweep is running here", "one at a time", remedy)
    })?;
    // Left by runs whose sweep was killed.
    for entry in fs::read_dir(folder).map_err(unusable)?.flatten() {
        if entry.file_name().to_string_lossy().starts_with("running-") {
            fs::remove_dir_all(entry.path()).map_err(unusable)?;
        }
    }
    Ok(lock)
}

/// The path of this program, and the content of all that results depend on beside the arguments: the program, the points
/// and the files of the scene.
pub fn identity(scene: &Scene, points: &Path) -> Result<(PathBuf, Content)> {
    let unreadable = |path: &Path, error: std::io::Error| {
        Error::new(path, format!("cannot be read ({error})"), "a readable file", "put it back and try again")
    };
    let program = std::env::current_exe().map_err(|error| unreadable(Path::new("assemble"), error))?;
    let files = [program.as_path(), points].into_iter().chain(scene.sources.iter().map(PathBuf::as_path));
    let mut content = Content::new();
    for file in files {
        content = content.bytes(fs::read(file).map_err(|error| unreadable(file, error))?);
    }
    Ok((program, content))
}

/// Write points on the surfaces of the scene as a table, and return its path.
pub fn own_points(scene: &Scene, folder: &Path) -> Result<PathBuf> {
    let geometries: Vec<_> = scene.parts.iter().map(|part| subdivide(part, ElementSize::Mesh)).collect();
    let world = World::new(scene.instances.iter().map(|i| (&geometries[i.part.index()], i.placement)));
    let path = folder.join("points.csv");
    let mut points = surface_points(&world.elements, POINTS);
    points.iter_mut().for_each(|place| place.point += scene.origin);
    let table = points_csv(&points);
    output_file::write(&path, |out| out.write_all(&table))?;
    Ok(path)
}

/// Write `sweep.csv`, `sweep.json` and `report.html`.
pub fn write(folder: &Path, summary: &Summary) -> Result<()> {
    let json = serde_json::to_string_pretty(summary).expect("a summary is plain data") + "\n";
    output_file::write(&folder.join("sweep.csv"), |out| out.write_all(&csv(&summary.runs)))?;
    output_file::write(&folder.join("sweep.json"), |out| out.write_all(json.as_bytes()))?;
    let html = page(summary);
    output_file::write(&folder.join("report.html"), |out| out.write_all(html.as_bytes()))
}
