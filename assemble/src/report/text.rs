//! The short report as text: the scene, its time, its error, notes, and the written files.

use super::{AuditReport, ErrorReport, NoiseReport, Report, Verify};
use crate::report::advice::Advice;
use equilux_formats::Rgb;
use std::collections::BTreeMap;
use std::path::Path;

/// Maximum number of printed notes; the rest are counted.
const MAX_NOTES: usize = 6;

/// The state of an exchange that ended above its error bound.
pub const NOT_CONVERGED: &str = "not converged: stopped early, or limited by rounding";

impl Report {
    /// The written files and the notes, as text.
    pub fn outputs_text(&self) -> String {
        self.notes_lines().into_iter().chain(self.written_lines()).map(|line| line + "\n").collect()
    }

    /// The short report as text.
    pub fn text(&self) -> String {
        let mut lines = vec![
            format!(
                "{}: {} ({}), {} in {}; {:.2} s",
                self.scene,
                self.size(),
                self.element_size,
                counted(self.parts.len(), "part"),
                counted(self.instances, "place"),
                self.seconds.total
            ),
            self.computed_line(),
            self.error_line(),
        ];
        lines.extend(self.verify.as_ref().map(Verify::line));
        lines.extend(self.advice.iter().flat_map(Advice::lines));
        lines.extend(self.explained.iter().cloned());
        lines.extend(self.notes_lines());
        lines.extend(self.written_lines());
        lines.join("\n") + "\n"
    }

    fn computed_line(&self) -> String {
        let blocks = &self.blocks;
        let corrected = blocks.self_corrected - blocks.self_corrected_reused;
        let computed = blocks.self_baked + corrected + blocks.coupling_computed;
        let reused = blocks.self_reused + blocks.self_corrected_reused + blocks.coupling_reused;
        match (self.form_factors_computed, computed) {
            (0, 0) => "form factors: all from the cache".into(),
            (form_factors, _) => {
                let rays = match self.rays_traced {
                    0 => String::new(),
                    rays => format!(" from {} rays", thousands(rays)),
                };
                let (form_factors, all) = (thousands(form_factors), reused + computed);
                format!(
                    "form factors: {form_factors} computed{rays}, {reused} of {all} blocks from the cache"
                )
            }
        }
    }

    /// The number of elements, and of the patches of which they are part.
    fn size(&self) -> String {
        if self.unknowns == self.elements {
            format!("{} elements", self.elements)
        } else {
            format!("{} patches of {} elements", self.unknowns, self.elements)
        }
    }

    fn error_line(&self) -> String {
        let line = format!("error: {}", self.error.text());
        if self.converged { line } else { format!("{line}; {NOT_CONVERGED}") }
    }

    fn notes_lines(&self) -> Vec<String> {
        let mut lines: Vec<String> =
            self.notes.iter().take(MAX_NOTES).map(|note| format!("note: {note}")).collect();
        if let more @ 1.. = self.notes.len().saturating_sub(MAX_NOTES) {
            lines.push(format!("{} more: --verbose or --json", counted(more, "note")));
        }
        lines
    }

    /// A line for each folder with the files in it.
    fn written_lines(&self) -> Vec<String> {
        let mut folders: Vec<(&Path, Vec<&str>)> = Vec::new();
        for output in &self.outputs {
            let path = Path::new(output);
            let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or(output);
            match folders.iter_mut().find(|(known, _)| *known == folder) {
                Some((_, names)) => names.push(name),
                None => folders.push((folder, vec![name])),
            }
        }
        let line =
            |(folder, names): (&Path, Vec<&str>)| format!("wrote {}: {}", folder.display(), names.join(", "));
        folders.into_iter().map(line).collect()
    }
}

impl ErrorReport {
    /// The measured error and the proved bound, in a clause each.
    fn text(&self) -> String {
        let what = if self.noise.is_some() { "the exchange " } else { "" };
        let proved = if self.proved.is_finite() {
            format!("{what}proved below {} W/m² everywhere", rounded(self.proved))
        } else {
            "without a proof, because some surfaces reflect all light".into()
        };
        match &self.exact_rows {
            Some(rows) => format!(
                "about {} of the mean (from {} exact rows), {proved}",
                percent(rows.estimated_rms_rel),
                rows.rows
            ),
            None => match &self.noise {
                Some(NoiseReport { rays, rows, rms_rel }) => {
                    let audit = self.audit.as_ref().map_or(String::new(), AuditReport::clause);
                    format!(
                        "noise about {} of the mean (measured in {rows} rows of {rays} rays){audit}, {proved}",
                        percent(*rms_rel)
                    )
                }
                None => proved,
            },
        }
    }
}

impl AuditReport {
    /// How far rows by rays are from exact ones.
    fn clause(&self) -> String {
        let Self { rows, rms_rel, bias_rel, .. } = self;
        format!(", {} from {rows} exact rows ({:+.2} % on average)", percent(*rms_rel), 100.0 * bias_rel)
    }
}

impl Verify {
    /// The comparison with the classic matrix.
    pub fn line(&self) -> String {
        format!(
            "classic matrix: largest relative difference {:.1e}, {:.1e} in the mean, {:.1e} W/m² at most; {:.2} s + {:.2} s, {} kept{}",
            self.max_rel_diff,
            self.rms_rel_diff,
            self.max_abs_diff,
            self.form_factor_seconds,
            self.solve_seconds,
            bytes(self.matrix_bytes),
            self.peak_rss.map_or(String::new(), |peak| format!(", peak {}", bytes(peak)))
        )
    }
}

/// A count with its noun.
pub fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A number with its digits in groups of three.
fn thousands(number: usize) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).expect("digits")).collect();
    groups.join(" ")
}

/// Two digits of a number, written without an exponent where that is short.
fn rounded(number: f64) -> String {
    if number == 0.0 {
        "0".into()
    } else if (1e-3..1e4).contains(&number) {
        let decimals = (1 - number.log10().floor() as i32).clamp(0, 4) as usize;
        format!("{number:.decimals$}")
    } else {
        format!("{number:.1e}")
    }
}

/// A share in percent.
pub fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}

/// The skipped work and its counts as a line, if there is any.
pub fn left_out_line(counts: &BTreeMap<String, usize>) -> Option<String> {
    let counts: Vec<String> = counts.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    (!counts.is_empty()).then(|| format!("left out: {}", counts.join("; ")))
}

/// A number of bytes in a suitable unit.
pub fn bytes(count: usize) -> String {
    let mut value = count as f64;
    for unit in ["B", "kB", "MB", "GB"] {
        if value < 1000.0 || unit == "GB" {
            return format!("{value:.3} {unit}").replace(".000 B", " B");
        }
        value /= 1000.0;
    }
    unreachable!("the last unit returns")
}

/// Three channels.
pub fn rgb(v: Rgb) -> String {
    format!("{:.4} {:.4} {:.4}", v[0], v[1], v[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, expected) in
            [(0.0, "0"), (0.01234, "0.012"), (2.25, "2.2"), (1234.0, "1234"), (3e-9, "3.0e-9")]
        {
            assert_eq!(rounded(number), expected);
        }
        assert_eq!([12, 1234, 1234567].map(thousands), ["12", "1 234", "1 234 567"]);
    }
}
