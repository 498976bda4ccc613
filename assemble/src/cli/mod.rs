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
use assembly::AssemblyOptions;
use clap::{Parser, Subcommand};
use clap_complete::Shell;
use equilux_bake::cli::{program, progress};
use equilux_bake::monitor::Monitor;
use printed::printed_text;
use render::Render;
use std::process::ExitCode;

/// Assemble a scene from baked parts, exchange light between them until equilibrium, and write pictures and a report.
#[derive(Parser)]
#[command(name = "assemble", version, after_help = EXAMPLES)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Task>,
    #[command(flatten)]
    assembly: AssemblyOptions,
    /// Also print the paper's table of steps, all rounds, sums and sizes, and all notes
    #[arg(long)]
    verbose: bool,
    /// Explain for every part and block whether it was computed, reused or skipped, and why
    #[arg(long)]
    explain: bool,
    /// Choose element size and tolerance so that the error of light at points of surfaces, as in --lightmaps and
    /// --points, is at most this, as a root mean square relative to the mean: solves with ever finer elements until
    /// the light converges
    #[arg(long, value_name = "ERROR", value_parser = values::target_error, conflicts_with_all = ["element_size", "tolerance", "rays"])]
    target_error: Option<f64>,
    /// Assemble again whenever a file of the scene changes, until Ctrl-C; prints a line or two for each run
    #[arg(long)]
    watch: bool,
    /// Show the light of every round on a page in a browser on this machine, which can end the exchange early; on
    /// this port, or on any free port
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "0", value_parser = values::port)]
    live: Option<u16>,
}

/// Subcommands.
#[derive(Subcommand)]
enum Task {
    /// Dry run: show what would be computed, reused and skipped, and why
    Plan(AssemblyOptions),
    /// Draw the result from a camera: render.png, and its difference from a reference: error.png
    Render(Render),
    /// Try settings within a time budget and report error against run time
    Sweep(sweep::Arguments),
    /// Solve the scene with one matrix of all pairs of elements, or by progressive refinement, for comparison
    Classic(classic::Arguments),
    /// Print a shell completion script
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
  assemble scenes/cornell/cornell.glb --target-error 1%  settings that reach this error
  assemble render scenes/house/house.gltf              a picture from its camera
  assemble plan scenes/house/house.gltf                what would be computed, and why
  assemble scenes/house/house.gltf --lightmaps         with lightmaps for game engines
  assemble sweep scenes/house/house.gltf               error against run time, in out/house/sweep/
  assemble scenes/house/house.gltf --watch             again whenever one of its files is saved
  assemble scenes/house/house.gltf --live              with a page that shows every round
  assemble completions bash > /etc/bash_completion.d/assemble
Ctrl-C ends the exchange after the current round; all outputs are still written. During lightmaps it
cancels only these. A second Ctrl-C ends the program at once.";

/// Run the program.
pub fn main() -> ExitCode {
    program::run(|arguments| {
        program::print(&run(arguments)?)?;
        Ok(ExitCode::SUCCESS)
    })
}

/// Execute the command. Returns the text that is still to be printed.
fn run(arguments: Arguments) -> anyhow::Result<String> {
    match arguments.command {
        None => assemble(&arguments),
        Some(Task::Plan(assembly)) => {
            let plan = plan(&assembly.job())?;
            Ok(printed_text(assembly.options.json, &plan, Plan::text))
        }
        Some(Task::Render(render)) => {
            let AssemblyOptions { options, .. } = &render.assembly;
            options.set_threads()?;
            let invocation =
                Invocation { job: render.job(), target_error: None, live: None, json: options.json };
            once(&invocation, Report::outputs_text)
        }
        Some(Task::Sweep(arguments)) => {
            let summary = shown(|monitor| Ok(arguments.run(monitor)?))?;
            Ok(printed_text(arguments.json, &summary, |summary| arguments.text(summary)))
        }
        Some(Task::Classic(arguments)) => {
            let report = shown(|monitor| arguments.run(monitor))?;
            Ok(printed_text(arguments.json, &report, crate::classic::ClassicReport::text))
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

/// Run `work` with a progress display, until Ctrl-C.
fn shown<T>(work: impl FnOnce(&Monitor) -> anyhow::Result<T>) -> anyhow::Result<T> {
    let monitor = progress::monitor_for_program();
    let progress = progress::show(&monitor);
    let done = work(&monitor);
    progress.finish();
    done
}
