//! A CSV file with columns found by name; only numbers are read.

use glam::{DVec3, dvec3};
use std::collections::HashMap;
use std::path::Path;

/// The numbers of a table by column.
#[derive(Debug)]
pub struct Table {
    columns: HashMap<String, Vec<f64>>,
}

impl Table {
    /// Reads `path`; only names at the end of a line may be other than numbers.
    pub fn read(path: &Path) -> Self {
        let text =
            std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let (header, lines) = text.split_once('\n').expect("a header");
        let mut columns = HashMap::new();
        for (place, name) in
            header.split(',').enumerate().filter(|(_, name)| !["part", "instance"].contains(name))
        {
            let field = |line: &str| line.split(',').nth(place).and_then(|field| field.parse().ok());
            let numbers = lines.lines().map(|line| {
                field(line).unwrap_or_else(|| panic!("{}: no number {name} in '{line}'", path.display()))
            });
            columns.insert(name.to_owned(), numbers.collect());
        }
        Self { columns }
    }

    /// Number of lines below the header.
    pub fn rows(&self) -> usize {
        self.columns["area"].len()
    }

    /// The number in that row and column.
    pub fn number(&self, row: usize, column: &str) -> f64 {
        self.columns[column][row]
    }

    /// Three columns, row by row.
    pub fn vectors(&self, columns: [&str; 3]) -> Vec<DVec3> {
        let [x, y, z] = columns.map(|column| &self.columns[column]);
        (0..self.rows()).map(|row| dvec3(x[row], y[row], z[row])).collect()
    }
}
