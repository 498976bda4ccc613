//! Light at single points of a scene's surfaces: in goes a table of places, out comes a table of their irradiance, gathered
//! with exact visibility as that of lightmap texels is, beside that of the elements which the points lie on.

use crate::gather::Gather;
use crate::gather::receiver::receiver;
use crate::output_file;
use crate::table::Table;
use csv::WriterBuilder;
use equilux_bake::geometry::aabb::Aabb;
use equilux_bake::monitor::Monitor;
use equilux_bake::rays::RayIndex;
use equilux_formats::{Element, Error, Result, Rgb};
use glam::DVec3;
use rayon::prelude::*;
use std::io::{self, Write};
use std::path::Path;

/// The first line of the table that is written: the places as they were read (m, unit normal), the irradiance at the point,
/// the number of the element there and the element's own irradiance (W/m², linear RGB).
pub const COLUMNS: [&str; 13] =
    ["x", "y", "z", "nx", "ny", "nz", "H_r", "H_g", "H_b", "element", "He_r", "He_g", "He_b"];

/// A point is on a surface if it is no further from it than this share of the scene: tables are written with six digits, and
/// a quad of a table may be two triangles here that are not quite in one plane.
const NEAR: f64 = 1e-4;

/// A surface looks the way of a point if the angle between them has at least this cosine.
const ALIKE: f64 = 0.9;

/// So many points are gathered at once; then it is asked whether to stop.
const BATCH: usize = 256;

/// A place on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Where, scene coordinates, metres.
    pub point: DVec3,
    /// The way the surface looks, unit length.
    pub normal: DVec3,
}

/// The light at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLight {
    /// The element that the place is on.
    pub element: usize,
    /// Irradiance gathered at the very point, W/m².
    pub irradiance: Rgb,
}

/// What a table of points should hold, and what to do if it does not.
const EXPECTED: [&str; 2] = [
    "a table with a line a point, and numbers in columns named on the first line: x, y, z, nx, ny, nz, and for light H_r, H_g, H_b",
    "write the points as comma-separated values with such a first line",
];

/// Read the places of a table with the columns `x`, `y`, `z`, `nx`, `ny` and `nz`; others are ignored. Fails if the file cannot
/// be read, has no such columns or holds what is no finite number. Tables are in the coordinates of the scene's file, in which
/// those of the scene begin at `origin`.
pub fn read(file: &Path, origin: DVec3) -> Result<Vec<Place>> {
    places(&Table::read(file, EXPECTED)?, origin)
}

/// Read places and their irradiance, W/m², from `Hc_r`, `Hc_g` and `Hc_b` or from `H_r`, `H_g` and `H_b`. Fails as [`read`] does.
pub fn read_light(file: &Path, origin: DVec3) -> Result<(Vec<Place>, Vec<Rgb>)> {
    let table = Table::read(file, EXPECTED)?;
    let names = if table.has("Hc_r") { ["Hc_r", "Hc_g", "Hc_b"] } else { ["H_r", "H_g", "H_b"] };
    Ok((places(&table, origin)?, table.colours(names)?))
}

/// The places of a table that is read. Fails as [`read`] does.
pub fn places(table: &Table, origin: DVec3) -> Result<Vec<Place>> {
    let (points, normals) = (table.vectors(["x", "y", "z"])?, table.vectors(["nx", "ny", "nz"])?);
    let place = |(row, (point, normal)): (usize, ([f64; 3], [f64; 3]))| {
        let normal = DVec3::from(normal).try_normalize();
        let normal = normal.ok_or_else(|| table.wrong_line(row, "has no normal"))?;
        Ok(Place { point: DVec3::from(point) - origin, normal })
    };
    points.into_iter().zip(normals).enumerate().map(place).collect()
}

/// Light at a point takes about as much time as this many rows of form factors.
pub const ROWS_PER_POINT: f64 = 1.0;

/// The light at places, none for those on no surface of these `elements`, which are the scene's. Fails if the monitor is
/// stopped meanwhile; a stop before was meant for something else.
pub fn light(
    gather: &Gather,
    elements: &[Element],
    places: &[Place],
    monitor: &Monitor,
) -> Result<Vec<Option<PointLight>>> {
    let was_stopped = monitor.stopped();
    let mut found: Vec<(usize, Element, usize)> = located(elements, places)
        .into_iter()
        .enumerate()
        .filter_map(|(place, on)| on.map(|(point, element)| (place, point, element)))
        .collect();
    // Points of one element share most of their search.
    found.sort_by_key(|&(_, _, element)| element);
    let mut lights = vec![None; places.len()];
    monitor.begin("light of points", found.len(), ROWS_PER_POINT * found.len() as f64);
    for batch in found.chunks(BATCH) {
        if monitor.stopped() && !was_stopped {
            return Err(Error::Stopped);
        }
        let points: Vec<Element> = batch.iter().map(|(_, point, _)| *point).collect();
        for (&(place, _, element), irradiance) in batch.iter().zip(gather.irradiance(&points)) {
            lights[place] = Some(PointLight { element, irradiance });
        }
        monitor.advance(batch.len());
    }
    Ok(lights)
}

/// The nearest point on an element that looks the place's way, and the element, for each place that has one.
pub fn located(elements: &[Element], places: &[Place]) -> Vec<Option<(Element, usize)>> {
    let index = RayIndex::new(elements);
    let around = Aabb::around(elements.iter().flat_map(|element| element.corners.as_slice()));
    let reach = NEAR * around.diagonal();
    let locate = |place: &Place| {
        let start = place.point + place.normal * reach;
        let along = -2.0 * reach * place.normal;
        let hit = index.first_front(start, along).filter(|hit| hit.distance <= 1.0)?;
        let element = &elements[hit.element];
        let looks_alike = element.normal.dot(place.normal) >= ALIKE;
        let point = || receiver(start + along * hit.distance, element.normal, element.face);
        looks_alike.then(|| (point(), hit.element))
    };
    places.par_iter().map(locate).collect()
}

/// Write the table of places, in the coordinates that they were read in, with their light. `irradiance`: that of all
/// elements, W/m². Fails if it cannot be written.
pub fn write(
    path: &Path,
    places: &[Place],
    origin: DVec3,
    lights: &[Option<PointLight>],
    irradiance: &[Rgb],
) -> Result<()> {
    output_file::write(path, |out| table(out, places, origin, lights, irradiance))
}

fn table(
    out: &mut dyn Write,
    places: &[Place],
    origin: DVec3,
    lights: &[Option<PointLight>],
    irradiance: &[Rgb],
) -> io::Result<()> {
    let mut lines = WriterBuilder::new().from_writer(out);
    lines.write_record(COLUMNS)?;
    for (place, light) in places.iter().zip(lights) {
        let at = [(place.point + origin).to_array(), place.normal.to_array()].concat();
        let mut line: Vec<String> = at.iter().map(f64::to_string).collect();
        if let Some(PointLight { element, irradiance: gathered }) = light {
            line.extend(gathered.0.map(|h| h.to_string()));
            line.push(element.to_string());
            line.extend(irradiance[*element].0.map(|h| h.to_string()));
        }
        line.resize(COLUMNS.len(), String::new());
        lines.write_record(line)?;
    }
    lines.flush()
}
