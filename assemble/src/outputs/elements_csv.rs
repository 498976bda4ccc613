//! All elements with their light as a table for spreadsheets and other programs. Input: a [`SceneLight`]. Output: a
//! CSV file (RFC 4180, but with line feeds as line ends): one line for each element, numbers in the shortest form
//! that reads back to the same f64.

use crate::output_file;
use crate::outputs::scene_light::SceneLight;
use csv::WriterBuilder;
use equilux_formats::Result;
use std::io::{self, Write};
use std::path::Path;

/// The columns: centroid (m), normal, area (m²), reflectance, emission, irradiance and radiosity (W/m², linear RGB), and
/// names.
pub const COLUMNS: [&str; 21] = [
    "x", "y", "z", "nx", "ny", "nz", "area", "rho_r", "rho_g", "rho_b", "E_r", "E_g", "E_b", "H_r", "H_g",
    "H_b", "B_r", "B_g", "B_b", "part", "instance",
];

/// Write the table to `path`. Fails if it cannot be written.
pub fn write(path: &Path, light: &SceneLight) -> Result<()> {
    output_file::write(path, |out| table(out, light))
}

fn table(out: &mut dyn Write, light: &SceneLight) -> io::Result<()> {
    let mut lines = WriterBuilder::new().from_writer(out);
    lines.write_record(COLUMNS)?;
    for instance in 0..light.world.instances() {
        let names = [&light.part_names[instance], &light.instance_names[instance]];
        for element in light.world.elements_of(instance) {
            let numbers = numbers(light, element).map(|number| number.to_string());
            lines.write_record(numbers.chain(names.map(String::clone)))?;
        }
    }
    lines.flush()
}

fn numbers(light: &SceneLight, index: usize) -> impl Iterator<Item = f64> {
    let element = &light.world.elements[index];
    let place =
        [(element.centroid + light.origin).to_array(), element.normal.to_array()].into_iter().flatten();
    let rows = [light.reflectance, light.emission, light.irradiance, light.radiosity].map(|rows| rows[index]);
    place.chain([element.area]).chain(rows.into_iter().flatten())
}
