//! `report.html`: what a sweep found, for people. One file that asks for nothing outside it.

mod chart;
mod plots;
mod tables;

use super::findings::{percent, seconds};
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
                (said_first(summary))
                (body(summary))
            }
        }
    }
    .into_string()
}

fn said_first(summary: &Summary) -> Markup {
    let compared = &summary.reference;
    html! {
        p.lead { (cheapest_sentence(summary)) }
        p {
            "Each of the " (summary.runs.len() + summary.exchanges.len()) " runs was a process of its own that began with an empty cache. "
            "Their light is compared at " (compared.points) " points with " (compared.what) ". "
            "An error is the root of the mean square over area, divided by the mean, of the worst colour; "
            @match compared.own_error {
                Some(own) if compared.setting.is_some() => {
                    "the reference itself may err by about " (percent(own)) ", which is how much the next coarser exact run differs from it."
                }
                Some(own) => {
                    "the noise of the reference, " (percent(own)) ", is taken out of it, which leaves chance below " (percent(compared.resolves)) "."
                }
                None => "how much the reference itself errs is unknown, for there is no coarser run to compare it with."
            }
        }
        (tables::cheapest(summary))
    }
}

/// `1 % takes 0.4 s …`
fn cheapest_sentence(summary: &Summary) -> String {
    let row = |number: usize| &summary.runs[number];
    let known = summary.cheapest.iter().filter_map(|c| Some((c.error, row(c.gathered?))));
    let parts: Vec<String> = known
        .map(|(error, row)| {
            let elements = row.elements;
            format!("{} takes {} ({elements} elements)", percent(error), time_of(row))
        })
        .collect();
    let default = summary.runs.iter().find(|row| row.is_default);
    let default = default.map_or(String::new(), |row| {
        format!(
            " The default, elements of {} m, takes {} and errs by {} at points, flat elements by {}.",
            summary.default_element_size,
            time_of(row),
            percent(row.errors.gathered),
            percent(row.errors.elements)
        )
    });
    match parts.as_slice() {
        [] => format!("No run came within 5 % of the reference.{default}"),
        parts => format!(
            "Light that is gathered at points as lightmaps do: an error of {}.{default}",
            parts.join(", of ")
        ),
    }
}

fn time_of(row: &Row) -> String {
    seconds(row.seconds_solve + row.seconds_points)
}

fn body(summary: &Summary) -> Markup {
    html! {
        h2 { "Error against seconds" }
        p.quiet { "Lines join runs that differ in element size alone. Point at a mark to see its command. Both axes are logarithmic: down and left is better." }
        div.charts { @for chart in plots::against_seconds(summary) { (chart) } }
        h2 { "The front" }
        p { "No other setting of Equilux that was tried is both quicker and nearer to the reference." }
        (tables::front(summary))
        h2 { "What the scene did and did not need" }
        ul { @for finding in &summary.findings { li { (finding) } } }
        h2 { "Error against bytes" }
        div.charts { @for chart in plots::against_bytes(summary) { (chart) } }
        h2 { "Where errors come from" }
        p { "Discretisation: exact runs against the reference. Compression: a run with a tolerance against the exact run on the same elements. Iteration: an exchange that ends early against one that does not." }
        (tables::separated(summary))
        h2 { "Round by round" }
        p { "What an exchange proves after each round, and how far it then is from the classic matrix's solution on the same elements." }
        div.charts { (plots::round_by_round(&summary.exchanges)) (tables::exchanges(summary)) }
        h2 { "Steps, seconds" }
        p { "1, 2: form factors inside the first part and the others; 3, 4: between them; 5, 6: equilibrium inside; 7, 8: transfer. T₁ does one after the other, T₂ has parts side by side, T₃ all of 1–4. Those of 1–4 are summed over threads." }
        (tables::steps(summary))
        h2 { "All runs" }
        (tables::all(summary))
        @if !summary.skipped.is_empty() {
            details {
                summary { (summary.skipped.len()) " settings were left out" }
                ul { @for line in &summary.skipped { li { (line) } } }
            }
        }
        p.quiet {
            "This sweep took " (seconds(summary.seconds)) "; " (summary.reused) " runs were there from before. Seconds are wall time on the machine as it was. "
            "The classic runs use the same elements: one dense matrix in 64-bit numbers, exact or with rays from each centroid to points spread evenly on each sender, or progressive refinement without a matrix. sweep.csv and sweep.json beside this page hold all numbers."
        }
    }
}
