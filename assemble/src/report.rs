//! What a run says about itself: one JSON object for machines, tables for people.

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
    /// Form factors computed in this run; none if everything came from the cache.
    pub form_factors_computed: usize,
    /// Where time went.
    pub seconds: Seconds,
    /// The exchange, round by round.
    pub rounds: Vec<RoundReport>,
    /// Whether the error asked for is proved.
    pub converged: bool,
    /// Memory.
    pub bytes: Bytes,
    /// Energy account of the final state.
    pub energy: Energy,
    /// How far row sums are from one: zero in a closed scene.
    pub row_sum_defect: Defect,
    /// The comparison with the classic matrix, if asked for.
    pub verify: Option<Verify>,
    /// What was ignored, dropped or corrected, one sentence each.
    pub notes: Vec<String>,
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
    /// Coupling blocks that hold nothing, by reason.
    pub coupling_left_out: BTreeMap<String, usize>,
}

/// The paper's steps: 1, 2 own blocks of the first part and of the others; 3, 4 coupling into the first and into the
/// others; 5, 6 equilibrium in the first and in the others; 7 transfer to the others, 8 to the first.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Seconds {
    /// F₁₁.
    pub step1: f64,
    /// F₂₂ (all other parts).
    pub step2: f64,
    /// F₁₂.
    pub step3: f64,
    /// F₂₁.
    pub step4: f64,
    /// Equilibrium in part 1.
    pub step5: f64,
    /// Equilibrium in part 2 (all others).
    pub step6: f64,
    /// Transfer from 1 to 2.
    pub step7: f64,
    /// Transfer from 2 to 1.
    pub step8: f64,
    /// All steps one after the other.
    pub t1: f64,
    /// Own blocks and equilibria of the parts side by side.
    pub t2: f64,
    /// Everything side by side that can be: the longest chain.
    pub t3: f64,
    /// Wall time of the run.
    pub total: f64,
}

/// One round of the exchange.
#[derive(Debug, Clone, Serialize)]
pub struct RoundReport {
    /// 1 for the first.
    pub round: usize,
    /// Largest residual, W/m².
    pub residual: f64,
    /// No radiosity is further than this from the exact solution, W/m².
    pub error_bound: f64,
    /// The share of the bound that comes from compressed form factors, W/m²; known after the last round.
    pub compression: f64,
    /// The bound over the brightest radiosity.
    pub relative_bound: f64,
    /// Wall time.
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

/// emitted = absorbed + escaped. Collocation is exact by rows, not in energy: in a closed scene `escaped` is what that
/// costs.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Energy {
    /// Σ A E, W.
    pub emitted: [f64; 3],
    /// Σ A (1 − ρ) H, W.
    pub absorbed: [f64; 3],
    /// Σ A B − Σ A H, W.
    pub escaped: [f64; 3],
}

/// Distance of row sums from one.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Defect {
    /// The worst row.
    pub max: f64,
    /// The mean over all rows.
    pub mean: f64,
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

/// The most memory this process held so far, bytes; none where the system does not tell.
pub fn peak_rss() -> Option<usize> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: usize = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes * 1024)
}

impl Report {
    /// The report for a person, a few lines and two tables.
    pub fn text(&self) -> String {
        let mut lines = vec![
            format!(
                "{}: {} elements ({}), {} parts in {} places",
                self.scene,
                self.elements,
                self.element_size,
                self.parts.len(),
                self.instances
            ),
            self.blocks_line(),
        ];
        lines.extend(self.step_lines());
        lines.extend(self.round_lines());
        lines.push(format!(
            "row sums: at most {:.1e} from 1, {:.1e} on average (open scenes stay below 1)",
            self.row_sum_defect.max, self.row_sum_defect.mean
        ));
        lines.push(format!(
            "memory: {} in blocks, largest {}; the classic matrix {}{}",
            bytes(self.bytes.stored),
            bytes(self.bytes.largest_block),
            bytes(self.bytes.dense),
            self.bytes.peak_rss.map_or(String::new(), |peak| format!("; peak {}", bytes(peak)))
        ));
        lines.push(format!(
            "energy (W, RGB): emitted {}, absorbed {}, escaped {}",
            rgb(self.energy.emitted),
            rgb(self.energy.absorbed),
            rgb(self.energy.escaped)
        ));
        if let Some(verify) = &self.verify {
            lines.push(format!(
                "classic matrix: largest relative difference {:.1e}, {:.1e} in the mean, {:.1e} W/m² at most; {:.2} s + {:.2} s, {} kept{}",
                verify.max_rel_diff,
                verify.rms_rel_diff,
                verify.max_abs_diff,
                verify.form_factor_seconds,
                verify.solve_seconds,
                bytes(verify.matrix_bytes),
                verify.peak_rss.map_or(String::new(), |peak| format!(", peak {}", bytes(peak)))
            ));
        }
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        lines.extend(self.outputs.iter().map(|output| format!("wrote {output}")));
        lines.join("\n") + "\n"
    }

    fn blocks_line(&self) -> String {
        let blocks = &self.blocks;
        let left_out: Vec<String> = blocks
            .coupling_left_out
            .iter()
            .map(|(reason, count)| format!(", {count} left out ({reason})"))
            .collect();
        format!(
            "own blocks: {} baked, {} reused, {} corrected for what stands inside; coupling: {} computed, {} reused{}; \
             {} form factors computed",
            blocks.self_baked,
            blocks.self_reused,
            blocks.self_corrected,
            blocks.coupling_computed,
            blocks.coupling_reused,
            left_out.concat(),
            self.form_factors_computed
        )
    }

    fn step_lines(&self) -> Vec<String> {
        let s = &self.seconds;
        vec![
            format!(
                "{:<8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}",
                "step", 1, 2, 3, 4, 5, 6, 7, 8, "T1", "T2", "T3"
            ),
            format!(
                "{:<8}{:>9.3}{:>9.3}{:>9.3}{:>9.3}{:>9.3}{:>9.3}{:>9.3}{:>9.3}{:>9.3}{:>9.3}{:>9.3}",
                "seconds",
                s.step1,
                s.step2,
                s.step3,
                s.step4,
                s.step5,
                s.step6,
                s.step7,
                s.step8,
                s.t1,
                s.t2,
                s.t3
            ),
            format!("measured: {:.3} s in all with {} threads", s.total, rayon::current_num_threads()),
        ]
    }

    /// The first rounds and the last; a thousand lines help nobody.
    fn round_lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "{:<8}{:>12}{:>14}{:>14}{:>10}",
            "round", "residual", "bound W/m²", "relative", "seconds"
        )];
        let count = self.rounds.len();
        for round in &self.rounds {
            if round.round <= 12 || round.round + 3 > count {
                lines.push(format!(
                    "{:<8}{:>12.3e}{:>14.3e}{:>14.3e}{:>10.3}",
                    round.round, round.residual, round.error_bound, round.relative_bound, round.seconds
                ));
            } else if round.round == 13 {
                lines.push("…".into());
            }
        }
        if !self.converged {
            lines.push("the error asked for is not proved: stopped before, or rounding is reached".into());
        }
        lines
    }
}

fn bytes(count: usize) -> String {
    let mut value = count as f64;
    for unit in ["B", "kB", "MB", "GB"] {
        if value < 1000.0 || unit == "GB" {
            return format!("{value:.3} {unit}").replace(".000 B", " B");
        }
        value /= 1000.0;
    }
    unreachable!("the last unit returns")
}

fn rgb(v: [f64; 3]) -> String {
    format!("{:.4} {:.4} {:.4}", v[0], v[1], v[2])
}
