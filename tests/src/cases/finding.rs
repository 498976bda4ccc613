//! Expected and actual result of a case.

/// Expected and actual result, and their distance.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// The expected result.
    pub expected: String,
    /// The actual result.
    pub got: String,
    /// The distance, in the unit of the case's tolerance. Infinite if a statement does not hold.
    pub error: f64,
    /// Rounds of exchange, where parts exchanged light.
    pub rounds: Option<usize>,
}

impl Finding {
    /// A finding of two things and their distance.
    pub fn of(expected: impl Into<String>, got: impl Into<String>, error: f64) -> Self {
        Self { expected: expected.into(), got: got.into(), error, rounds: None }
    }

    /// |got − expected|.
    pub fn absolute(expected: f64, got: f64) -> Self {
        Self::of(number(expected), number(got), (got - expected).abs())
    }

    /// |got / expected − 1|; between zeros 0.
    pub fn relative(expected: f64, got: f64) -> Self {
        Self::of(number(expected), number(got), relative_error(expected, got))
    }

    /// A statement that holds or not.
    pub fn statement(expected: impl Into<String>, got: impl Into<String>, holds: bool) -> Self {
        Self::of(expected, got, if holds { 0.0 } else { f64::INFINITY })
    }

    /// The pair (expected, got) that is furthest apart, relative to what is expected.
    pub fn worst_relative(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let far = |&(expected, got): &(f64, f64)| not_a_number_last(relative_error(expected, got));
        let worst = pairs.into_iter().max_by(|a, b| far(a).total_cmp(&far(b)));
        let (expected, got) = worst.expect("at least one value to judge");
        Self::relative(expected, got)
    }

    /// The pair (expected, got) that is furthest apart.
    pub fn worst_absolute(pairs: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let far = |&(expected, got): &(f64, f64)| not_a_number_last((got - expected).abs());
        let worst = pairs.into_iter().max_by(|a, b| far(a).total_cmp(&far(b)));
        let (expected, got) = worst.expect("at least one value to judge");
        Self::absolute(expected, got)
    }

    /// The worst of several.
    pub fn worst(findings: impl IntoIterator<Item = Self>) -> Self {
        let worst = findings
            .into_iter()
            .max_by(|a, b| not_a_number_last(a.error).total_cmp(&not_a_number_last(b.error)));
        worst.expect("at least one finding")
    }

    /// The same after so many rounds of exchange.
    pub fn after(self, rounds: Option<usize>) -> Self {
        Self { rounds, ..self }
    }
}

fn relative_error(expected: f64, got: f64) -> f64 {
    if got == expected { 0.0 } else { (got / expected - 1.0).abs() }
}

fn not_a_number_last(error: f64) -> f64 {
    if error.is_nan() { f64::INFINITY } else { error }
}

/// The shortest form of a number without loss of digits.
pub fn number(value: f64) -> String {
    let plain = value == 0.0 || (1e-3..1e6).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}
