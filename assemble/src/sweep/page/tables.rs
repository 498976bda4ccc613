//! The tables of the page.

use super::plots::bytes;
use crate::sweep::findings::{percent, seconds};
use crate::sweep::row::Row;
use crate::sweep::separation::Source;
use crate::sweep::setting::Kind;
use crate::sweep::summary::Summary;
use maud::{Markup, html};

/// A table of texts; the first columns, as many as `left`, are aligned left, as is the last.
fn table(left: usize, head: &[&str], rows: &[(bool, Vec<Markup>)]) -> Markup {
    let is_left = |k: usize| k < left || k + 1 == head.len();
    html! {
        @if rows.is_empty() {
            p.quiet { "No run tells." }
        } @else {
            div.wide {
                table {
                    thead { tr { @for (k, title) in head.iter().enumerate() { th.left[is_left(k)] { (title) } } } }
                    tbody {
                        @for (chosen, cells) in rows {
                            tr.chosen[*chosen] { @for (k, cell) in cells.iter().enumerate() { td.left[is_left(k)] { (cell) } } }
                        }
                    }
                }
            }
        }
    }
}

fn text(text: impl Into<String>) -> Markup {
    let text = text.into();
    html! { (text) }
}

fn code(text: &str) -> Markup {
    html! { code { (text) } }
}

fn error(share: f64) -> Markup {
    text(percent(share))
}

/// The quickest settings for some errors.
pub fn cheapest(summary: &Summary) -> Markup {
    let mut rows = vec![];
    for target in &summary.cheapest {
        let both = [("points", target.gathered), ("elements", target.elements)];
        for (what, row) in both {
            let row = row.map(|row| &summary.runs[row]);
            let time =
                |row: &Row| row.seconds_solve + if what == "points" { row.seconds_points } else { 0.0 };
            rows.push((
                false,
                vec![
                    text(percent(target.error)),
                    text(what),
                    text(row.map_or("–".into(), |row| seconds(time(row)))),
                    text(row.map_or("–".into(), |row| row.elements.to_string())),
                    row.map_or(text("nothing that was tried is so good"), |row| code(&row.command)),
                ],
            ));
        }
    }
    table(2, &["error at most", "of", "takes", "elements", "with"], &rows)
}

/// Settings that no other beats.
pub fn front(summary: &Summary) -> Markup {
    let mut on: Vec<&Row> =
        summary.runs.iter().filter(|row| row.on_gathered_front || row.on_elements_front).collect();
    on.sort_by(|a, b| a.seconds_solve.total_cmp(&b.seconds_solve));
    let fronts = |row: &Row| match (row.on_gathered_front, row.on_elements_front) {
        (true, true) => "both",
        (true, false) => "points",
        _ => "elements",
    };
    let rows: Vec<(bool, Vec<Markup>)> = on
        .into_iter()
        .map(|row| {
            (
                row.is_default,
                vec![
                    text(fronts(row)),
                    text(row.elements.to_string()),
                    text(seconds(row.seconds_solve)),
                    text(seconds(row.seconds_points)),
                    error(row.errors.elements),
                    error(row.errors.gathered),
                    text(bytes(row.bytes_stored as f64)),
                    code(&row.command),
                ],
            )
        })
        .collect();
    table(
        1,
        &[
            "best for",
            "elements",
            "solve",
            "gather",
            "error, elements",
            "error, points",
            "form factors",
            "command",
        ],
        &rows,
    )
}

/// Errors by where they come from.
pub fn separated(summary: &Summary) -> Markup {
    let name = |from| match from {
        Source::Discretisation => "discretisation",
        Source::Compression => "compression",
        Source::Iteration => "iteration",
    };
    let rows: Vec<(bool, Vec<Markup>)> = summary
        .separated
        .iter()
        .map(|row| {
            (
                false,
                vec![
                    text(name(row.from)),
                    text(row.elements.to_string()),
                    error(row.errors.elements),
                    error(row.errors.gathered),
                    text(row.choice.clone()),
                ],
            )
        })
        .collect();
    table(1, &["from", "elements", "error, elements", "error, points", "of"], &rows)
}

/// The paper's steps.
pub fn steps(summary: &Summary) -> Markup {
    let shown = |row: &&Row| {
        let tells = ["--exchange jacobi", "--bisect 2", "--bisect 8", ""];
        row.setting.is_ours()
            && tells.contains(&row.setting.more.join(" ").as_str())
            && (row.setting.element_size == summary.default_element_size)
    };
    let number = |value: f64| text(if value == 0.0 { "0".into() } else { format!("{value:.3}") });
    let rows: Vec<(bool, Vec<Markup>)> = summary
        .runs
        .iter()
        .filter(shown)
        .map(|row| {
            let s = &row.steps;
            let mut cells = vec![text(row.elements.to_string())];
            cells.extend(
                [s.step1, s.step2, s.step3, s.step4, s.step5, s.step6, s.step7, s.step8, s.t1, s.t2, s.t3]
                    .map(number),
            );
            cells.push(text(row.label.clone()));
            (row.is_default, cells)
        })
        .collect();
    table(0, &["elements", "1", "2", "3", "4", "5", "6", "7", "8", "T₁", "T₂", "T₃", "setting"], &rows)
}

/// The runs of the chart of rounds.
pub fn exchanges(summary: &Summary) -> Markup {
    let rows: Vec<(bool, Vec<Markup>)> = summary
        .exchanges
        .iter()
        .map(|exchange| {
            (
                false,
                vec![
                    text(exchange.label.clone()),
                    text(exchange.rounds.len().to_string()),
                    code(&exchange.command),
                ],
            )
        })
        .collect();
    html! { div { (table(1, &["exchange", "rounds to rounding", "command"], &rows)) } }
}

/// Every run.
pub fn all(summary: &Summary) -> Markup {
    let mut on: Vec<&Row> = summary.runs.iter().collect();
    on.sort_by_key(|row| (kind(row), -(row.setting.element_size * 1e9) as i64));
    let rows: Vec<(bool, Vec<Markup>)> = on
        .into_iter()
        .map(|row| {
            let mark = if row.is_reference {
                " (the reference)"
            } else if row.is_default {
                " (the default)"
            } else {
                ""
            };
            (
                row.is_default,
                vec![
                    text(row.elements.to_string()),
                    text(seconds(row.seconds_solve)),
                    text(row.seconds_solve_cpu.map_or("–".into(), seconds)),
                    text(seconds(row.seconds_points)),
                    error(row.errors.elements),
                    error(row.errors.gathered),
                    text(bytes(row.bytes_stored as f64)),
                    text(row.bytes_peak.map_or("–".into(), |peak| bytes(peak as f64))),
                    text(row.rounds.to_string()),
                    html! { (row.label) (mark) },
                ],
            )
        })
        .collect();
    let head = [
        "elements",
        "solve",
        "solve, CPU",
        "gather",
        "error, elements",
        "error, points",
        "form factors",
        "peak memory",
        "rounds",
        "setting",
    ];
    html! { details { summary { (rows.len()) " runs" } (table(0, &head, &rows)) } }
}

fn kind(row: &Row) -> usize {
    match row.setting.kind {
        Kind::Parts { .. } | Kind::Verified { .. } => 0,
        Kind::Dense => 1,
        Kind::Rays(_) => 2,
        Kind::Progressive { .. } => 3,
    }
}
