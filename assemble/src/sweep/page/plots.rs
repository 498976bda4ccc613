//! The charts of the page: which runs they show, and in what colours and shapes.

use super::chart::{Chart, Mark, Series};
use crate::sweep::findings::percent;
use crate::sweep::row::Row;
use crate::sweep::setting::{DEFAULT_TOLERANCE, Kind};
use crate::sweep::summary::{Exchange, Summary};
use maud::Markup;

/// A cost and an error of a run, if it has both.
type Of<'a> = &'a dyn Fn(&Row) -> Option<(f64, f64)>;

/// Error against seconds.
pub fn against_seconds(summary: &Summary) -> [Markup; 2] {
    let (gathered, flat): (Of, Of) = (&Row::gathered, &Row::flat);
    [
        chart(
            summary,
            "Light gathered at points: what lightmaps hold",
            "seconds, to solve and to gather",
            gathered,
            short_seconds,
            true,
        ),
        chart(
            summary,
            "Light of flat elements: one value an element",
            "seconds, to solve",
            flat,
            short_seconds,
            true,
        ),
    ]
}

/// Error against bytes.
pub fn against_bytes(summary: &Summary) -> [Markup; 2] {
    let stored = |row: &Row| Some((row.bytes_stored as f64, row.errors.gathered));
    let peak = |row: &Row| Some((row.bytes_peak? as f64, row.errors.gathered));
    [
        chart(summary, "Form factors as they are kept", "bytes of form factors", &stored, bytes, false),
        chart(summary, "The whole process", "most memory held, bytes", &peak, bytes, false),
    ]
}

/// Proved and true error of each exchange, round by round.
pub fn round_by_round(exchanges: &[Exchange]) -> Markup {
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
        title: "Largest error of any element, W/m²",
        across: "round",
        counts: true,
        across_text: |value| format!("{value}"),
        up_text: |value| format!("{value:.0e}"),
        series: &series,
        floor: 0.0,
    };
    chart.draw()
}

fn chart(
    summary: &Summary,
    title: &str,
    across: &str,
    of: Of,
    across_text: fn(f64) -> String,
    is_time: bool,
) -> Markup {
    let rows: Vec<&Row> = summary.runs.iter().filter(|row| !row.is_reference).collect();
    let is = |row: &Row, kind: Kind| row.setting.kind == kind && row.setting.more.is_empty();
    let tolerance = |tolerance| Kind::Parts { tolerance };
    let joined = |name: &str, colour, mark, kind: Kind| {
        series(name, colour, mark, true, &rows, of, &|row| is(row, kind))
    };
    let is_other = |row: &Row| {
        row.setting.is_ours() && !is(row, tolerance(DEFAULT_TOLERANCE)) && !is(row, tolerance(0.0))
    };
    let classic_rays = |rays| Kind::Rays(rays);
    let mut shown = vec![
        series("other settings of Equilux", 5, Mark::Plus, false, &rows, of, &is_other),
        joined("Equilux, exact (tolerance 0)", 2, Mark::Square, tolerance(0.0)),
        joined("Equilux, tolerance 0.01", 0, Mark::Disc, tolerance(DEFAULT_TOLERANCE)),
        joined("classic: dense matrix, exact", 1, Mark::Triangle, Kind::Dense),
        joined("classic: 1 ray a pair", 3, Mark::Diamond, classic_rays(1)),
        joined("classic: 4 rays a pair", 4, Mark::Diamond, classic_rays(4)),
        joined("classic: 16 rays a pair", 6, Mark::Diamond, classic_rays(16)),
    ];
    if is_time {
        let progressive = |row: &Row| matches!(row.setting.kind, Kind::Progressive { .. });
        shown.push(series("classic: progressive refinement", 1, Mark::Cross, false, &rows, of, &progressive));
    }
    shown.push(series("the default", 7, Mark::Ring, false, &rows, of, &|row| row.is_default));
    let chart = Chart {
        title,
        across,
        counts: false,
        across_text,
        up_text: percent,
        series: &shown,
        floor: summary.reference.resolves,
    };
    chart.draw()
}

fn series(
    name: &str,
    colour: usize,
    mark: Mark,
    line: bool,
    rows: &[&Row],
    of: Of,
    belongs: &dyn Fn(&Row) -> bool,
) -> Series {
    let point = |row: &&Row| {
        let (cost, error) = of(row).filter(|(cost, error)| *cost > 0.0 && *error > 0.0)?;
        Some((cost, error, format!("{}: {}\n{}", row.label, percent(error), row.command)))
    };
    let points = rows.iter().filter(|row| belongs(row)).filter_map(point).collect();
    Series { name: name.to_owned(), colour, mark, line, dashed: false, points }
}

fn short_seconds(value: f64) -> String {
    if value >= 1.0 { format!("{value} s") } else { format!("{} ms", (value * 1e3 * 1e3).round() / 1e3) }
}

/// `20 MB`.
pub fn bytes(value: f64) -> String {
    let (unit, name) = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")]
        .into_iter()
        .find(|(unit, _)| value >= *unit)
        .unwrap_or((1.0, "B"));
    let number = value / unit;
    if number >= 9.95 || number.fract() < 0.05 {
        format!("{number:.0} {name}")
    } else {
        format!("{number:.1} {name}")
    }
}
