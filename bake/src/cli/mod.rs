//! The command line of `bake`, and the options that `assemble` shares with it.

pub mod options;
pub mod progress;

use crate::batch::{Batch, PartOutcome, bake_files, find_scenes};
use crate::monitor::Monitor;
use clap::Parser;
use equilux_formats::Store;
use options::SceneOptions;
use std::path::PathBuf;
use std::process::ExitCode;

/// Turn glTF parts into exact form factors and their local light equilibrium, kept in a cache.
#[derive(Parser)]
#[command(name = "bake", version, after_help = EXAMPLES)]
struct Arguments {
    /// glTF files (.gltf, .glb), or folders that are searched for them
    #[arg(required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    options: SceneOptions,
    /// Say in a sentence for every part why it was or was not baked
    #[arg(long)]
    explain: bool,
}

const EXAMPLES: &str = "\
Examples:
  bake scenes/house                     every part file of a level
  bake hall.glb --element-size 0.25     elements of at most a quarter of a metre
  bake scenes/shadow/shadow.glb --bisect 2 --explain";

/// Run the program: 0 done, 1 something is wrong with an input or the environment, 2 the command line is.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let monitor = progress::monitor_for_program();
    let progress = progress::show(&monitor);
    let outcome = run(&arguments, &monitor);
    progress.finish();
    match outcome {
        Ok(batch) => {
            print(&arguments, &batch);
            ExitCode::from(u8::from(batch.files.iter().any(|file| file.error.is_some())))
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments, monitor: &Monitor) -> anyhow::Result<Batch> {
    arguments.options.set_threads()?;
    let files = find_scenes(&arguments.inputs)?;
    let store = Store::open(&arguments.options.cache)?;
    Ok(bake_files(&files, &arguments.options.preparation(), &store, monitor))
}

fn print(arguments: &Arguments, batch: &Batch) {
    for file in &batch.files {
        if let Some(error) = &file.error {
            eprintln!("error: {error}");
        }
        if !arguments.options.json {
            file.notes.iter().for_each(|note| eprintln!("note: {note}"));
        }
    }
    if arguments.options.json {
        println!("{}", serde_json::to_string(batch).expect("a batch is plain data"));
        return;
    }
    for file in &batch.files {
        for part in &file.parts {
            println!("{}", line(&file.file, part));
            if arguments.explain {
                println!("    form factors {}", part.form_factors_reason);
                println!("    light {}", part.light_reason);
            }
        }
    }
    println!(
        "{} parts in {} files: {} baked, {} reused; {:.2} s; cache {}",
        batch.parts(),
        batch.files.len(),
        batch.baked(),
        batch.parts() - batch.baked(),
        batch.seconds,
        arguments.options.cache.display()
    );
}

fn line(file: &str, part: &PartOutcome) -> String {
    format!(
        "{file}: {}: {} elements ({}), {} form factors, row sums at most {:.1e} from 1, {}",
        part.name,
        part.elements,
        part.element_size,
        part.stored,
        part.row_sum_defect.max,
        if part.baked { format!("baked in {:.2} s", part.seconds) } else { "reused".into() }
    )
}
