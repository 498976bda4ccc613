//! The charts of the page: which runs they show, in which colours and shapes.

use super::axis::Scale;
use super::chart::{Chart, Series};
use super::mark::Mark;
use crate::sweep::numbers::{bytes, percent, power_of_ten};
use crate::sweep::row::Row;
use crate::sweep::setting::{DEFAULT_TOLERANCE, Kind};
use crate::sweep::summary::{Exchange, Summary};
use maud::Markup;

/// A cost and an error of a run, if it has both.
type Of<'a> = &'a dyn Fn(&Row) -> Option<(f64, f64)>;

/// What the runs of a chart cost.
struct Cost<'a> {
    /// The name of the horizontal axis.
    name: &'a str,
    /// How costs are written.
    text: fn(f64) -> String,
    /// The cost of a run and its error.
    of: Of<'a>,
}

/// Error against time. Charts without points are left out.
pub fn against_seconds(summary: &Summary) -> Vec<Markup> {
    let clock = summary.runs.first().map_or("time", Row::clock);
    let gathered = Cost {
        name: &format!("{clock} to solve and gather"),
        text: short_seconds,
        of: &|row| Some(row.gathered()),
    };
    let flat = Cost { name: &format!("{clock} to solve"), text: short_seconds, of: &|row| Some(row.flat()) };
    let charts = [
        chart(summary, "Light at points, as lightmaps have it", &gathered, true),
        chart(summary, "Light of elements: one value each", &flat, true),
    ];
    charts.into_iter().flatten().collect()
}

/// Error against memory. Charts without points are left out.
pub fn against_bytes(summary: &Summary) -> Vec<Markup> {
    let stored = |row: &Row| Some((row.bytes_stored as f64, row.errors.gathered));
    let peak = |row: &Row| Some((row.bytes_peak? as f64, row.errors.gathered));
    let [stored, peak]: [Cost; 2] = [
        Cost { name: "size of the form factors", text: bytes, of: &stored },
        Cost { name: "peak memory", text: bytes, of: &peak },
    ];
    let charts = [
        chart(summary, "Stored form factors", &stored, false),
        chart(summary, "Peak memory of the process", &peak, false),
    ];
    charts.into_iter().flatten().collect()
}

/// Proved and true error of each exchange, round by round.
pub fn round_by_round(exchanges: &[Exchange]) -> Option<Markup> {
    let mut series = vec![];
    for (number, exchange) in exchanges.iter().enumerate() {
        let points = |of: &dyn Fn(usize) -> Option<f64>, what: &str| -> Vec<(f64, f64, String)> {
            (0..exchange.rounds.len())
                .filter_map(|k| Some((k as f64 + 1.0, of(k).filter(|e| *e > 0.0)?)))
                .map(|(round, error)| (round, error, format!("{what}, round {round}: {error:.1e} W/m²")))
                .collect()
        };
        let (colour, mark) = if number == 0 { (1, Mark::Square) } else { (0, Mark::Disc) };
        let own =
            |name: String, dashed, mark, points| Series { name, colour, mark, line: true, dashed, points };
        let proved = points(&|k| exchange.rounds[k].error_bound, "proved");
        let error = points(&|k| exchange.rounds[k].true_error, "true error");
        series.push(own(format!("{}: proved", exchange.label), true, Mark::Nothing, proved));
        series.push(own(format!("{}: true error", exchange.label), false, mark, error));
    }
    let chart = Chart {
        title: "Error after each round",
        across: "round",
        up: "largest error of any element, W/m²",
        across_scale: Scale::Counting,
        across_text: |value| format!("{value}"),
        up_text: power_of_ten,
        series: &series,
        floor: 0.0,
    };
    chart.draw()
}

/// The chart of all runs. Progressive refinement stores no form factors, and is in charts of time only.
fn chart(summary: &Summary, title: &str, cost: &Cost, is_time: bool) -> Option<Markup> {
    let rows: Vec<&Row> = summary.runs.iter().filter(|row| !row.is_reference).collect();
    let is = |row: &Row, kind: Kind| row.setting.kind == kind && row.setting.more.is_empty();
    let tolerance = |tolerance| Kind::Parts { tolerance };
    let points = |belongs: &dyn Fn(&Row) -> bool| points(&rows, cost, belongs);
    let single = |name: &str, colour, mark, belongs: &dyn Fn(&Row) -> bool| {
        let points = points(belongs);
        Series { name: name.to_owned(), colour, mark, line: false, dashed: false, points }
    };
    let joined = |name: &str, colour, mark, kind: Kind| Series {
        line: true,
        ..single(name, colour, mark, &|row| is(row, kind))
    };
    let is_other = |row: &Row| {
        row.setting.is_ours() && !is(row, tolerance(DEFAULT_TOLERANCE)) && !is(row, tolerance(0.0))
    };
    let mut series = vec![
        single("other settings", 5, Mark::Plus, &is_other),
        joined("Equilux, exact (tolerance 0)", 2, Mark::Square, tolerance(0.0)),
        joined("Equilux, tolerance 0.01", 0, Mark::Disc, tolerance(DEFAULT_TOLERANCE)),
        joined("classic: dense matrix, exact", 1, Mark::Triangle, Kind::Dense),
        joined("classic: 1 ray a pair", 3, Mark::Diamond, Kind::Rays(1)),
        joined("classic: 4 rays a pair", 4, Mark::Diamond, Kind::Rays(4)),
        joined("classic: 16 rays a pair", 6, Mark::Diamond, Kind::Rays(16)),
    ];
    if is_time {
        let progressive = |row: &Row| matches!(row.setting.kind, Kind::Progressive { .. });
        series.push(single("classic: progressive refinement", 1, Mark::Cross, &progressive));
    }
    series.push(single("the default settings", 7, Mark::Ring, &|row| row.is_default));
    let chart = Chart {
        title,
        across: cost.name,
        up: "error",
        across_scale: Scale::Logarithmic,
        across_text: cost.text,
        up_text: percent,
        series: &series,
        floor: summary.reference.resolves,
    };
    chart.draw()
}

/// The points of the runs that belong to a series.
fn points(rows: &[&Row], cost: &Cost, belongs: &dyn Fn(&Row) -> bool) -> Vec<(f64, f64, String)> {
    let point = |row: &&Row| {
        let (cost, error) = (cost.of)(row).filter(|(cost, error)| *cost > 0.0 && *error > 0.0)?;
        Some((cost, error, format!("{}: {}\n{}", row.label, percent(error), row.command)))
    };
    rows.iter().filter(|row| belongs(row)).filter_map(point).collect()
}

fn short_seconds(value: f64) -> String {
    if value >= 0.0999 {
        format!("{}\u{a0}s", (value * 1e3).round() / 1e3)
    } else {
        format!("{}\u{a0}ms", (value * 1e6).round() / 1e3)
    }
}
