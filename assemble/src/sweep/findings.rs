//! Conclusions from comparing runs, in sentences: whether the default settings are a good choice, and which work the scene
//! did not need.

use super::numbers::{percent, seconds};
use super::row::Row;
use super::run::Run;
use super::setting::{DEFAULT_TOLERANCE, Kind, Setting};

/// Errors that differ by less than this share of themselves count as equal.
const ALIKE: f64 = 0.05;

/// Tolerances that a scene may not need to go below, the loosest first.
const TOLERANCES: [f64; 5] = [0.1, 0.03, 0.01, 0.003, 0.001];

/// All sentences. `size` is the scene's own element size, metres.
pub fn findings(runs: &[Run], rows: &[Row], size: f64) -> Vec<String> {
    let at = Neighbourhood { rows, size };
    let default = runs.iter().find(|run| run.setting.is_default(size));
    let mut sentences: Vec<String> = [at.default_against_all(), at.tolerance(), at.error(), at.exchange()]
        .into_iter()
        .chain([
            at.same_light("--local-solver", "local solver"),
            at.same_light("--bisect", "number of parts cut by planes"),
        ])
        .chain([at.threads()])
        .flatten()
        .collect();
    sentences.extend(default.into_iter().flat_map(left_out));
    sentences
}

/// The default settings, and the runs that differ from them in one option.
struct Neighbourhood<'a> {
    rows: &'a [Row],
    size: f64,
}

impl<'a> Neighbourhood<'a> {
    fn row(&self, setting: &Setting) -> Option<&'a Row> {
        self.rows.iter().find(|row| row.setting == *setting)
    }

    fn default(&self) -> Option<&'a Row> {
        self.row(&self.parts(DEFAULT_TOLERANCE))
    }

    fn parts(&self, tolerance: f64) -> Setting {
        Setting::new(Kind::Parts { tolerance }, self.size)
    }

    /// The runs with the default settings but for this option.
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
        let sentence = |what: &str, cost: &dyn Fn(&Row) -> (f64, f64)| {
            let (own_seconds, own_error) = cost(default);
            let better = |row: &&Row| row.competes() && cost(row).1 <= own_error;
            let by_time = |a: &&Row, b: &&Row| cost(a).0.total_cmp(&cost(b).0);
            let quickest = self.rows.iter().filter(better).min_by(by_time)?;
            let own = format!(
                "{what}: with the default settings the error is {} after {} of {}",
                percent(own_error),
                seconds(own_seconds),
                default.clock()
            );
            Some(if quickest.is_default {
                format!("{own}; no other setting tried is as accurate in less time.")
            } else {
                let (time, error) = cost(quickest);
                let (share, label) = (time / own_seconds, &quickest.label);
                format!(
                    "{own}; the quickest setting that is as accurate ({label}) takes {share:.2} times as long, with an error of {}.",
                    percent(error)
                )
            })
        };
        let both = [sentence("Light at points", &Row::gathered), sentence("Light of elements", &Row::flat)];
        Some(both.into_iter().flatten().collect::<Vec<_>>().join(" "))
    }

    /// The loosest tolerance that is as accurate as an exact matrix.
    fn tolerance(&self) -> Option<String> {
        // A run that is the reference itself has no error, and proves nothing.
        let exact = self.row(&self.parts(0.0)).filter(|exact| exact.errors.gathered > 0.0)?;
        let good = |row: &&Row| {
            let as_good = |a: f64, b: f64| a <= b * (1.0 + ALIKE);
            as_good(row.errors.gathered, exact.errors.gathered)
                && as_good(row.errors.elements, exact.errors.elements)
        };
        let loosest = TOLERANCES.into_iter().find_map(|t| Some((t, self.row(&self.parts(t)).filter(good)?)));
        let (size, exact_error) = (self.size, percent(exact.errors.gathered));
        let Some((tolerance, row)) = loosest else {
            return Some(format!(
                "With elements of {size} m no tolerance tried is as accurate as the exact matrix, whose error at points is {exact_error}."
            ));
        };
        Some(format!(
            "No tolerance below {tolerance} was needed: with elements of {size} m the exact matrix has an error at points of {exact_error} against {}, and takes {} instead of {}.",
            percent(row.errors.gathered),
            seconds(exact.flat().0),
            seconds(row.flat().0),
        ))
    }

    /// The loosest error bound of the exchange that changes nothing.
    fn error(&self) -> Option<String> {
        let default = self.default()?;
        let rows = self.with("--error");
        let loosest = rows.iter().find(|row| alike(row, default))?;
        (loosest.rounds < default.rounds).then(|| {
            format!(
                "An exchange to a proved 1e-6 was not needed: --error {} changes nothing measurable here, with {} instead of {} rounds.",
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
                "Rounds to a proved 1e-6: auto {}, {}. The light is the same.",
                default.rounds,
                ways.join(", ")
            )
        })
    }

    /// An option that changes the time alone.
    fn same_light(&self, option: &str, what: &str) -> Option<String> {
        let default = self.default()?;
        let rows = self.with(option);
        let times: Vec<String> =
            rows.iter().map(|row| format!("{} {}", row.setting.more[1], seconds(row.flat().0))).collect();
        (!rows.is_empty() && rows.iter().all(|row| alike(row, default))).then(|| {
            format!(
                "The {what} changes only the time: {} against {} by default.",
                times.join(", "),
                seconds(default.flat().0)
            )
        })
    }

    fn threads(&self) -> Option<String> {
        let (default, one) = (self.default()?, *self.with("--threads").first()?);
        Some(format!(
            "By the clock one thread takes {} and all threads {}.",
            seconds(one.seconds_solve),
            seconds(default.seconds_solve)
        ))
    }
}

/// Whether the errors of two runs are equal within [`ALIKE`].
fn alike(a: &Row, b: &Row) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= ALIKE * b;
    near(a.errors.gathered, b.errors.gathered) && near(a.errors.elements, b.errors.elements)
}

/// The work that a run skipped by itself.
fn left_out(run: &Run) -> Vec<String> {
    let facts = &run.facts;
    let reasons: Vec<String> =
        facts.blocks.coupling_left_out.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
    let mut sentences = vec![];
    if !reasons.is_empty() {
        sentences.push(format!("Skipped because it changes no light: {}.", reasons.join("; ")));
    }
    if facts.instances == 1 {
        sentences.push("The scene is one part: there was no light to exchange.".into());
    } else if facts.coarse_unknowns == 0 {
        sentences.push("The exchange needed no coarse space between parts.".into());
    }
    sentences
}
