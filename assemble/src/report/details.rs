//! The complete report as text, printed by `--verbose`: the paper's steps, the rounds, sums and sizes.

use super::text::{NOT_CONVERGED, bytes, counted, left_out_line, percent, rgb};
use super::{AuditReport, ErrorReport, Report, RoundReport, Verify};
use crate::report::advice::Advice;

impl Report {
    /// The complete report as text.
    pub fn details(&self) -> String {
        let mut lines = vec![
            format!(
                "{}: {} elements ({}), {} in {}",
                self.scene,
                self.elements,
                self.element_size,
                counted(self.parts.len(), "part"),
                counted(self.instances, "place")
            ),
            self.blocks_line(),
        ];
        lines.extend(self.advice.iter().flat_map(Advice::lines));
        lines.extend(left_out_line(&self.blocks.coupling_left_out));
        lines.extend(self.explained.iter().cloned());
        lines.extend(self.step_lines());
        lines.extend(self.round_lines());
        lines.extend(self.error.lines(self.elements));
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
            "energy (W, RGB): emitted {}, absorbed {}, escaped {}, still travelling {}",
            rgb(self.energy.emitted),
            rgb(self.energy.absorbed),
            rgb(self.energy.escaped),
            self.energy.travelling.0.map(|power| format!("{power:.1e}")).join(" ")
        ));
        lines.push(format!(
            "column sums: {:.3} to {:.3}; collocation is exact by rows, so in a closed scene deviations from 1 count as escaped \
             power",
            self.column_sums[0], self.column_sums[1]
        ));
        lines.extend(self.verify.as_ref().map(Verify::line));
        lines.extend(self.remarks.iter().cloned());
        lines.extend(self.notes.iter().map(|note| format!("note: {note}")));
        lines.extend(self.outputs.iter().map(|output| format!("wrote {output}")));
        lines.join("\n") + "\n"
    }

    fn blocks_line(&self) -> String {
        let blocks = &self.blocks;
        format!(
            "self blocks: {} baked, {} reused, {} corrected for other parts inside; coupling: {} computed, {} reused; \
             {} form factors computed",
            blocks.self_baked,
            blocks.self_reused,
            blocks.self_corrected,
            blocks.coupling_computed,
            blocks.coupling_reused,
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
            format!("measured: {:.3} s in total with {} threads", s.total, rayon::current_num_threads()),
        ]
    }

    /// The first rounds and the last ones.
    fn round_lines(&self) -> Vec<String> {
        let off = |round: &RoundReport| round.true_error.map_or(String::new(), |off| format!("{off:>14.3e}"));
        let shows_off = self.rounds.iter().any(|round| round.true_error.is_some());
        let mut lines = vec![format!(
            "{:<8}{:>12}{:>14}{:>14}{:>10}{}",
            "round",
            "residual",
            "bound W/m²",
            "relative",
            "seconds",
            if shows_off { format!("{:>14}", "true W/m²") } else { String::new() }
        )];
        let count = self.rounds.len();
        for round in &self.rounds {
            if round.round <= 12 || round.round + 3 > count {
                lines.push(format!(
                    "{:<8}{:>12.3e}{:>14.3e}{:>14.3e}{:>10.3}{}",
                    round.round,
                    round.residual,
                    round.error_bound,
                    round.relative_bound,
                    round.seconds,
                    off(round)
                ));
            } else if round.round == 13 {
                lines.push("…".into());
            }
        }
        if !self.converged {
            lines.push(NOT_CONVERGED.into());
        }
        if let Some(last) = self.rounds.last() {
            lines.push(format!(
                "exchange: proved to be within {:.1e} W/m² of the solution with the stored form factors",
                last.error_bound
            ));
        }
        lines
    }
}

impl ErrorReport {
    /// The proved bound and the measured error of entries that represent clusters.
    fn lines(&self, elements: usize) -> Vec<String> {
        let mut lines = Vec::new();
        match self.spread {
            Some(_) if self.proved.is_finite() => lines.push(format!(
                "clusters: proved error of any radiosity at most {:.2e} W/m², {} of the mean in RMS (adds errors that mostly \
                 cancel; from {})",
                self.proved,
                percent(self.proved_rms),
                self.proved_from
            )),
            Some(_) => lines.push(
                "clusters: no bound on their error can be proved, because some surfaces reflect all light".to_owned(),
            ),
            None => {}
        }
        if let Some(AuditReport { rows, rms_rel, bias_rel, max_rel, .. }) = &self.audit {
            lines.push(format!(
                "beside exact rows: light of {rows} unknowns differs by {} of the mean in RMS, {:+.2} % on average, {} at most",
                percent(*rms_rel),
                100.0 * bias_rel,
                percent(*max_rel),
            ));
        }
        if let Some(rows) = &self.exact_rows {
            let whether = if rows.rows == elements { "all" } else { "a sample, not a proof" };
            lines.push(format!(
                "clusters: measured in {} exact rows ({whether}), residual {} of the mean in RMS, {} at most: \
                 radiosity is off by about {}",
                rows.rows,
                percent(rows.residual_rms_rel),
                percent(rows.residual_max_rel),
                percent(rows.estimated_rms_rel),
            ));
        }
        lines
    }
}
