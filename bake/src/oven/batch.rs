//! Bakes many files one after the other. A faulty file does not prevent the others from being baked.

use crate::gltf_import::{import_scene, is_gltf};
use crate::monitor::Monitor;
use crate::oven::prepare::PreparedPart;
use crate::oven::prepare::{Preparation, Prepared, prepare};
use crate::oven::{Baked, Oven};
use equilux_formats::rows::RowSumDefect;
use equilux_formats::store::Evicted;
use equilux_formats::{Error, Problem, Result, Store, unless_stopped};
use serde::Serialize;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::Instant;
use walkdir::WalkDir;

/// The outcome of a batch.
#[derive(Debug, Serialize)]
pub struct Batch {
    /// One entry a file, in the order of the inputs.
    pub files: Vec<FileOutcome>,
    /// Wall time.
    pub seconds: f64,
    /// The files evicted from the cache, if it has a size limit; `swept` in JSON.
    #[serde(rename = "swept")]
    pub evicted: Option<Evicted>,
}

/// The outcome of one file.
#[derive(Debug, Serialize)]
pub struct FileOutcome {
    /// The file.
    pub file: String,
    /// Its distinct parts.
    pub parts: Vec<PartOutcome>,
    /// What was ignored, dropped or repaired.
    pub notes: Vec<String>,
    /// Why the file could not be baked.
    pub error: Option<String>,
    /// Every file that was read for it.
    #[serde(skip)]
    pub sources: Vec<PathBuf>,
}

/// The outcome of one part.
#[derive(Debug, Serialize)]
pub struct PartOutcome {
    /// Its name.
    pub name: String,
    /// Number of elements.
    pub elements: usize,
    /// Element size in force.
    pub element_size: String,
    /// Whether its form factors were computed now.
    pub baked: bool,
    /// Why they were or were not.
    pub form_factors_reason: String,
    /// Why its light was or was not computed.
    pub light_reason: String,
    /// Form factors stored.
    pub stored: usize,
    /// How far its row sums are from 1: zero if the part is closed on its own.
    pub row_sum_defect: RowSumDefect,
    /// Wall time.
    pub seconds: f64,
}

impl Batch {
    /// Number of parts in all files.
    pub fn parts(&self) -> usize {
        self.files.iter().map(|file| file.parts.len()).sum()
    }

    /// Number of parts whose form factors were computed.
    pub fn baked(&self) -> usize {
        self.files.iter().flat_map(|file| &file.parts).filter(|part| part.baked).count()
    }

    /// Whether a file could not be baked.
    pub fn failed(&self) -> bool {
        self.files.iter().any(|file| file.error.is_some())
    }

    /// Every file that was read, once.
    pub fn sources(&self) -> Vec<PathBuf> {
        let mut known = HashSet::new();
        self.files.iter().flat_map(|file| &file.sources).filter(|path| known.insert(*path)).cloned().collect()
    }
}

/// The glTF files among `inputs` and in the folders among them, sorted within each folder.
pub fn find_scenes(inputs: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for input in inputs {
        if !input.is_dir() {
            files.push(input.clone());
            continue;
        }
        let before = files.len();
        for entry in WalkDir::new(input).sort_by_file_name() {
            let entry = entry.map_err(|error| {
                Error::new(input, error.to_string(), "a folder that can be read", "check its permissions")
            })?;
            if entry.file_type().is_file() && is_gltf(entry.path()) {
                files.push(entry.into_path());
            }
        }
        if files.len() == before {
            return Err(Error::new(
                input,
                "no .gltf or .glb file in this folder",
                "at least one",
                "name a folder that holds the parts, or the files themselves",
            ));
        }
    }
    Ok(files)
}

/// Bakes every part of every file.
pub fn bake_files(files: &[PathBuf], wanted: &Preparation, store: &Store, monitor: &Monitor) -> Batch {
    let start = Instant::now();
    let mut outcomes = Vec::new();
    for file in files {
        let mut outcome = FileOutcome {
            file: file.display().to_string(),
            parts: vec![],
            notes: vec![],
            error: None,
            sources: vec![],
        };
        if let Err(error) = bake_file(file, wanted, store, monitor, &mut outcome) {
            outcome.error = Some(error.to_string());
        }
        outcomes.push(outcome);
    }
    Batch { files: outcomes, seconds: start.elapsed().as_secs_f64(), evicted: None }
}

fn bake_file(
    file: &Path,
    wanted: &Preparation,
    store: &Store,
    monitor: &Monitor,
    outcome: &mut FileOutcome,
) -> Result<()> {
    let scene = import_scene(file)?;
    outcome.notes.clone_from(&scene.notes);
    outcome.sources.clone_from(&scene.sources);
    let Prepared { parts, resolution, .. } = prepare(&scene, wanted)?;
    let oven = Oven { store, file, resolution, monitor };
    monitor.expect(parts.iter().map(|part| part.geometry.unknowns().elements() as f64).sum());
    for part in &parts {
        let start = Instant::now();
        let baked = oven.bake(part);
        outcome.notes.extend(damage_notes(store));
        let baked = unless_stopped(baked)?.ok_or_else(|| {
            let remedy = "run the same command again: what was finished is in the cache";
            Error::new(file, format!("stopped while baking part `{}`", part.name), "a complete run", remedy)
        })?;
        outcome.parts.push(part_outcome(part, &baked, start.elapsed().as_secs_f64()));
    }
    Ok(())
}

/// A sentence for each cached file found damaged since the last call.
pub fn damage_notes(store: &Store) -> Vec<String> {
    let note = |damage: &Problem| format!("{}: {}; it was made again", damage.file.display(), damage.found);
    store.take_damages().iter().map(note).collect()
}

fn part_outcome(part: &PreparedPart, baked: &Baked, seconds: f64) -> PartOutcome {
    PartOutcome {
        name: part.name.clone(),
        elements: part.geometry.elements.len(),
        element_size: part.element_size.to_string(),
        baked: !baked.form_factors.is_reused(),
        form_factors_reason: baked.form_factors.to_string(),
        light_reason: baked.light.to_string(),
        stored: baked.part.self_block.stored(),
        row_sum_defect: baked.part.self_block.row_sum_defect(),
        seconds,
    }
}
