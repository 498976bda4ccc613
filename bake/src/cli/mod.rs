//! The command line of `bake`, and the options that `assemble` shares with it.

pub mod length;
pub mod options;
pub mod program;
pub mod progress;

mod size;

use crate::monitor::Monitor;
use crate::oven::batch::{Batch, PartOutcome, bake_files, find_scenes};
use crate::oven::keys::drop_unused;
use crate::oven::{depfile, stamp};
use clap::{Parser, Subcommand};
use clap_complete::Shell;
use equilux_formats::Store;
use equilux_formats::store::Evicted;
use indicatif::DecimalBytes;
use options::SceneOptions;
use program::tell;
use serde::Serialize;
use size::count;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Turn glTF parts into exact form factors and their local light equilibrium, kept in a cache.
#[derive(Parser)]
#[command(name = "bake", version, after_help = EXAMPLES)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Task>,
    /// glTF files (.gltf, .glb), or folders that are searched for them
    #[arg(required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    options: SceneOptions,
    /// Print for every part why it was or was not baked
    #[arg(long)]
    explain: bool,
    /// Touch this file when everything is baked, for build tools
    #[arg(long, value_name = "FILE")]
    stamp: Option<PathBuf>,
    /// Write the files that were read as dependencies of the stamp, for Make, Ninja or CMake
    #[arg(long, value_name = "FILE", requires = "stamp")]
    depfile: Option<PathBuf>,
    /// Bake nothing; remove from the cache what these scenes, with these options, do not use. Results for other scenes
    /// or options are removed too
    #[arg(long, conflicts_with_all = ["explain", "stamp", "cache_limit"])]
    gc: bool,
}

/// Subcommands.
#[derive(Subcommand)]
enum Task {
    /// Print a shell completion script
    Completions {
        /// The shell
        shell: Shell,
    },
}

const EXAMPLES: &str = "\
Examples:
  bake scenes/house                     every part file of a level
  bake hall.glb --element-size 0.25     elements of at most a quarter of a metre
  bake scenes/shadow/shadow.glb --bisect 2 --explain
  bake scenes/house --stamp house.stamp --depfile house.d
  bake scenes/house scenes/cornell --gc --cache .equilux";

/// Run the program.
pub fn main() -> ExitCode {
    program::run(work)
}

fn work(arguments: Arguments) -> anyhow::Result<ExitCode> {
    if let Some(Task::Completions { shell }) = arguments.command {
        program::print(&program::completions::<Arguments>(shell, "bake"))?;
        return Ok(ExitCode::SUCCESS);
    }
    let monitor = progress::monitor_for_program();
    let progress = progress::show(&monitor);
    let outcome = run(&arguments, &monitor);
    progress.finish();
    let done = outcome?;
    print(&arguments, &done)?;
    Ok(ExitCode::from(u8::from(matches!(&done, Done::Baked(batch) if batch.failed()))))
}

/// The result of a run.
#[derive(Serialize)]
#[serde(untagged)]
enum Done {
    Baked(Batch),
    Evicted(Evicted),
}

fn run(arguments: &Arguments, monitor: &Monitor) -> anyhow::Result<Done> {
    let options = &arguments.options;
    options.set_threads()?;
    let files = find_scenes(&arguments.inputs)?;
    [&arguments.stamp, &arguments.depfile].into_iter().flatten().try_for_each(|path| stamp::check(path))?;
    let store = Store::open(&options.cache)?;
    if arguments.gc {
        return Ok(Done::Evicted(drop_unused(&files, &options.preparation(), &store)?));
    }
    let mut batch = bake_files(&files, &options.preparation(), &store, monitor);
    batch.evicted = options.cache_limit.map(|bytes| store.limit(bytes)).transpose()?;
    if let Some(stamp) = arguments.stamp.as_ref().filter(|_| !batch.failed()) {
        if let Some(path) = &arguments.depfile {
            depfile::write(path, stamp, &batch.sources())?;
        }
        stamp::touch(stamp)?;
    }
    Ok(Done::Baked(batch))
}

fn print(arguments: &Arguments, done: &Done) -> Result<(), program::Unprinted> {
    if let Done::Baked(batch) = done {
        print_problems(batch, !arguments.options.json);
    }
    program::print(&match done {
        done if arguments.options.json => serde_json::to_string(done).expect("a batch is plain data") + "\n",
        Done::Baked(batch) => batch_text(arguments, batch),
        Done::Evicted(evicted) => eviction_line(&arguments.options.cache, evicted),
    })
}

fn print_problems(batch: &Batch, with_notes: bool) {
    for file in &batch.files {
        if let Some(error) = &file.error {
            tell(format_args!("error: {error}"));
        }
        if with_notes {
            file.notes.iter().for_each(|note| tell(format_args!("note: {note}")));
        }
    }
}

fn batch_text(arguments: &Arguments, batch: &Batch) -> String {
    let (cache, mut text) = (&arguments.options.cache, String::new());
    for file in &batch.files {
        for part in &file.parts {
            text += &line(&file.file, part);
            if arguments.explain {
                text += &format!("    form factors {}\n", part.form_factors_reason);
                text += &format!("    light {}\n", part.light_reason);
            }
        }
    }
    if let Some(evicted) = &batch.evicted {
        text += &eviction_line(cache, evicted);
    }
    text + &format!(
        "{} in {}: {} baked, {} reused; {:.2} s; cache {}\n",
        count(batch.parts(), "part"),
        count(batch.files.len(), "file"),
        batch.baked(),
        batch.parts() - batch.baked(),
        batch.seconds,
        cache.display()
    )
}

fn eviction_line(cache: &Path, evicted: &Evicted) -> String {
    let [dropped, kept] = [evicted.dropped, evicted.kept]
        .map(|tally| format!("{} ({})", count(tally.files, "file"), DecimalBytes(tally.bytes)));
    format!("cache {}: dropped {dropped}, kept {kept}\n", cache.display())
}

fn line(file: &str, part: &PartOutcome) -> String {
    format!(
        "{file}: {}: {} elements ({}), {} form factors, row sums at most {:.1e} from 1, {}\n",
        part.name,
        part.elements,
        part.element_size,
        part.stored,
        part.row_sum_defect.max,
        if part.baked { format!("baked in {:.2} s", part.seconds) } else { "reused".into() }
    )
}
