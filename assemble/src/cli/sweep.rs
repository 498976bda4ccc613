//! The command line of `assemble sweep`.

use crate::cli::values;
use crate::sweep::numbers::{percent, seconds};
use crate::sweep::summary::Summary;
use crate::sweep::{Options, sweep};
use clap::Args;
use equilux_bake::monitor::Monitor;
use equilux_formats::Result;
use std::path::PathBuf;
use std::time::Duration;

/// A scene, and the time budget for trials.
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// The scene, a .gltf or .glb file, or a folder with one
    #[arg(value_parser = values::scene)]
    scene: PathBuf,
    /// Reference light, a table as described in scenes/README.md [default: the finest run within a third of the
    /// budget]
    #[arg(long, value_name = "FILE.csv")]
    truth: Option<PathBuf>,
    /// Time for all runs, seconds; settings that would exceed it are skipped
    #[arg(long, value_name = "SECONDS", default_value = "300", value_parser = budget)]
    budget: Duration,
    /// Folder for the outputs, written to DIR/SCENE/sweep/: report.html, sweep.csv, sweep.json, and the result of
    /// each run
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Print one JSON object on stdout and nothing else
    #[arg(long)]
    pub json: bool,
    /// Options for every run, such as `-- --sky 0.5`
    #[arg(last = true, value_name = "OPTIONS")]
    more: Vec<String>,
}

const EXAMPLES: &str = "\
Examples:
  assemble sweep scenes/shadow/shadow.glb --truth scenes/shadow/truth.csv
  assemble sweep scenes/house/house.gltf --budget 120
  assemble sweep hall.glb -- --sky 0.5
Ctrl-C ends the sweep and writes the report of the complete runs. The same command continues it.";

impl Arguments {
    /// Run the sweep.
    pub fn run(&self, monitor: &Monitor) -> Result<Summary> {
        let options = Options {
            scene: self.scene.clone(),
            truth: self.truth.clone(),
            budget: self.budget,
            out: self.out.clone(),
            more: self.more.clone(),
        };
        sweep(&options, monitor)
    }

    /// The results in a few lines.
    pub fn text(&self, summary: &Summary) -> String {
        let mut text = format!(
            "{}: {} runs ({} kept from before) in {}, {} settings skipped\n",
            summary.scene,
            summary.runs.len() + summary.exchanges.len(),
            summary.reused,
            seconds(summary.seconds),
            summary.skipped.len()
        );
        for target in &summary.cheapest {
            let error = percent(target.error);
            text += &match target.gathered.map(|row| &summary.runs[row]) {
                Some(row) => {
                    let time = seconds(row.gathered().0);
                    format!("  error at points {error}: {time} of {}  {}\n", row.clock(), row.command)
                }
                None => format!("  error at points {error}: not reached by any setting tried\n"),
            };
        }
        summary.findings.iter().for_each(|finding| text += &format!("  {finding}\n"));
        text + &format!("{}\n", self.out.join(&summary.scene).join("sweep").join("report.html").display())
    }
}

fn budget(text: &str) -> std::result::Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| *seconds > 0.0);
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| "a budget is a number of seconds above zero".into())
}
