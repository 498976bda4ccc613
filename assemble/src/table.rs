//! Tables of numbers in comma-separated values, with column names on the first line. Input: a file. Output: columns
//! by name.

use csv::StringRecord;
use equilux_formats::{Error, Result, Rgb};
use std::path::Path;

/// A table that was read. Columns that are not requested may hold anything.
#[derive(Debug)]
pub struct Table<'a> {
    file: &'a Path,
    /// The expected contents and the remedy, for error messages.
    expected: [&'a str; 2],
    header: StringRecord,
    lines: Vec<StringRecord>,
}

impl<'a> Table<'a> {
    /// Read a file. `expected`: the expected contents and the remedy, for error messages. Fails if the file cannot be
    /// read or has no lines after the first.
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

    /// Whether the table has a column of this name.
    pub fn has(&self, name: &str) -> bool {
        self.place(name).is_some()
    }

    /// The numbers of a column. Fails if there is no such column, or if a value is not a finite number.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        let place = self.place(name).ok_or_else(|| self.wrong(format!("has no column {name}")))?;
        let number = |(row, line): (usize, &StringRecord)| {
            let field = line.get(place).unwrap_or_default();
            let number = field.trim().parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| self.wrong_line(row, &format!("has `{field}` for {name}")))
        };
        self.lines.iter().enumerate().map(number).collect()
    }

    /// Three columns as colours. Fails as [`Table::vectors`] does.
    pub fn colours(&self, names: [&str; 3]) -> Result<Vec<Rgb>> {
        Ok(self.vectors(names)?.into_iter().map(Rgb).collect())
    }

    /// Three columns as vectors, line by line. Fails as [`Table::numbers`] does.
    pub fn vectors(&self, names: [&str; 3]) -> Result<Vec<[f64; 3]>> {
        let [x, y, z] = names.map(|name| self.numbers(name));
        let (x, y, z) = (x?, y?, z?);
        Ok((0..x.len()).map(|row| [x[row], y[row], z[row]]).collect())
    }

    /// The error of a line; `row` counts from 0 after the first line.
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
