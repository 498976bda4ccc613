//! The tables of the page. None of them is drawn where it would have no rows.

use crate::sweep::numbers::{bytes, percent, seconds};
use crate::sweep::row::Row;
use crate::sweep::separation::Source;
use crate::sweep::setting::Kind;
use crate::sweep::summary::Summary;
use maud::{Markup, html};

/// How a table fits into a narrow window.
#[derive(Debug, Clone, Copy)]
enum Narrow {
    /// Each row is a block of labelled lines.
    Blocks,
    /// It scrolls sideways in its own frame.
    Scroll,
}

/// A line of a table.
struct Line {
    /// Whether it stands out: it is of the default settings.
    is_default: bool,
    cells: Vec<Markup>,
}

/// A table; the first columns, as many as `left`, are aligned left, as is the last. None if it has no lines.
fn table(narrow: Narrow, left: usize, head: &[&str], lines: &[Line]) -> Option<Markup> {
    let is_left = |k: usize| k < left || k + 1 == head.len();
    let class = match narrow {
        Narrow::Blocks => "blocks",
        Narrow::Scroll => "scroll",
    };
    (!lines.is_empty()).then(|| html! {
        div class=(class) {
            table {
                thead { tr { @for (k, title) in head.iter().enumerate() { th.left[is_left(k)] { (title) } } } }
                tbody {
                    @for line in lines {
                        tr.chosen[line.is_default] {
                            @for (k, cell) in line.cells.iter().enumerate() {
                                td.left[is_left(k)] data-label=(head[k]) { (cell) }
                            }
                        }
                    }
                }
            }
        }
    })
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
pub fn cheapest(summary: &Summary) -> Option<Markup> {
    let mut lines = vec![];
    for target in &summary.cheapest {
        let gathered = target.gathered.map(|row| ("points", row, summary.runs[row].gathered()));
        let flat = target.elements.map(|row| ("elements", row, summary.runs[row].flat()));
        for (what, row, (time, own_error)) in [gathered, flat].into_iter().flatten() {
            let row = &summary.runs[row];
            let cells = vec![
                error(target.error),
                text(what),
                text(seconds(time)),
                error(own_error),
                text(row.elements.to_string()),
                code(&row.command),
            ];
            lines.push(Line { is_default: false, cells });
        }
    }
    let clock = summary.runs.first().map_or("time", Row::clock);
    table(
        Narrow::Blocks,
        2,
        &["error at most", "of light at", clock, "its error", "elements", "command"],
        &lines,
    )
}

/// The settings that no other beats.
pub fn front(summary: &Summary) -> Option<Markup> {
    let mut on: Vec<&Row> =
        summary.runs.iter().filter(|row| row.on_gathered_front || row.on_elements_front).collect();
    on.sort_by(|a, b| a.flat().0.total_cmp(&b.flat().0));
    let fronts = |row: &Row| match (row.on_gathered_front, row.on_elements_front) {
        (true, true) => "both",
        (true, false) => "points",
        _ => "elements",
    };
    let line = |row: &Row| Line {
        is_default: row.is_default,
        cells: vec![
            text(fronts(row)),
            text(row.elements.to_string()),
            text(seconds(row.flat().0)),
            text(seconds(row.gathered().0 - row.flat().0)),
            error(row.errors.elements),
            error(row.errors.gathered),
            text(bytes(row.bytes_stored as f64)),
            code(&row.command),
        ],
    };
    let lines: Vec<Line> = on.into_iter().map(line).collect();
    let head = [
        "best for",
        "elements",
        "solve",
        "gather",
        "error, elements",
        "error, points",
        "form factors",
        "command",
    ];
    table(Narrow::Blocks, 1, &head, &lines)
}

/// Errors by where they come from.
pub fn separated(summary: &Summary) -> Option<Markup> {
    let name = |from| match from {
        Source::Discretisation => "discretisation",
        Source::Compression => "compression",
        Source::Iteration => "iteration",
    };
    let line = |row: &crate::sweep::separation::Separated| Line {
        is_default: false,
        cells: vec![
            text(name(row.from)),
            text(row.elements.to_string()),
            error(row.errors.elements),
            error(row.errors.gathered),
            text(row.choice.clone()),
        ],
    };
    let lines: Vec<Line> = summary.separated.iter().map(line).collect();
    table(Narrow::Blocks, 1, &["source", "elements", "error, elements", "error, points", "setting"], &lines)
}

/// The paper's steps, of the runs with elements of the default size that differ in how parts are made and exchange light.
pub fn steps(summary: &Summary) -> Option<Markup> {
    let shown = |row: &&Row| {
        let options = ["--exchange jacobi", "--bisect 2", "--bisect 8", ""];
        row.setting.is_ours()
            && options.contains(&row.setting.more.join(" ").as_str())
            && (row.setting.element_size == summary.default_element_size)
    };
    let number = |value: f64| text(if value == 0.0 { "0".into() } else { format!("{value:.3}") });
    let line = |row: &Row| {
        let s = &row.steps;
        let mut cells = vec![text(row.elements.to_string())];
        let steps =
            [s.step1, s.step2, s.step3, s.step4, s.step5, s.step6, s.step7, s.step8, s.t1, s.t2, s.t3];
        cells.extend(steps.map(number));
        cells.push(text(row.label.clone()));
        Line { is_default: row.is_default, cells }
    };
    let lines: Vec<Line> = summary.runs.iter().filter(shown).map(line).collect();
    let head = ["elements", "1", "2", "3", "4", "5", "6", "7", "8", "T₁", "T₂", "T₃", "setting"];
    table(Narrow::Scroll, 0, &head, &lines)
}

/// The runs of the chart of rounds.
pub fn exchanges(summary: &Summary) -> Option<Markup> {
    let line = |exchange: &crate::sweep::summary::Exchange| Line {
        is_default: false,
        cells: vec![
            text(exchange.label.clone()),
            text(exchange.rounds.len().to_string()),
            code(&exchange.command),
        ],
    };
    let lines: Vec<Line> = summary.exchanges.iter().map(line).collect();
    table(Narrow::Blocks, 1, &["exchange", "rounds until rounding", "command"], &lines)
}

/// Every run, in a section that opens on demand.
pub fn all(summary: &Summary) -> Option<Markup> {
    let mut rows: Vec<&Row> = summary.runs.iter().collect();
    rows.sort_by_key(|row| (order(row), -(row.setting.element_size * 1e9) as i64));
    let time = |seconds_of: Option<f64>| text(seconds_of.map_or("–".into(), seconds));
    let line = |row: &Row| {
        let mark = match (row.is_reference, row.is_default) {
            (true, _) => " (the reference)",
            (_, true) => " (the default settings)",
            _ => "",
        };
        let cells = vec![
            text(row.elements.to_string()),
            text(seconds(row.seconds_solve)),
            time(row.seconds_solve_cpu),
            text(seconds(row.seconds_points)),
            time(row.seconds_points_cpu),
            error(row.errors.elements),
            error(row.errors.gathered),
            text(bytes(row.bytes_stored as f64)),
            text(row.bytes_peak.map_or("–".into(), |peak| bytes(peak as f64))),
            text(row.rounds.to_string()),
            html! { (row.label) (mark) },
        ];
        Line { is_default: row.is_default, cells }
    };
    let lines: Vec<Line> = rows.into_iter().map(line).collect();
    let head = [
        "elements",
        "solve, wall",
        "solve, CPU",
        "gather, wall",
        "gather, CPU",
        "error, elements",
        "error, points",
        "form factors",
        "peak memory",
        "rounds",
        "setting",
    ];
    let table = table(Narrow::Scroll, 0, &head, &lines)?;
    Some(html! { details { summary { (lines.len()) " runs" } (table) } })
}

/// Runs of parts first, then the classic methods.
fn order(row: &Row) -> usize {
    match row.setting.kind {
        Kind::Parts { .. } | Kind::Verified { .. } => 0,
        Kind::Dense => 1,
        Kind::Rays(_) => 2,
        Kind::Progressive { .. } => 3,
    }
}
