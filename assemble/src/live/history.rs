//! The curve of an exchange: errors over time. Input: all rounds. Output: a bounded number of points that look the
//! same on a logarithmic time axis.

use serde::Serialize;

/// A point is kept if the time since the start of the exchange is at least this factor times that of the last kept
/// point of the same group. A century of rounds of a microsecond each leaves fewer than 4000 points.
const MIN_TIME_RATIO: f64 = 1.01;

/// Error estimates after a round.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Point {
    /// The group of parts that exchange light with each other, in order; 1 for the first.
    pub group: usize,
    /// The round of that group; 1 for the first.
    pub round: usize,
    /// Time since the exchange began.
    pub seconds: f64,
    /// Error bound, W/m².
    pub bound: f64,
    /// The bound relative to the group's brightest radiosity.
    pub relative: f64,
    /// Largest residual, W/m².
    pub residual: f64,
}

/// The points of the curve in order.
#[derive(Debug, Default)]
pub struct History {
    kept: Vec<Point>,
    last: Option<Point>,
}

impl History {
    /// Add the next point.
    pub fn add(&mut self, point: Point) {
        let before = self.kept.last().filter(|before| before.group == point.group);
        if before.is_none_or(|before| point.seconds >= MIN_TIME_RATIO * before.seconds) {
            // The last point of a group's curve is always kept.
            let end = self.last.filter(|last| last.group != point.group && self.kept.last() != Some(last));
            self.kept.extend(end);
            self.kept.push(point);
        }
        self.last = Some(point);
    }

    /// The kept points, starting at index `from`.
    pub fn since(&self, from: usize) -> &[Point] {
        &self.kept[from.min(self.kept.len())..]
    }

    /// The newest point, kept or not.
    pub fn last(&self) -> Option<Point> {
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_million_rounds_leave_a_curve_that_is_short_and_complete() {
        let mut history = History::default();
        let point =
            |group, round: usize| Point { group, round, seconds: 1e-6 * round as f64, ..Point::default() };
        for (group, rounds) in [(1, 1_000_000), (2, 3)] {
            (1..=rounds).for_each(|round| history.add(point(group, round)));
        }
        let kept = history.since(0);
        // ln(10⁶) / ln 1.01 = 1389 steps, and both ends of both groups. The gaps below say that it is not too short.
        assert!(kept.len() <= 1389 + 4, "{} points kept", kept.len());
        assert!(
            kept.contains(&point(1, 1)) && kept.contains(&point(1, 1_000_000)) && kept.contains(&point(2, 1))
        );
        assert_eq!(history.last(), Some(point(2, 3)));
        for pair in kept.windows(2).filter(|pair| pair[0].group == pair[1].group && pair[0].round > 200) {
            let step = pair[1].seconds / pair[0].seconds;
            // A step that a round just misses is one round longer.
            assert!(step < MIN_TIME_RATIO + 0.006, "a gap of {step} after round {}", pair[0].round);
        }
    }
}
