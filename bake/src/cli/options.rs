//! Options of both programs.

use super::length::in_metres;
use crate::elements::ElementSize;
use crate::elements::bisect::Cut;
use crate::oven::prepare::{Division, Preparation, RowMethod, TOLERANCE};
use crate::treecode::{Resolution, rays_for_tolerance};
use clap::Args;
use equilux_formats::LocalSolver;
use std::path::PathBuf;

/// How a scene becomes parts and elements, and where the cache is.
#[derive(Args, Debug, Clone)]
pub struct SceneOptions {
    /// Cache folder; it can be copied to another machine
    #[arg(long, value_name = "DIR", default_value = ".equilux")]
    pub cache: PathBuf,
    /// After the run, remove the least recently used files from the cache until it has at most this size, such as 2GB;
    /// files used by this run are kept
    #[arg(long, value_name = "SIZE", value_parser = super::size::parse)]
    pub cache_limit: Option<u64>,
    /// Largest edge of an element in metres, or `mesh` for the mesh's own faces [default: suits the scene]
    #[arg(long, value_name = "METRES|mesh", value_parser = element_size)]
    pub element_size: Option<ElementSize>,
    /// Approximate relative error of the result: with rays by their number, with exact rows by merging distant elements
    /// into clusters with one exact form factor; 0 keeps an exact form factor for every element
    #[arg(long, value_name = "EPS", default_value_t = TOLERANCE, value_parser = tolerance)]
    pub tolerance: f64,
    /// How rows of form factors are computed
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    pub rows: RowMethod,
    /// Rays from each element, where rows are by rays: a power of two from 64 to 16384 [default: 64, 256, 1024 or 4096,
    /// as --tolerance asks]
    #[arg(long, value_name = "N", value_parser = rays)]
    pub rays: Option<u32>,
    /// Divide the scene into this many parts: repeatedly halve the largest at the median of its longest axis
    #[arg(long, value_name = "N", conflicts_with = "cut", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub bisect: Option<u32>,
    /// Divide the scene into parts by this plane, such as x=1.5; may be repeated
    #[arg(long, value_name = "AXIS=METRES", value_parser = cut)]
    pub cut: Vec<Cut>,
    /// Solver for each part's local equilibrium [default: direct for small parts, iterative for large]
    #[arg(long, value_name = "SOLVER")]
    pub local_solver: Option<LocalSolver>,
    /// Threads to use [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,
    /// Print one JSON object on stdout and nothing else
    #[arg(long)]
    pub json: bool,
}

impl SceneOptions {
    /// The choices about elements and parts.
    pub fn preparation(&self) -> Preparation {
        let division = match self.bisect {
            Some(count) => Division::Bisect(count as usize),
            None if self.cut.is_empty() => Division::Authored,
            None => Division::Cuts(self.cut.clone()),
        };
        Preparation {
            element_size: self.element_size,
            division,
            resolution: Resolution::for_tolerance(self.tolerance),
            rows: self.rows,
            rays: self.rays.unwrap_or_else(|| rays_for_tolerance(self.tolerance)),
            local_solver: self.local_solver,
        }
    }

    /// Limits the thread pool to [`Self::threads`].
    pub fn set_threads(&self) -> anyhow::Result<()> {
        if let Some(threads) = self.threads {
            rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build_global()?;
        }
        Ok(())
    }
}

/// Parses an element size: metres, or `mesh`.
pub fn element_size(text: &str) -> Result<ElementSize, String> {
    if text == "mesh" {
        return Ok(ElementSize::Mesh);
    }
    match text.parse::<f64>() {
        Ok(size) if size > 0.0 && size.is_finite() => Ok(ElementSize::Metres(size)),
        _ => Err(format!("an element size is a number of metres above zero, or `mesh`{}", in_metres(text))),
    }
}

fn cut(text: &str) -> Result<Cut, String> {
    text.parse().map_err(|error| format!("{error}{}", in_metres(text)))
}

fn rays(text: &str) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(rays) if (64..=16384).contains(&rays) && rays.is_power_of_two() => Ok(rays),
        _ => Err("a number of rays is a power of two from 64 to 16384".into()),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(tolerance) if (0.0..1.0).contains(&tolerance) => Ok(tolerance),
        _ => Err("a tolerance is a number from 0, which keeps every form factor, to below 1".into()),
    }
}
