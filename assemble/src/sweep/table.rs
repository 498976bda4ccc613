//! The tables that a sweep writes: `sweep.csv`, one line a run with its cost and errors, and the points at which runs
//! report their light.

use super::row::Row;
use super::setting::Kind;
use crate::gather::points::Place;

/// The first line. Seconds are wall time but for `cpu`, errors are shares of the mean, and unknown values are empty.
pub const HEADER: [&str; 25] = [
    "method",
    "element_size_m",
    "tolerance",
    "rays",
    "unshot",
    "more",
    "elements",
    "seconds_solve",
    "seconds_solve_cpu",
    "seconds_points",
    "seconds_points_cpu",
    "seconds_process",
    "bytes_stored",
    "bytes_peak",
    "rounds",
    "error_elements",
    "error_gathered",
    "on_elements_front",
    "on_gathered_front",
    "is_default",
    "is_reference",
    "t1",
    "t2",
    "t3",
    "command",
];

/// `sweep.csv`: the header, and one line for each row.
pub fn csv(rows: &[Row]) -> Vec<u8> {
    csv_bytes(std::iter::once(HEADER.map(str::to_owned)).chain(rows.iter().map(line)))
}

/// The points as a table that `assemble --points` reads.
pub fn points_csv(points: &[Place]) -> Vec<u8> {
    let line =
        |place: &Place| [place.point, place.normal].map(|v| v.to_array().map(|x| x.to_string())).concat();
    let header = ["x", "y", "z", "nx", "ny", "nz"].map(str::to_owned).to_vec();
    csv_bytes(std::iter::once(header).chain(points.iter().map(line)))
}

/// Lines of equally many fields as comma-separated values.
fn csv_bytes(lines: impl Iterator<Item = impl IntoIterator<Item = String>>) -> Vec<u8> {
    let mut table = csv::Writer::from_writer(vec![]);
    lines.for_each(|line| table.write_record(line).expect("a vector takes every line of equal length"));
    table.into_inner().expect("a vector takes every byte")
}

fn line(row: &Row) -> [String; HEADER.len()] {
    let number = |value: Option<f64>| value.map(|value| value.to_string()).unwrap_or_default();
    let (method, tolerance, rays, unshot) = match row.setting.kind {
        Kind::Parts { tolerance } | Kind::Verified { tolerance } => ("parts", Some(tolerance), None, None),
        Kind::Dense => ("dense", None, None, None),
        Kind::Rays(rays) => ("rays", None, Some(f64::from(rays)), None),
        Kind::Progressive { unshot } => ("progressive", None, None, Some(unshot)),
    };
    [
        method.to_owned(),
        row.setting.element_size.to_string(),
        number(tolerance),
        number(rays),
        number(unshot),
        row.setting.more.join(" "),
        row.elements.to_string(),
        row.seconds_solve.to_string(),
        number(row.seconds_solve_cpu),
        row.seconds_points.to_string(),
        number(row.seconds_points_cpu),
        row.seconds_process.to_string(),
        row.bytes_stored.to_string(),
        number(row.bytes_peak.map(|bytes| bytes as f64)),
        row.rounds.to_string(),
        row.errors.elements.to_string(),
        row.errors.gathered.to_string(),
        row.on_elements_front.to_string(),
        row.on_gathered_front.to_string(),
        row.is_default.to_string(),
        row.is_reference.to_string(),
        row.steps.t1.to_string(),
        row.steps.t2.to_string(),
        row.steps.t3.to_string(),
        row.command.clone(),
    ]
}
