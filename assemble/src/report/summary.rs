//! Creates the report from the results of a run.

use super::{
    AuditReport, Blocks, Bytes, ErrorReport, ExactRowsReport, NoiseReport, PartReport, Report, RoundReport,
    Verify,
};
use crate::equation::Equation;
use crate::equation::coupling::Coupled;
use crate::exchange::outcome::{Outcome, Round};
use crate::exchange::system::InstanceSystem;
use crate::placed_parts::PlacedParts;
use crate::proof::audit::Audit;
use crate::proof::noise::Noise;
use crate::proof::{Proof, ResidualStatistics};
use crate::report::fates::seen_instances;
use crate::report::notes::{notes, remarks};
use crate::report::openings::dark_parts;
use crate::report::process::peak_rss;
use crate::report::seconds::seconds;
use crate::statistics::{largest_difference, mean_difference, rms_over_mean, row_sum_defect};
use crate::verify::Classic;
use equilux_bake::equilibrium::largest;
use equilux_bake::oven::Baked;
use equilux_formats::Rgb;
use std::collections::BTreeMap;

/// Reasons for skipped work, each following a count: couplings of unseen parts.
pub const UNSEEN: &str = "couplings between parts that cannot see each other";
/// Shells of which only the outer side has elements.
pub const HIDDEN_SHELLS: &str = "inner sides of closed two-sided shells in which nothing shines";
/// Rows that are skipped until the end of the exchange.
pub const BLACK_ROWS: &str = "rows of black receivers in every round, gathered once in the end";
/// Local solves of instances to which no light arrived.
pub const DARK_SOLVES: &str = "equilibria of parts to which nothing new arrived";
/// Coarse spaces of groups of parts that return little light.
pub const COARSE_SPACES: &str = "coarse spaces between parts that return little light to each other";
/// Self blocks that instances share with others of the same part.
pub const SHARED: &str = "own blocks that equal parts share";

/// The results of a run from which the report is created.
#[derive(Debug, Clone, Copy)]
pub struct ReportSources<'a> {
    /// The equation of the scene.
    pub equation: &'a Equation,
    /// The block row of each instance.
    pub systems: &'a [InstanceSystem<'a>],
    /// The exchange.
    pub outcome: &'a Outcome,
    /// The error of clusters, if there are clusters.
    pub proof: Option<&'a Proof>,
    /// The noise of rows by rays, if it was measured.
    pub noise: Option<&'a Noise>,
    /// Rows by rays beside exact ones, if that was asked for.
    pub audit: Option<Audit>,
    /// The classic solution, if requested.
    pub classic: Option<&'a Classic>,
}

/// The report of these results. The caller fills in names, files, and measurements of the operating system.
pub fn summary(sources: &ReportSources) -> Report {
    let ReportSources { equation, systems, outcome, .. } = *sources;
    let Equation { placed, coupled, .. } = equation;
    let elements = placed.world.elements.len();
    let error = error(sources);
    let dark = dark_parts(equation, systems, sources.noise);
    Report {
        scene: String::new(),
        elements,
        unknowns: (0..placed.instances.len()).map(|k| placed.unknowns_of(k)).sum(),
        parts: placed.parts.iter().map(part_report).collect(),
        instances: placed.instances.len(),
        element_size: String::new(),
        blocks: blocks(sources),
        form_factors_stored: systems.iter().map(|n| n.self_block.stored() + n.coupling.stored()).sum(),
        form_factors_computed: form_factors_computed(placed, coupled) + equation.direct.computed,
        rays_traced: equation.rays().map_or(0, |rays| rays_traced(placed, coupled, rays)),
        seconds: seconds(placed, coupled, &outcome.times),
        rounds: rounds(sources),
        coarse_unknowns: outcome.coarse_unknowns,
        groups: outcome.groups,
        converged: outcome.converged,
        error,
        bytes: memory(systems, elements),
        energy: outcome.convergence.energy,
        column_sums: outcome.column_sums,
        row_sum_defect: row_sum_defect(systems),
        verify: sources.classic.map(|classic| verification(placed, classic, outcome)),
        explained: vec![],
        advice: None,
        notes: [notes(placed, systems, outcome), dark.notes].concat(),
        remarks: [remarks(placed, coupled), dark.remarks].concat(),
        outputs: vec![],
    }
}

fn part_report(baked: &Baked) -> PartReport {
    PartReport {
        name: baked.part.name.clone(),
        elements: baked.part.geometry.elements.len(),
        form_factors: if baked.form_factors.is_reused() { "reused" } else { "computed" },
        reason: baked.form_factors.to_string(),
        local_solver: format!("{:?}", baked.part.local.solver),
        stored: baked.part.self_block.stored(),
    }
}

fn rounds(sources: &ReportSources) -> Vec<RoundReport> {
    sources.outcome.rounds.iter().map(|round| round_report(round, sources.classic)).collect()
}

fn round_report(round: &Round, classic: Option<&Classic>) -> RoundReport {
    let off = classic.zip(round.radiosity.as_ref()).map(|(classic, b)| most_off(b, &classic.radiosity));
    RoundReport {
        round: round.number,
        residual: round.convergence.residual,
        error_bound: round.convergence.error_bound,
        relative_bound: round.convergence.relative_bound,
        true_error: off,
        energy: round.convergence.energy,
        seconds: round.time.as_secs_f64(),
    }
}

fn error(sources: &ReportSources) -> ErrorReport {
    let (placed, radiosity) = (&sources.equation.placed, &sources.outcome.radiosity);
    let most = |bound: &[Rgb]| largest(bound).brightest();
    let Some(proof) = sources.proof else {
        let proved = sources.outcome.convergence.error_bound;
        let everywhere = vec![Rgb::splat(proved); radiosity.len()];
        let proved_rms = rms_over_mean(&placed.world.elements, &everywhere, radiosity);
        let noise = sources.noise.zip(sources.equation.rays());
        let noise = noise.map(|(noise, rays)| NoiseReport {
            rays,
            rows: noise.whole.rows,
            rms_rel: noise.whole.over_mean,
        });
        return ErrorReport {
            proved,
            proved_rms,
            proved_from: "rounds",
            spread: None,
            exact_rows: None,
            noise,
            audit: sources.audit.map(audit),
        };
    };
    let measured = proof.measured.as_ref();
    let all = measured.is_some_and(|measured| measured.rows == radiosity.len());
    ErrorReport {
        proved: most(&proof.bound),
        proved_rms: rms_over_mean(&placed.world.elements, &proof.bound, radiosity),
        proved_from: if all { "exact rows" } else { "spread" },
        spread: Some(most(&proof.spread)),
        exact_rows: measured.map(exact_rows),
        noise: None,
        audit: None,
    }
}

fn audit(audit: Audit) -> AuditReport {
    AuditReport {
        rows: audit.rows,
        rms_rel: audit.rms_over_mean,
        bias_rel: audit.bias_over_mean,
        max_rel: audit.largest_over_mean,
        seconds: audit.time.as_secs_f64(),
    }
}

fn exact_rows(measured: &ResidualStatistics) -> ExactRowsReport {
    ExactRowsReport {
        rows: measured.rows,
        residual_max: measured.largest,
        residual_max_rel: measured.largest_over_mean,
        residual_rms_rel: measured.rms_over_mean,
        estimated_rms_rel: measured.estimate,
        form_factors: measured.form_factors,
        seconds: measured.time.as_secs_f64(),
    }
}

fn blocks(sources: &ReportSources) -> Blocks {
    let Equation { placed, coupled, .. } = sources.equation;
    let baked = placed.parts.iter().filter(|part| !part.form_factors.is_reused()).count();
    // By rays, what only touches a part may change its rows, too.
    let corrected = coupled.iter().filter_map(|own| own.corrected.as_ref());
    let corrected: Vec<_> =
        corrected.filter(|own| !own.intruders.is_empty()).map(|own| &own.origin).collect();
    let mut blocks = Blocks {
        self_baked: baked,
        self_reused: placed.instances.len().saturating_sub(baked + corrected.len()),
        self_corrected: corrected.len(),
        self_corrected_reused: corrected.iter().filter(|origin| origin.is_reused()).count(),
        ..Blocks::default()
    };
    let mut unseen = 0;
    for (k, own) in coupled.iter().enumerate() {
        let seen = seen_instances(placed, own);
        unseen += placed.instances.len() - 1 - seen.iter().enumerate().filter(|&(l, s)| *s && l != k).count();
        let seen = seen.iter().filter(|&&s| s).count();
        if own.origin.is_reused() { blocks.coupling_reused += seen } else { blocks.coupling_computed += seen }
    }
    blocks.coupling_left_out = left_out(unseen, sources);
    blocks
}

fn left_out(unseen: usize, sources: &ReportSources) -> BTreeMap<String, usize> {
    let skipped = sources.outcome.skipped;
    let shared = sources.equation.placed.instances.len() - sources.equation.placed.parts.len();
    let counts = [
        (UNSEEN, unseen),
        (BLACK_ROWS, skipped.black_rows),
        (DARK_SOLVES, skipped.dark_solves),
        (COARSE_SPACES, skipped.coarse_spaces),
        (SHARED, shared),
    ];
    counts.into_iter().filter(|&(_, count)| count > 0).map(|(what, count)| (what.into(), count)).collect()
}

fn form_factors_computed(placed: &PlacedParts, coupled: &[Coupled]) -> usize {
    let own = placed.parts.iter().filter(|p| !p.form_factors.is_reused()).map(|p| p.part.self_block.stored());
    let corrected = coupled.iter().filter_map(|own| own.corrected.as_ref()).map(|block| block.computed);
    let coupling = coupled.iter().map(|own| own.computed);
    own.chain(corrected).chain(coupling).sum()
}

/// Rays of baked parts, of so many a row, and of couplings.
fn rays_traced(placed: &PlacedParts, coupled: &[Coupled], rays: u32) -> usize {
    let baked = placed.parts.iter().filter(|baked| !baked.form_factors.is_reused());
    let rows: usize = baked.map(|baked| baked.part.self_block.receivers()).sum();
    rows * rays as usize + coupled.iter().map(|own| own.rays).sum::<usize>()
}

fn memory(systems: &[InstanceSystem], elements: usize) -> Bytes {
    let sizes = || systems.iter().flat_map(|n| [n.self_block.bytes(), n.coupling.bytes()]);
    Bytes {
        dense: elements * elements * size_of::<f64>(),
        stored: sizes().sum(),
        largest_block: sizes().max().unwrap_or(0),
        peak_rss: None,
    }
}

fn verification(placed: &PlacedParts, classic: &Classic, outcome: &Outcome) -> Verify {
    Verify {
        max_rel_diff: largest_difference(&outcome.radiosity, &classic.radiosity),
        rms_rel_diff: mean_difference(&placed.world.elements, &outcome.radiosity, &classic.radiosity),
        max_abs_diff: most_off(&outcome.radiosity, &classic.radiosity),
        form_factor_seconds: classic.form_factor_time.as_secs_f64(),
        solve_seconds: classic.solve_time.as_secs_f64(),
        matrix_bytes: classic.matrix.bytes(),
        peak_rss: peak_rss(),
    }
}

/// The largest difference, W/m².
fn most_off(a: &[Rgb], b: &[Rgb]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
