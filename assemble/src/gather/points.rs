//! Light at single points of a scene's surfaces. Input: a table of points. Output: a table of their irradiance,
//! gathered with exact visibility like that of lightmap texels, together with the irradiance of the elements on which
//! the points lie.

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

/// Columns of the written table: points as they were read (m, unit normal), irradiance at the point, number of the
/// element and irradiance of the element (W/m², linear RGB).
pub const COLUMNS: [&str; 13] =
    ["x", "y", "z", "nx", "ny", "nz", "H_r", "H_g", "H_b", "element", "He_r", "He_g", "He_b"];

/// Maximum distance of a point from a surface on which it lies, as a share of the scene's size: tables are written
/// with six digits, and a quad in a table may be two triangles here that are not quite coplanar.
const MAX_DISTANCE_SHARE: f64 = 1e-4;

/// Minimum cosine of the angle between the normals of a point and its surface.
const MIN_NORMAL_COSINE: f64 = 0.9;

/// Number of points that are gathered together; stop requests are checked between batches.
const BATCH_POINTS: usize = 256;

/// A point on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Position in scene coordinates, metres.
    pub point: DVec3,
    /// Unit normal of the surface.
    pub normal: DVec3,
}

/// The light at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLight {
    /// The element on which the point lies.
    pub element: usize,
    /// Irradiance gathered at the point itself, W/m².
    pub irradiance: Rgb,
}

/// Expected contents of a table of points, and the remedy.
const EXPECTED: [&str; 2] = [
    "a table with one line for each point, and numbers in columns named on the first line: x, y, z, nx, ny, nz, and for light H_r, H_g, H_b",
    "write the points as comma-separated values with such a first line",
];

/// Read the points of a table with the columns `x`, `y`, `z`, `nx`, `ny` and `nz`; other columns are ignored. Tables
/// use the coordinates of the scene's file. `origin`: the origin of scene coordinates in those of the file, metres.
/// Fails if the file cannot be read, lacks one of the columns, or holds a value that is not a finite number.
pub fn read(file: &Path, origin: DVec3) -> Result<Vec<Place>> {
    places(&Table::read(file, EXPECTED)?, origin)
}

/// Read points and their irradiance, W/m², from `Hc_r`, `Hc_g` and `Hc_b`, or from `H_r`, `H_g` and `H_b`. Fails as
/// [`read`] does.
pub fn read_light(file: &Path, origin: DVec3) -> Result<(Vec<Place>, Vec<Rgb>)> {
    let table = Table::read(file, EXPECTED)?;
    let names = if table.has("Hc_r") { ["Hc_r", "Hc_g", "Hc_b"] } else { ["H_r", "H_g", "H_b"] };
    Ok((places(&table, origin)?, table.colours(names)?))
}

/// The points of a table. Fails as [`read`] does.
pub fn places(table: &Table, origin: DVec3) -> Result<Vec<Place>> {
    let (points, normals) = (table.vectors(["x", "y", "z"])?, table.vectors(["nx", "ny", "nz"])?);
    let place = |(row, (point, normal)): (usize, ([f64; 3], [f64; 3]))| {
        let normal = DVec3::from(normal).try_normalize();
        let normal = normal.ok_or_else(|| table.wrong_line(row, "has no normal"))?;
        Ok(Place { point: DVec3::from(point) - origin, normal })
    };
    points.into_iter().zip(normals).enumerate().map(place).collect()
}

/// Cost of the light at a point, in rows of form factors.
pub const ROWS_PER_POINT: f64 = 1.0;

/// The light at points, as `irradiance` computes it, W/m²; none for points on no surface of `elements`, the scene's elements. Fails if the monitor is
/// stopped meanwhile; earlier stops only ended the exchange.
pub fn light(
    irradiance: impl Fn(&[Element]) -> Vec<Rgb>,
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
    for batch in found.chunks(BATCH_POINTS) {
        if monitor.stopped() && !was_stopped {
            return Err(Error::Stopped);
        }
        let points: Vec<Element> = batch.iter().map(|(_, point, _)| *point).collect();
        for (&(place, _, element), irradiance) in batch.iter().zip(irradiance(&points)) {
            lights[place] = Some(PointLight { element, irradiance });
        }
        monitor.advance(batch.len());
    }
    Ok(lights)
}

/// For each point, the nearest point on an element that faces the same way, and that element, if there is one.
pub fn located(elements: &[Element], places: &[Place]) -> Vec<Option<(Element, usize)>> {
    let index = RayIndex::new(elements);
    let around = Aabb::around(elements.iter().flat_map(|element| element.corners.as_slice()));
    let reach = MAX_DISTANCE_SHARE * around.diagonal();
    let locate = |place: &Place| {
        let start = place.point + place.normal * reach;
        let along = -2.0 * reach * place.normal;
        let hit = index.first_front(start, along).filter(|hit| hit.distance <= 1.0)?;
        let element = &elements[hit.element];
        let looks_alike = element.normal.dot(place.normal) >= MIN_NORMAL_COSINE;
        let point = || receiver(start + along * hit.distance, element.normal, element.face);
        looks_alike.then(|| (point(), hit.element))
    };
    places.par_iter().map(locate).collect()
}

/// Write the table of points, in the coordinates in which they were read, with their light. `irradiance`: that of all
/// elements, W/m². Fails if the file cannot be written.
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
