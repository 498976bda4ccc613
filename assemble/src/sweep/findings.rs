//! What follows from comparing runs, in sentences: whether the default is a good choice, and what the scene did not need.

use super::row::Row;
use super::run::Run;
use super::setting::{DEFAULT_TOLERANCE, Kind, Setting};

/// Errors that differ by less than this share of themselves are alike.
const ALIKE: f64 = 0.05;

/// All sentences. `size` is the scene's own element size, metres.
pub fn findings(runs: &[Run], rows: &[Row], size: f64) -> Vec<String> {
    let at = At { rows, size };
    let default = runs.iter().find(|run| run.setting.is_default(size));
    let mut said: Vec<String> = [at.default_against_all(), at.tolerance(), at.error(), at.exchange()]
        .into_iter()
        .chain([
            at.same_light("--local-solver", "local solver"),
            at.same_light("--bisect", "division by planes"),
        ])
        .chain([at.threads()])
        .flatten()
        .collect();
    said.extend(default.into_iter().flat_map(left_out));
    said
}

/// `1.2 %`, with two digits that tell something.
pub fn percent(share: f64) -> String {
    // The unit stays on the line of its number.
    format!("{}\u{a0}%", two_digits(share * 100.0))
}

/// A number with two digits, or all before its point: 0.061, 0.61, 6.1, 61, 610.
pub fn two_digits(value: f64) -> f64 {
    let rounded = format!("{value:.1e}").parse().unwrap_or(value);
    if value.abs() >= 100.0 { value.round() } else { rounded }
}

/// `1.2 s`, with two or three digits.
pub fn seconds(seconds: f64) -> String {
    match seconds {
        s if s >= 99.5 => format!("{s:.0} s"),
        s if s >= 9.95 => format!("{s:.1} s"),
        s if s >= 0.1 => format!("{s:.2} s"),
        s => format!("{:.1} ms", s * 1e3),
    }
}

/// The runs around the default.
struct At<'a> {
    rows: &'a [Row],
    size: f64,
}

impl<'a> At<'a> {
    fn row(&self, setting: &Setting) -> Option<&'a Row> {
        self.rows.iter().find(|row| row.setting == *setting)
    }

    fn default(&self) -> Option<&'a Row> {
        self.row(&self.parts(DEFAULT_TOLERANCE))
    }

    fn parts(&self, tolerance: f64) -> Setting {
        Setting::new(Kind::Parts { tolerance }, self.size)
    }

    /// The default with one option that begins like this.
    fn with(&self, option: &str) -> Vec<&'a Row> {
        let like = |row: &&Row| {
            row.setting.more.len() == 2
                && row.setting.more[0] == option
                && row.setting == self.parts(DEFAULT_TOLERANCE).with(&row.setting.more.join(" "))
        };
        self.rows.iter().filter(like).collect()
    }

    fn default_against_all(&self) -> Option<String> {
        let default = self.default()?;
        let sentence = |what: &str, of: &dyn Fn(&Row) -> Option<(f64, f64)>| {
            let (own_seconds, own_error) = of(default)?;
            let better = |row: &&Row| row.competes() && of(row).is_some_and(|(_, e)| e <= own_error);
            let quickest = self.rows.iter().filter(better).min_by(|a, b| {
                of(a).unzip().0.partial_cmp(&of(b).unzip().0).unwrap_or(std::cmp::Ordering::Equal)
            })?;
            let own =
                format!("{what} of the default err by {} after {}", percent(own_error), seconds(own_seconds));
            Some(if quickest.is_default {
                format!("{own}; nothing that was tried is as good in less time.")
            } else {
                let (time, error) = of(quickest)?;
                let share = time / own_seconds;
                format!(
                    "{own}; the quickest that is as good ({}) takes {share:.2} of that time and errs by {}.",
                    quickest.label,
                    percent(error)
                )
            })
        };
        let both = [sentence("Gathered points", &Row::gathered), sentence("Flat elements", &Row::flat)];
        Some(both.into_iter().flatten().collect::<Vec<_>>().join(" "))
    }

    /// The loosest tolerance that is as good as an exact matrix.
    fn tolerance(&self) -> Option<String> {
        // What the reference itself was taken from errs by nothing, and nothing follows.
        let exact = self.row(&self.parts(0.0)).filter(|exact| exact.errors.gathered > 0.0)?;
        let tolerances = [0.1, 0.03, 0.01, 0.003, 0.001];
        let good = |row: &&Row| {
            let as_good = |a: f64, b: f64| a <= b * (1.0 + ALIKE);
            as_good(row.errors.gathered, exact.errors.gathered)
                && as_good(row.errors.elements, exact.errors.elements)
        };
        let loosest = tolerances.into_iter().find_map(|t| Some((t, self.row(&self.parts(t)).filter(good)?)));
        let Some((tolerance, row)) = loosest else {
            return Some(format!(
                "With elements of {} m no tolerance that was tried is as good as the exact matrix, which errs by {} at points.",
                self.size,
                percent(exact.errors.gathered)
            ));
        };
        Some(format!(
            "A tolerance below {tolerance} was not needed: with elements of {} m the exact matrix is no better ({} against {} of gathered light), and takes {} instead of {}.",
            self.size,
            percent(exact.errors.gathered),
            percent(row.errors.gathered),
            seconds(exact.seconds_solve),
            seconds(row.seconds_solve),
        ))
    }

    /// The loosest end of the exchange that changes nothing.
    fn error(&self) -> Option<String> {
        let default = self.default()?;
        let rows = self.with("--error");
        let loosest = rows.iter().find(|row| alike(row, default))?;
        (loosest.rounds < default.rounds).then(|| {
            format!(
                "An exchange to a proved 1e-6 was not needed: --error {} changes nothing that can be measured here, with {} instead of {} rounds.",
                loosest.setting.more[1], loosest.rounds, default.rounds
            )
        })
    }

    fn exchange(&self) -> Option<String> {
        let default = self.default()?;
        let rows = self.with("--exchange");
        let ways: Vec<String> =
            rows.iter().map(|row| format!("{} {}", row.setting.more[1], row.rounds)).collect();
        (!ways.is_empty()).then(|| {
            format!(
                "Rounds to a proved 1e-6: auto {}, {}. All find the same light.",
                default.rounds,
                ways.join(", ")
            )
        })
    }

    /// Options that change the time alone.
    fn same_light(&self, option: &str, what: &str) -> Option<String> {
        let default = self.default()?;
        let rows = self.with(option);
        let times: Vec<String> = rows
            .iter()
            .map(|row| format!("{} {}", row.setting.more[1], seconds(row.seconds_solve)))
            .collect();
        (!rows.is_empty() && rows.iter().all(|row| alike(row, default))).then(|| {
            format!(
                "The {what} makes no difference to the light, only to the time: {} against {} by default.",
                times.join(", "),
                seconds(default.seconds_solve)
            )
        })
    }

    fn threads(&self) -> Option<String> {
        let (default, one) = (self.default()?, *self.with("--threads").first()?);
        Some(format!(
            "One thread takes {} where all take {}.",
            seconds(one.seconds_solve),
            seconds(default.seconds_solve)
        ))
    }
}

/// Whether errors are alike.
fn alike(a: &Row, b: &Row) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= ALIKE * b;
    near(a.errors.gathered, b.errors.gathered) && near(a.errors.elements, b.errors.elements)
}

/// What the run left out by itself.
fn left_out(run: &Run) -> Vec<String> {
    let facts = &run.facts;
    let reasons: Vec<String> =
        facts.blocks.coupling_left_out.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let mut said = vec![];
    if !reasons.is_empty() {
        said.push(format!("The default left out by itself: {}.", reasons.join("; ")));
    }
    if facts.instances == 1 {
        said.push("The scene is one part: there was no light to exchange.".into());
    } else if facts.coarse_unknowns == 0 {
        said.push("The exchange needed no coarse space between parts.".into());
    }
    said
}
