//! Light at single points of a scene's surfaces: in goes a table of places, out comes a table of their irradiance, gathered
//! with exact visibility as that of lightmap texels is, beside that of the elements which the points lie on.

use crate::gather::{Gather, receiver};
use crate::output_file;
use csv::StringRecord;
use equilux_bake::monitor::Monitor;
use equilux_bake::visibility::rays::RayIndex;
use equilux_formats::{Element, Error, Result, Rgb};
use glam::DVec3;
use rayon::prelude::*;
use std::io::{self, Write};
use std::path::Path;

/// The first line of the table that is written: the places as they were read (m, unit normal), the irradiance at the point,
/// the number of the element there and the element's own irradiance (W/m², linear RGB).
pub const HEADER: &str = "x,y,z,nx,ny,nz,H_r,H_g,H_b,element,He_r,He_g,He_b";

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
    /// Where, metres.
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

/// Where places are in a table.
const PLACE: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Where irradiance is in a table: at points, or of elements.
const LIGHT: [[&str; 3]; 2] = [["Hc_r", "Hc_g", "Hc_b"], ["H_r", "H_g", "H_b"]];

/// Read the places of a table with the columns `x`, `y`, `z`, `nx`, `ny` and `nz`; others are ignored. Fails if the file cannot
/// be read, has no such columns or holds what is no finite number.
pub fn read(file: &Path) -> Result<Vec<Place>> {
    let rows = rows(file, |_| PLACE.to_vec())?;
    rows.iter().enumerate().map(|(number, row)| place(file, number, row)).collect()
}

/// Read places and their irradiance, W/m², from `Hc_r`, `Hc_g` and `Hc_b` or from `H_r`, `H_g` and `H_b`. Fails as [`read`] does.
pub fn read_light(file: &Path) -> Result<Vec<(Place, Rgb)>> {
    let columns = |header: &StringRecord| {
        let has = |name: &str| header.iter().any(|field| field.trim() == name);
        let light = if has(LIGHT[0][0]) { LIGHT[0] } else { LIGHT[1] };
        [&PLACE[..], &light].concat()
    };
    let lit = |(number, row): (usize, &Vec<f64>)| Ok((place(file, number, row)?, [row[6], row[7], row[8]]));
    rows(file, columns)?.iter().enumerate().map(lit).collect()
}

fn place(file: &Path, number: usize, row: &[f64]) -> Result<Place> {
    let normal = DVec3::new(row[3], row[4], row[5]).try_normalize();
    let normal = normal.ok_or_else(|| unusable(file, format!("line {} has no normal", number + 2)))?;
    Ok(Place { point: DVec3::new(row[0], row[1], row[2]), normal })
}

/// The numbers in the columns that `wanted` chooses from the first line, line by line.
fn rows<'n>(file: &Path, wanted: impl Fn(&StringRecord) -> Vec<&'n str>) -> Result<Vec<Vec<f64>>> {
    let unreadable = |error: csv::Error| unusable(file, format!("cannot be read ({error})"));
    let mut table = csv::Reader::from_path(file).map_err(unreadable)?;
    let header = table.headers().map_err(unreadable)?.clone();
    let column = |name: &&str| {
        let found = header.iter().position(|field| field.trim() == *name);
        found.ok_or_else(|| unusable(file, format!("has no column `{name}`")))
    };
    let columns: Vec<usize> = wanted(&header).iter().map(column).collect::<Result<_>>()?;
    let mut rows = Vec::new();
    for (number, record) in table.records().enumerate() {
        let record = record.map_err(unreadable)?;
        let number_in = |&column: &usize| record[column].trim().parse().ok().filter(|v: &f64| v.is_finite());
        let row: Option<Vec<f64>> = columns.iter().map(number_in).collect();
        rows.push(row.ok_or_else(|| unusable(file, format!("line {} holds what is no number", number + 2)))?);
    }
    if rows.is_empty() {
        return Err(unusable(file, "holds no points".into()));
    }
    Ok(rows)
}

fn unusable(file: &Path, found: String) -> Error {
    let expected = "a table with a line a point, and numbers in columns named on the first line: x, y, z, nx, ny, nz, and for light \
                    H_r, H_g, H_b";
    Error::new(file, found, expected, "write the points as comma-separated values with such a first line")
}

/// The light at places, none for those on no surface of these `elements`, which are the scene's. None at all if the monitor
/// is stopped meanwhile.
pub fn light(
    gather: &Gather,
    elements: &[Element],
    places: &[Place],
    monitor: &Monitor,
) -> Option<Vec<Option<PointLight>>> {
    let was_stopped = monitor.stopped();
    let mut found: Vec<(usize, Element, usize)> = located(elements, places)
        .into_iter()
        .enumerate()
        .filter_map(|(place, on)| on.map(|(point, element)| (place, point, element)))
        .collect();
    // Points of one element share most of their search.
    found.sort_by_key(|&(_, _, element)| element);
    let mut lights = vec![None; places.len()];
    monitor.begin("light of points", found.len());
    for batch in found.chunks(BATCH) {
        if monitor.stopped() && !was_stopped {
            return None;
        }
        let points: Vec<Element> = batch.iter().map(|(_, point, _)| *point).collect();
        for (&(place, _, element), irradiance) in batch.iter().zip(gather.irradiance(&points)) {
            lights[place] = Some(PointLight { element, irradiance });
        }
        monitor.advance(batch.len());
    }
    Some(lights)
}

/// The nearest point on an element that looks the place's way, and the element, for each place that has one.
pub fn located(elements: &[Element], places: &[Place]) -> Vec<Option<(Element, usize)>> {
    let index = RayIndex::new(elements);
    let corners = || elements.iter().flat_map(|element| element.corners.as_slice());
    let low = corners().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = corners().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let reach = NEAR * (high - low).length();
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

/// Write the table of places with their light. `irradiance`: that of all elements, W/m². Fails if it cannot be written.
pub fn write(path: &Path, places: &[Place], lights: &[Option<PointLight>], irradiance: &[Rgb]) -> Result<()> {
    output_file::write(path, |out| table(out, places, lights, irradiance))
}

fn table(
    out: &mut dyn Write,
    places: &[Place],
    lights: &[Option<PointLight>],
    irradiance: &[Rgb],
) -> io::Result<()> {
    writeln!(out, "{HEADER}")?;
    let joined = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    for (place, light) in places.iter().zip(lights) {
        let at = joined(&[place.point.to_array(), place.normal.to_array()].concat());
        match light {
            Some(PointLight { element, irradiance: h }) => {
                writeln!(out, "{at},{},{element},{}", joined(h), joined(&irradiance[*element]))?;
            }
            None => writeln!(out, "{at},,,,,,,")?,
        }
    }
    Ok(())
}
