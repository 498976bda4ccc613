//! Tables of numbers that people give: comma-separated values, with the names of the columns on the first line. In goes a file;
//! out come its columns by name.

use csv::StringRecord;
use equilux_formats::{Error, Result, Rgb};
use std::path::Path;

/// A table that was read. Columns that nobody asks for may hold anything.
pub struct Table<'a> {
    file: &'a Path,
    /// What a person is told that the file should hold, and what to do.
    expected: [&'a str; 2],
    header: StringRecord,
    lines: Vec<StringRecord>,
}

impl<'a> Table<'a> {
    /// Read a file; `expected` tells what it should hold, and what to do if it does not. Fails if it cannot be read or has no
    /// line but the first.
    pub fn read(file: &'a Path, expected: [&'a str; 2]) -> Result<Self> {
        let mut table = Self { file, expected, header: StringRecord::new(), lines: vec![] };
        let unreadable = |error: csv::Error| table.wrong(format!("cannot be read ({error})"));
        let mut reader = csv::Reader::from_path(file).map_err(unreadable)?;
        let header = reader.headers().map_err(unreadable)?.clone();
        let lines: Vec<StringRecord> =
            reader.records().collect::<std::result::Result<_, _>>().map_err(unreadable)?;
        if lines.is_empty() {
            return Err(table.wrong("holds no line below its first".into()));
        }
        (table.header, table.lines) = (header, lines);
        Ok(table)
    }

    /// Whether there is a column of this name.
    pub fn has(&self, name: &str) -> bool {
        self.place(name).is_some()
    }

    /// A column. Fails if there is none, or if it holds what is no finite number.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        let place = self.place(name).ok_or_else(|| self.wrong(format!("has no column {name}")))?;
        let number = |(row, line): (usize, &StringRecord)| {
            let field = line.get(place).unwrap_or_default();
            let number = field.trim().parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| self.wrong_line(row, &format!("has `{field}` for {name}")))
        };
        self.lines.iter().enumerate().map(number).collect()
    }

    /// The colours in three columns. Fails as [`Table::vectors`] does.
    pub fn colours(&self, names: [&str; 3]) -> Result<Vec<Rgb>> {
        Ok(self.vectors(names)?.into_iter().map(Rgb).collect())
    }

    /// Three columns, line by line. Fails as one does.
    pub fn vectors(&self, names: [&str; 3]) -> Result<Vec<[f64; 3]>> {
        let [x, y, z] = names.map(|name| self.numbers(name));
        let (x, y, z) = (x?, y?, z?);
        Ok((0..x.len()).map(|row| [x[row], y[row], z[row]]).collect())
    }

    /// The error of a line, counted from 0 below the first.
    pub fn wrong_line(&self, row: usize, found: &str) -> Error {
        self.wrong(format!("line {} {found}", row + 2))
    }

    fn wrong(&self, found: String) -> Error {
        let [expected, remedy] = self.expected;
        Error::new(self.file, found, expected, remedy)
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|field| field.trim() == name)
    }
}
