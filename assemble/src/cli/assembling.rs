//! Runs the commands that assemble a scene, with a progress display: once or repeatedly, with or without a live page.

use super::printed::printed_text;
use crate::equation::observer::Observer;
use crate::exchange::listener::Unobserved;
use crate::live::Live;
use crate::report::Report;
use crate::run::advice::advise;
use crate::run::job::Job;
use crate::run::run_observed;
use crate::run::watch::watch;
use equilux_bake::cli::program::{Unprinted, print, tell};
use equilux_bake::cli::progress;
use equilux_bake::monitor::Monitor;
use std::sync::Arc;

/// A parsed command that assembles a scene.
pub struct Invocation {
    /// The job.
    pub job: Job,
    /// The target error for which element size and tolerance are chosen, if given.
    pub target_error: Option<f64>,
    /// The port of the live page, 0 for any; none without a page.
    pub live: Option<u16>,
    /// Whether to print JSON.
    pub json: bool,
}

/// Assemble once. A live page is served until it is closed. Returns the text that is still to be printed.
pub fn once(invocation: &Invocation, text: impl Fn(&Report) -> String) -> anyhow::Result<String> {
    let monitor = progress::monitor_for_program();
    let live = invocation.live.map(|port| serve(port, false, &monitor)).transpose()?;
    let report = assemble(invocation, &monitor, live.as_ref())?;
    let text = printed_text(invocation.json, &report, text);
    let Some(live) = live.filter(|_| !monitor.stopped()) else { return Ok(text) };
    print(&text)?;
    tell(format_args!(
        "all outputs are written; the page remains at {} until Ctrl-C, or until it is closed there",
        live.url()
    ));
    live.stay();
    Ok(String::new())
}

/// Assemble whenever a file changes. Errors in the scene are printed, and watching continues.
pub fn watched(invocation: &Invocation) -> anyhow::Result<String> {
    let monitor = progress::monitor_for_program();
    let live = invocation.live.map(|port| serve(port, true, &monitor)).transpose()?;
    let (mut last_notes, mut printed) = (Vec::new(), Ok::<(), Unprinted>(()));
    watch(
        &invocation.job.scene,
        &invocation.job.beside().collect::<Vec<_>>(),
        &monitor,
        |why| match assemble(invocation, &monitor, live.as_ref()) {
            Ok(report) => {
                printed =
                    print(&printed_text(invocation.json, &report, |report| short(why, report, &last_notes)));
                if printed.is_err() {
                    monitor.stop();
                }
                last_notes = report.notes;
            }
            Err(error) => tell(format_args!("error: {error:#}")),
        },
    )?;
    printed?;
    Ok(String::new())
}

fn serve(port: u16, watched: bool, monitor: &Arc<Monitor>) -> anyhow::Result<Live> {
    let live = Live::start(port, watched, monitor)?;
    tell(format_args!("live page: {}", live.url()));
    Ok(live)
}

fn assemble(invocation: &Invocation, monitor: &Arc<Monitor>, live: Option<&Live>) -> anyhow::Result<Report> {
    let progress = progress::show(monitor);
    let report = advised(invocation, monitor, live.map_or(&Unobserved, Live::begin));
    progress.finish();
    if let Some(live) = live {
        live.end(report.as_ref().map_err(ToString::to_string));
    }
    Ok(report?)
}

fn advised(
    invocation: &Invocation,
    monitor: &Monitor,
    observer: &dyn Observer,
) -> equilux_formats::Result<Report> {
    let Some(target) = invocation.target_error else {
        return run_observed(&invocation.job, monitor, observer);
    };
    let (job, advice) = advise(&invocation.job, target, monitor)?;
    Ok(Report { advice: Some(advice), ..run_observed(&job, monitor, observer)? })
}

/// A short report in one line, with explanations and new notes.
fn short(why: &str, report: &Report, last_notes: &[String]) -> String {
    let baked = report.blocks.self_baked;
    let mut text = format!(
        "{why}: {baked} part{} baked, {} form factors computed, {} rounds, {:.2} s\n",
        if baked == 1 { "" } else { "s" },
        report.form_factors_computed,
        report.rounds.len(),
        report.seconds.total
    );
    let notes = report.notes.iter().filter(|note| !last_notes.contains(note));
    let lines = report.explained.iter().cloned().chain(notes.map(|note| format!("note: {note}")));
    lines.for_each(|line| text += &(line + "\n"));
    text
}
