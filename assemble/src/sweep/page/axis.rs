//! An axis of a chart: a range of values on a stretch of the drawing, and where its ticks and labels are. Logarithmic
//! axes have a tick at every power of ten and, where there is room, at 2 to 9 times it.

/// The largest number of decades in which ticks between the powers of ten are drawn.
const MINOR_DECADES: f64 = 6.0;

/// The digits that may have labels, the densest choice first.
const LABELLED_DIGITS: [&[u32]; 3] = [&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 5], &[1]];

/// What the values of an axis are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// Positive numbers, by their logarithm.
    Logarithmic,
    /// Whole numbers 1, 2, 3.
    Counting,
}

/// A range of values on a stretch of the drawing.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// The values at both ends.
    pub range: (f64, f64),
    /// The places of both ends, units of the drawing.
    pub places: (f64, f64),
    /// What the values are.
    pub scale: Scale,
}

/// A mark on an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Its value.
    pub value: f64,
    /// Whether it is a power of ten or a counted number: one that stands out.
    pub is_major: bool,
    /// Whether there is room for its value beside it.
    pub is_labelled: bool,
}

impl Axis {
    /// The place of a value, units of the drawing.
    pub fn at(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        let share = match self.scale {
            Scale::Counting => (value - low) / (high - low),
            Scale::Logarithmic => (value / low).ln() / (high / low).ln(),
        };
        self.places.0 + share.clamp(0.0, 1.0) * (self.places.1 - self.places.0)
    }

    /// All ticks, by rising value. `room` is what a label with this value needs along the axis, units of the drawing.
    pub fn ticks(&self, room: impl Fn(f64) -> f64) -> Vec<Tick> {
        match self.scale {
            Scale::Counting => self.counted(room),
            Scale::Logarithmic => self.logarithmic(room),
        }
    }

    fn counted(&self, room: impl Fn(f64) -> f64) -> Vec<Tick> {
        let (low, high) = (self.range.0.ceil() as i64, self.range.1.floor() as i64);
        let widest = room(high as f64);
        let apart = (self.at(1.0) - self.at(0.0)).abs().max((self.at(2.0) - self.at(1.0)).abs());
        let step = ((widest / apart).ceil() as i64).max(1);
        let tick = |k: i64| Tick { value: k as f64, is_major: true, is_labelled: (k - low) % step == 0 };
        (low..=high).map(tick).collect()
    }

    fn logarithmic(&self, room: impl Fn(f64) -> f64) -> Vec<Tick> {
        let (low, high) = self.range;
        let shown = |value: &f64| *value >= low * 0.999 && *value <= high * 1.001;
        let powers = || low.log10().floor() as i32..=high.log10().ceil() as i32;
        let values = |digits: &[u32], every: usize| -> Vec<f64> {
            let of = |power: i32| digits.iter().map(move |&digit| f64::from(digit) * 10f64.powi(power));
            powers().step_by(every).flat_map(of).filter(shown).collect()
        };
        let fit = |labels: &Vec<f64>| {
            let apart = |pair: &[f64]| (self.at(pair[1]) - self.at(pair[0])).abs();
            labels.windows(2).all(|pair| apart(pair) >= (room(pair[0]) + room(pair[1])) / 2.0)
        };
        let dense = LABELLED_DIGITS.iter().map(|digits| values(digits, 1)).find(fit);
        let labels = dense.or_else(|| (2..).map(|every| values(&[1], every)).find(fit)).unwrap_or_default();
        let digits = if (high / low).log10() > MINOR_DECADES { &[1] } else { LABELLED_DIGITS[0] };
        let tick = |value: f64| Tick {
            value,
            is_major: is_power_of_ten(value),
            is_labelled: labels.contains(&value),
        };
        values(digits, 1).into_iter().map(tick).collect()
    }
}

fn is_power_of_ten(value: f64) -> bool {
    let exponent = value.log10();
    (exponent - exponent.round()).abs() < 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(range: (f64, f64), length: f64) -> Vec<Tick> {
        Axis { range, places: (0.0, length), scale: Scale::Logarithmic }.ticks(|_| 40.0)
    }

    #[test]
    fn every_decade_has_a_labelled_tick_and_eight_between() {
        let ticks = ticks((0.01, 10.0), 400.0);
        assert_eq!(ticks.len(), 28, "{ticks:?}");
        let major: Vec<f64> = ticks.iter().filter(|tick| tick.is_major).map(|tick| tick.value).collect();
        assert_eq!(major, [0.01, 0.1, 1.0, 10.0]);
        assert!(ticks.iter().all(|tick| !tick.is_major || tick.is_labelled), "{ticks:?}");
    }

    #[test]
    fn labels_never_overlap() {
        for (range, length) in [((0.01, 10.0), 60.0), ((3.0, 4.5), 300.0), ((1e-16, 1.0), 300.0)] {
            let axis = Axis { range, places: (0.0, length), scale: Scale::Logarithmic };
            let labels: Vec<f64> =
                ticks(range, length).iter().filter(|t| t.is_labelled).map(|t| axis.at(t.value)).collect();
            assert!(!labels.is_empty(), "no label from {} to {}", range.0, range.1);
            assert!(labels.windows(2).all(|pair| pair[1] - pair[0] >= 40.0), "{labels:?}");
        }
    }
}
