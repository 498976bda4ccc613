//! `report.html`: the summary of a sweep for people. One file that loads nothing from outside it. A section without
//! content is left out.

mod axis;
mod chart;
mod mark;
mod plots;
mod tables;

use super::numbers::{percent, seconds};
use super::row::Row;
use super::summary::Summary;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The page.
pub fn page(summary: &Summary) -> String {
    let title = format!("{}: error against run time", summary.scene);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                h1 { (title) }
                (overview(summary))
                (results(summary))
                (explanations(summary))
                (remarks(summary))
            }
        }
    }
    .into_string()
}

fn overview(summary: &Summary) -> Markup {
    let compared = &summary.reference;
    let runs = summary.runs.len() + summary.exchanges.len();
    html! {
        p.lead { (cheapest_sentence(summary)) }
        p {
            "Each of the " (runs) " runs was a process of its own with an empty cache. "
            "Its light is compared with the reference, " (compared.what) ", at " (compared.points) " points. "
            "An error is the root mean square difference over area, divided by the mean, of the worst colour channel. "
            @match compared.own_error {
                Some(own) if compared.setting.is_some() => {
                    "The reference itself may be off by about " (percent(own)) ", its difference from the next coarser exact run."
                }
                Some(own) => {
                    "The noise of the reference, " (percent(own)) ", is subtracted; errors below " (percent(compared.resolves)) " cannot be told from zero."
                }
                None => "The error of the reference itself is unknown: there is no coarser run to compare it with."
            }
        }
        @if let Some(table) = tables::cheapest(summary) { (table) }
    }
}

/// The time that the target errors take, and what the default settings give.
fn cheapest_sentence(summary: &Summary) -> String {
    let known = summary.cheapest.iter().filter_map(|c| Some((c.error, &summary.runs[c.gathered?])));
    let parts: Vec<String> =
        known.map(|(error, row)| format!("{} takes {}", percent(error), time_of(row))).collect();
    let default = summary.runs.iter().find(|row| row.is_default);
    let default = default.map_or(String::new(), |row| {
        format!(
            " The default settings, elements of {} m, take {} with an error of {} at points; one value an element has an error of {}.",
            summary.default_element_size,
            time_of(row),
            percent(row.errors.gathered),
            percent(row.errors.elements)
        )
    });
    match parts.as_slice() {
        [] => format!("No run came within 5 % of the reference.{default}"),
        parts => {
            let clock = summary.runs.first().map_or("time", Row::clock);
            format!("Light at points, in {clock}: an error of {}.{default}", parts.join(", of "))
        }
    }
}

fn time_of(row: &Row) -> String {
    seconds(row.gathered().0)
}

/// A section, unless it has no content.
fn section(title: &str, text: &str, content: Option<Markup>) -> Markup {
    html! {
        @if let Some(content) = content {
            h2 { (title) }
            @if !text.is_empty() { p.quiet { (text) } }
            (content)
        }
    }
}

fn side_by_side(charts: Vec<Markup>) -> Option<Markup> {
    (!charts.is_empty()).then(|| html! { div.charts { @for chart in charts { (chart) } } })
}

fn results(summary: &Summary) -> Markup {
    let findings = (!summary.findings.is_empty())
        .then(|| html! { ul { @for finding in &summary.findings { li { (finding) } } } });
    html! {
        (section(
            "Error against time",
            "Lower left is better; both axes are logarithmic. Lines join runs that differ in element size alone. Point at a mark to see its command.",
            side_by_side(plots::against_seconds(summary)),
        ))
        (section(
            "The best settings",
            "Of the settings of Equilux tried, no other is both quicker and more accurate.",
            tables::front(summary),
        ))
        (section("What the scene needed", "", findings))
        (section("Error against memory", "", side_by_side(plots::against_bytes(summary))))
    }
}

fn explanations(summary: &Summary) -> Markup {
    let rounds = plots::round_by_round(&summary.exchanges)
        .map(|chart| html! { div.charts { (chart) div { @if let Some(table) = tables::exchanges(summary) { (table) } } } });
    html! {
        (section(
            "Where errors come from",
            "Discretisation: an exact run against the reference. Compression: a run with a tolerance against the exact run on the same elements. Iteration: an exchange that ends early against one that does not.",
            tables::separated(summary),
        ))
        (section(
            "Round by round",
            "The error that the exchange proves after each round, and its true error: the largest difference from the solution of the classic matrix on the same elements.",
            rounds,
        ))
        (section(
            "Steps of the paper, seconds",
            "1, 2: form factors inside the first part and inside the others; 3, 4: between them; 5, 6: local equilibrium; 7, 8: transfer. Steps 1 to 4 are summed over threads. T₁ is one step after the other, T₂ with parts side by side, T₃ with all of steps 1 to 4 side by side.",
            tables::steps(summary),
        ))
        (section("All runs", "", tables::all(summary)))
    }
}

fn remarks(summary: &Summary) -> Markup {
    html! {
        @if !summary.skipped.is_empty() {
            details {
                summary { (summary.skipped.len()) " settings were not run" }
                ul { @for line in &summary.skipped { li { (line) } } }
            }
        }
        p.quiet {
            "This sweep took " (seconds(summary.seconds)) " by the clock; " (summary.reused) " runs were kept from an earlier one. "
            "CPU time is that of all threads together. "
            "The classic methods use the same elements: a dense matrix of 64-bit numbers, exact or with rays from each centroid to points spread evenly on each sender, or progressive refinement without a matrix. "
            "sweep.csv and sweep.json beside this page hold all numbers."
        }
    }
}
