//! The command line of `assemble`.

mod assembling;
pub(crate) mod assembly;
mod classic;
mod printed;
mod render;
mod sweep;
pub(crate) mod values;

use crate::outputs::requests::OutputRequests;
use crate::report::Report;
use crate::run::job::Job;
use crate::run::plan::{Plan, plan};
use assembling::{Invocation, once, watched};
use assembly::Assembly;
use clap::{Parser, Subcommand};
use clap_complete::Shell;
use equilux_bake::cli::{program, progress};
use equilux_bake::monitor::Monitor;
use printed::said;
use render::Render;
use std::process::ExitCode;

/// Assemble a scene from baked parts, let them exchange light until equilibrium, and write pictures and a report.
#[derive(Parser)]
#[command(name = "assemble", version, after_help = EXAMPLES)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Task>,
    #[command(flatten)]
    assembly: Assembly,
    /// Also print the paper's table of steps, all rounds, sums and sizes, and all notes
    #[arg(long)]
    verbose: bool,
    /// Say in a sentence for every part and block whether it was computed, reused or left out, and why
    #[arg(long)]
    explain: bool,
    /// Choose element size and tolerance so that light at points of surfaces, as --lightmaps and --points have it, is off by no
    /// more than this, as a root mean square over the mean: solves with finer and finer elements until it stays
    #[arg(long, value_name = "ERROR", value_parser = values::target_error, conflicts_with_all = ["element_size", "tolerance"])]
    target_error: Option<f64>,
    /// Assemble again whenever a file of the scene changes, until Ctrl-C; a line or two a run
    #[arg(long)]
    watch: bool,
    /// Show the light of every round on a page in a browser on this machine, which can end the exchange when it is good
    /// enough; at this port, or any that is free
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "0", value_parser = values::port)]
    live: Option<u16>,
}

/// What to do other than assemble.
#[derive(Subcommand)]
enum Task {
    /// Say what the same command without `plan` would compute, reuse and leave out, and why
    Plan(Assembly),
    /// Draw the result from a camera: render.png, and how far it is from a reference: error.png
    Render(Render),
    /// Try settings for a while and report error against run time
    Sweep(sweep::Arguments),
    /// Solve the scene with one matrix of all pairs of elements, or by progressive refinement: what to compare with
    Classic(classic::Arguments),
    /// Print what makes a shell complete this program's options
    Completions {
        /// The shell
        shell: Shell,
    },
}

const EXAMPLES: &str = "\
Examples:
  assemble scenes/shadow/shadow.glb                    pictures of its rounds in out/shadow/
  assemble scenes/house/house.gltf --element-size 0.3  a level from part files
  assemble scenes/wood/wood.glb --bisect 8 --verify    parts by planes, compared with the whole
  assemble scenes/cornell/cornell.glb --target-error 1%  settings that are as exact as that
  assemble render scenes/house/house.gltf              a picture from its camera
  assemble plan scenes/house/house.gltf                what would be computed, and why
  assemble scenes/house/house.gltf --lightmaps         with lightmaps for game engines
  assemble sweep scenes/house/house.gltf               error against run time, in out/house/sweep/
  assemble scenes/house/house.gltf --watch             again whenever one of its files is saved
  assemble scenes/house/house.gltf --live              with a page that shows every round
  assemble completions bash > /etc/bash_completion.d/assemble
Ctrl-C ends the exchange after the current round; everything is still written. Later it ends lightmaps, and\nonly they are not. A second one ends the program at once.";

/// Run the program.
pub fn main() -> ExitCode {
    program::run(|arguments| {
        program::print(&run(arguments)?)?;
        Ok(ExitCode::SUCCESS)
    })
}

/// Do what is asked for; returns what is left to print.
fn run(arguments: Arguments) -> anyhow::Result<String> {
    match arguments.command {
        None => assemble(&arguments),
        Some(Task::Plan(assembly)) => {
            let plan = plan(&assembly.job())?;
            Ok(said(assembly.options.json, &plan, Plan::text))
        }
        Some(Task::Render(render)) => {
            let Assembly { options, .. } = &render.assembly;
            options.set_threads()?;
            let invocation =
                Invocation { job: render.job(), target_error: None, live: None, json: options.json };
            once(&invocation, Report::outputs_text)
        }
        Some(Task::Sweep(arguments)) => {
            let summary = shown(|monitor| Ok(arguments.run(monitor)?))?;
            Ok(said(arguments.json, &summary, |summary| arguments.text(summary)))
        }
        Some(Task::Classic(arguments)) => {
            let report = shown(|monitor| arguments.run(monitor))?;
            Ok(said(arguments.json, &report, crate::classic::ClassicReport::text))
        }
        Some(Task::Completions { shell }) => Ok(program::completions::<Arguments>(shell, "assemble")),
    }
}

fn assemble(arguments: &Arguments) -> anyhow::Result<String> {
    let Arguments { assembly, verbose, explain, target_error, live, .. } = arguments;
    assembly.options.set_threads()?;
    let job = assembly.job();
    let job = Job { outputs: OutputRequests { explain: *explain, ..job.outputs }, ..job };
    let invocation =
        Invocation { job, target_error: *target_error, live: *live, json: assembly.options.json };
    if arguments.watch {
        watched(&invocation)
    } else {
        once(&invocation, if *verbose { Report::details } else { Report::text })
    }
}

/// Do something with progress shown, until Ctrl-C.
fn shown<T>(work: impl FnOnce(&Monitor) -> anyhow::Result<T>) -> anyhow::Result<T> {
    let monitor = progress::monitor_for_program();
    let progress = progress::show(&monitor);
    let done = work(&monitor);
    progress.finish();
    done
}
