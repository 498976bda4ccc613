//! What a run says about itself: one JSON object for machines, tables for people.

pub mod advice;
mod checks;
mod details;
pub mod fates;
pub(crate) mod light_notes;
mod notes;
pub mod process;
pub mod seconds;
pub mod summary;
pub mod text;
pub(crate) mod unlit;

use crate::exchange::energy::Energy;
use crate::report::advice::Advice;
use crate::report::seconds::Seconds;
use equilux_formats::RowSumDefect;
use serde::Serialize;
use std::collections::BTreeMap;

/// The whole report, as `--json` prints it. Seconds unless said, linear RGB, W or W/m².
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// The scene's name.
    pub scene: String,
    /// Number of elements in the scene.
    pub elements: usize,
    /// The distinct parts.
    pub parts: Vec<PartReport>,
    /// Number of instances.
    pub instances: usize,
    /// Element size in force, for a person.
    pub element_size: String,
    /// What became of the blocks.
    pub blocks: Blocks,
    /// Form factors of all blocks together.
    pub form_factors_stored: usize,
    /// Form factors computed in this run; none if everything came from the cache.
    pub form_factors_computed: usize,
    /// Where time went.
    pub seconds: Seconds,
    /// The exchange, round by round.
    pub rounds: Vec<RoundReport>,
    /// Unknowns of the coarse space in the exchange; 0 if it was left out.
    pub coarse_unknowns: usize,
    /// Number of groups of parts that exchange no light with each other.
    pub groups: usize,
    /// Whether the error asked for is proved, of the exchange with the form factors as they are kept.
    pub converged: bool,
    /// How far the answer is from that of the exact matrix.
    pub error: ErrorReport,
    /// Memory.
    pub bytes: Bytes,
    /// Energy account of the final state.
    pub energy: Energy,
    /// Least and largest share of what an element sends that arrives somewhere: in a closed scene 1, but for collocation,
    /// which is exact by rows and not by columns.
    pub column_sums: [f64; 2],
    /// How far row sums are from one: zero in a closed scene.
    pub row_sum_defect: RowSumDefect,
    /// The comparison with the classic matrix, if asked for.
    pub verify: Option<Verify>,
    /// What became of each part and block and why, one sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub explained: Vec<String>,
    /// What calls for action: what was ignored, dropped or cannot be right, one sentence each.
    pub notes: Vec<String>,
    /// What was corrected and needs no action, one sentence each.
    pub remarks: Vec<String>,
    /// How element size and tolerance were chosen, if an error was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub advice: Option<Advice>,
    /// Where pictures and files were written.
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
    /// Why.
    pub reason: String,
    /// Who solves its equilibrium.
    pub local_solver: String,
    /// Form factors stored.
    pub stored: usize,
}

/// What became of the blocks.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Blocks {
    /// Self blocks computed in this run.
    pub self_baked: usize,
    /// Self blocks taken from the cache or shared by instances.
    pub self_reused: usize,
    /// Self blocks computed anew because something stands inside the part.
    pub self_corrected: usize,
    /// Coupling blocks computed in this run.
    pub coupling_computed: usize,
    /// Coupling blocks taken from the cache.
    pub coupling_reused: usize,
    /// What was left out because it changes no radiosity, and how often, by reason.
    pub coupling_left_out: BTreeMap<String, usize>,
}

impl Blocks {
    /// Notes that `what` was left out so often, if at all.
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
    /// No radiosity is further than this from the solution with the form factors as they are kept, W/m².
    pub error_bound: f64,
    /// The bound over the brightest radiosity of the parts that exchange light with each other, the worst of all.
    pub relative_bound: f64,
    /// Largest difference from the classic solution, W/m², if that was asked for and there is a picture of the round.
    pub true_error: Option<f64>,
    /// Where the power is.
    pub energy: Energy,
    /// Wall time.
    pub seconds: f64,
}

/// How far radiosity is from that of the exact matrix, in which every entry is for one element.
#[derive(Debug, Clone, Serialize)]
pub struct ErrorReport {
    /// No radiosity is further off, W/m²; null if nothing is proved.
    pub proved: f64,
    /// Root mean square of what is proved of each element, over the mean radiosity; the worst channel.
    pub proved_rms: f64,
    /// `rounds` where entries are for single elements; else `spread` of radiosity within clusters, or all `exact rows`.
    pub proved_from: &'static str,
    /// What the spread of radiosity within clusters alone proves, W/m².
    pub spread: Option<f64>,
    /// What exact rows of some receivers say, if there are any.
    pub exact_rows: Option<ExactRowsReport>,
}

/// Residuals r = E + ρFB − B where the rows of F are exact. Unless they are all, they prove nothing of other elements.
#[derive(Debug, Clone, Serialize)]
pub struct ExactRowsReport {
    /// Number of rows.
    pub rows: usize,
    /// Largest residual, W/m².
    pub residual_max: f64,
    /// Largest residual over the mean radiosity; the worst channel.
    pub residual_max_rel: f64,
    /// Root mean square residual over the mean radiosity; the worst channel.
    pub residual_rms_rel: f64,
    /// That over 1 − mean reflectance: an estimate of the root mean square error of B over its mean, mostly too large.
    pub estimated_rms_rel: f64,
    /// Form factors computed for it; they are not kept.
    pub form_factors: usize,
    /// Seconds for these, summed over threads.
    pub seconds: f64,
}

/// Memory.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Bytes {
    /// The classic matrix in f64.
    pub dense: usize,
    /// All blocks as they are kept.
    pub stored: usize,
    /// The largest block that one step works on.
    pub largest_block: usize,
    /// The most the process held, where the system tells; before any verification.
    pub peak_rss: Option<usize>,
}

/// The comparison with the classic matrix.
#[derive(Debug, Clone, Serialize)]
pub struct Verify {
    /// Largest relative difference of any element's radiosity.
    pub max_rel_diff: f64,
    /// Root mean square difference over the mean radiosity.
    pub rms_rel_diff: f64,
    /// Largest difference of any element's radiosity, W/m²: what the last round's bound must cover.
    pub max_abs_diff: f64,
    /// Seconds for the classic form factors, summed over threads.
    pub form_factor_seconds: f64,
    /// Seconds for the classic solution.
    pub solve_seconds: f64,
    /// Bytes of the classic matrix as it is kept.
    pub matrix_bytes: usize,
    /// The most the process held after the classic solution.
    pub peak_rss: Option<usize>,
}
