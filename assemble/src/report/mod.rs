//! The report of a run: one JSON object for machines, text for people.

pub mod advice;
mod checks;
mod details;
pub mod fates;
pub(crate) mod light_notes;
mod notes;
pub mod openings;
pub mod process;
pub mod seconds;
pub mod summary;
pub mod text;
pub(crate) mod unlit;

use crate::exchange::energy::Energy;
use crate::report::advice::Advice;
use crate::report::seconds::Seconds;
use equilux_formats::rows::RowSumDefect;
use serde::Serialize;
use std::collections::BTreeMap;

/// The report, as `--json` prints it. Times in seconds, linear RGB, powers in W, radiosities in W/m².
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The scene's name.
    pub scene: String,
    /// Number of elements in the scene.
    pub elements: usize,
    /// Number of unknowns: elements, or patches of small ones.
    pub unknowns: usize,
    /// The distinct parts.
    pub parts: Vec<PartReport>,
    /// Number of instances.
    pub instances: usize,
    /// Element size in force, as text.
    pub element_size: String,
    /// Counts of computed, reused and skipped blocks.
    pub blocks: Blocks,
    /// Number of stored form factors of all blocks.
    pub form_factors_stored: usize,
    /// Number of form factors computed in this run; 0 if all came from the cache.
    pub form_factors_computed: usize,
    /// Number of rays traced for rows of form factors in this run.
    pub rays_traced: usize,
    /// Time spent.
    pub seconds: Seconds,
    /// The rounds of the exchange.
    pub rounds: Vec<RoundReport>,
    /// Unknowns of the coarse space; 0 if there is none.
    pub coarse_unknowns: usize,
    /// Number of groups of parts that exchange no light with each other.
    pub groups: usize,
    /// Whether the required error bound of the exchange is proved, for the stored form factors.
    pub converged: bool,
    /// The error relative to the exact matrix.
    pub error: ErrorReport,
    /// Memory.
    pub bytes: Bytes,
    /// Power balance of the final state.
    pub energy: Energy,
    /// Smallest and largest share of an element's sent power that arrives: 1 in a closed scene, except for
    /// collocation, which is exact by rows and not by columns.
    pub column_sums: [f64; 2],
    /// The distance of row sums from one: zero in a closed scene.
    pub row_sum_defect: RowSumDefect,
    /// The comparison with the classic matrix, if requested.
    pub verify: Option<Verify>,
    /// The fate of each part and block, and why, one sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub explained: Vec<String>,
    /// Notes that call for action: ignored, dropped or implausible input, one sentence each.
    pub notes: Vec<String>,
    /// Notes on automatic corrections that need no action, one sentence each.
    pub remarks: Vec<String>,
    /// How element size and tolerance were chosen, if a target error was given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub advice: Option<Advice>,
    /// The paths of the written files.
    pub outputs: Vec<String>,
}

/// One distinct part.
#[derive(Debug, Clone, Serialize)]
pub struct PartReport {
    /// Its name.
    pub name: String,
    /// Its elements.
    pub elements: usize,
    /// `computed` or `reused`.
    pub form_factors: &'static str,
    /// The reason.
    pub reason: String,
    /// Solver of its local equilibrium.
    pub local_solver: String,
    /// Form factors stored.
    pub stored: usize,
}

/// Counts of computed, reused and skipped blocks.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Blocks {
    /// Self blocks computed in this run.
    pub self_baked: usize,
    /// Self blocks taken from the cache or shared by instances.
    pub self_reused: usize,
    /// Self blocks that differ from those of the part because other instances are inside it.
    pub self_corrected: usize,
    /// Those of them that came from the cache.
    pub self_corrected_reused: usize,
    /// Coupling blocks computed in this run.
    pub coupling_computed: usize,
    /// Coupling blocks taken from the cache.
    pub coupling_reused: usize,
    /// Work that was skipped because it changes no radiosity, as counts by reason.
    pub coupling_left_out: BTreeMap<String, usize>,
}

impl Blocks {
    /// Count skipped work under the reason `what`, if there is any.
    pub fn leave_out(&mut self, what: &str, count: usize) {
        if count > 0 {
            self.coupling_left_out.insert(what.into(), count);
        }
    }
}

/// One round of the exchange.
#[derive(Debug, Clone, Serialize)]
pub struct RoundReport {
    /// 1 for the first.
    pub round: usize,
    /// Largest residual, W/m².
    pub residual: f64,
    /// Upper bound on the distance of any radiosity from the solution with the stored form factors, W/m².
    pub error_bound: f64,
    /// The bound relative to the brightest radiosity of a group of parts that exchange light; the worst of all.
    pub relative_bound: f64,
    /// Largest difference from the classic solution, W/m², if that was requested and the round's radiosity was kept.
    pub true_error: Option<f64>,
    /// Power balance, W.
    pub energy: Energy,
    /// Wall time.
    pub seconds: f64,
}

/// The error of radiosity relative to the exact matrix, in which every entry is for one element.
#[derive(Debug, Clone, Serialize)]
pub struct ErrorReport {
    /// Upper bound on the error of any radiosity, W/m²; null if nothing is proved.
    pub proved: f64,
    /// Root mean square of the bounds of all elements, relative to the mean radiosity; the worst channel.
    pub proved_rms: f64,
    /// `rounds` if all entries are for single elements; otherwise `spread` of radiosity within clusters, or all
    /// `exact rows`.
    pub proved_from: &'static str,
    /// The bound that follows from the spread of radiosity within clusters alone, W/m².
    pub spread: Option<f64>,
    /// Residuals in exact rows, if there are any.
    pub exact_rows: Option<ExactRowsReport>,
    /// The noise of rows by rays, if there are any.
    pub noise: Option<NoiseReport>,
    /// Rows by rays beside exact ones, if that was asked for.
    pub audit: Option<AuditReport>,
}

/// Irradiance by rays beside exact irradiance from the same radiosity; shares of the mean, the worst channel. A sample, and not
/// proved.
#[derive(Debug, Clone, Serialize)]
pub struct AuditReport {
    /// Number of unknowns.
    pub rows: usize,
    /// Root mean square difference.
    pub rms_rel: f64,
    /// Mean difference: below zero if rows by rays are too dark.
    pub bias_rel: f64,
    /// Largest difference.
    pub max_rel: f64,
    /// Wall time, seconds.
    pub seconds: f64,
}

/// The noise of rows by rays, measured and not proved.
#[derive(Debug, Clone, Serialize)]
pub struct NoiseReport {
    /// Rays a row.
    pub rays: u32,
    /// Number of rows in which it was measured.
    pub rows: usize,
    /// Root mean square of the standard errors of their irradiance over the mean irradiance; the worst channel.
    pub rms_rel: f64,
}

/// Residuals r = E + ρFB − B in exact rows of F. Unless all rows are exact, they prove nothing about other elements.
#[derive(Debug, Clone, Serialize)]
pub struct ExactRowsReport {
    /// Number of rows.
    pub rows: usize,
    /// Largest residual, W/m².
    pub residual_max: f64,
    /// Largest residual relative to the mean radiosity; the worst channel.
    pub residual_max_rel: f64,
    /// Root mean square residual relative to the mean radiosity; the worst channel.
    pub residual_rms_rel: f64,
    /// The root mean square residual divided by 1 − mean reflectance: an estimate of the root mean square error of B
    /// relative to its mean, usually too large.
    pub estimated_rms_rel: f64,
    /// Number of form factors computed; they are not stored.
    pub form_factors: usize,
    /// Time for these form factors, seconds, summed over threads.
    pub seconds: f64,
}

/// Memory.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Bytes {
    /// The classic matrix in f64, bytes.
    pub dense: usize,
    /// All stored blocks, bytes.
    pub stored: usize,
    /// The largest block that one step works on, bytes.
    pub largest_block: usize,
    /// Peak memory of the process before any verification, bytes, where the operating system reports it.
    pub peak_rss: Option<usize>,
}

/// The comparison with the classic matrix.
#[derive(Debug, Clone, Serialize)]
pub struct Verify {
    /// Largest relative difference of any element's radiosity.
    pub max_rel_diff: f64,
    /// Root mean square difference relative to the mean radiosity.
    pub rms_rel_diff: f64,
    /// Largest difference of any element's radiosity, W/m²; the bound of the last round must cover it.
    pub max_abs_diff: f64,
    /// Seconds for the classic form factors, summed over threads.
    pub form_factor_seconds: f64,
    /// Seconds for the classic solution.
    pub solve_seconds: f64,
    /// Size of the stored classic matrix, bytes.
    pub matrix_bytes: usize,
    /// Peak memory of the process after the classic solution, bytes.
    pub peak_rss: Option<usize>,
}
