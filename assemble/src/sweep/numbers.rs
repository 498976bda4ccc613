//! Numbers as people read them: shares, seconds, bytes and powers of ten, with two or three significant digits.

/// A share in per cent with two significant digits: `1.2 %`. A no-break space keeps the unit on the line of its number.
pub fn percent(share: f64) -> String {
    format!("{}\u{a0}%", two_digits(share * 100.0))
}

/// A number rounded to two significant digits, or to a whole number from 100 on: 0.061, 0.61, 6.1, 61, 610.
pub fn two_digits(value: f64) -> f64 {
    let rounded = format!("{value:.1e}").parse().unwrap_or(value);
    if value.abs() >= 100.0 { value.round() } else { rounded }
}

/// A duration in seconds with two or three significant digits: `1.20 s`, `35 ms`.
pub fn seconds(seconds: f64) -> String {
    match seconds {
        s if s >= 99.5 => format!("{s:.0} s"),
        s if s >= 9.95 => format!("{s:.1} s"),
        s if s >= 0.1 => format!("{s:.2} s"),
        s if s >= 9.95e-3 => format!("{:.0} ms", s * 1e3),
        s => format!("{:.1} ms", s * 1e3),
    }
}

/// A number of bytes in decimal units: `20 MB`.
pub fn bytes(value: f64) -> String {
    let (unit, name) = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")]
        .into_iter()
        .find(|(unit, _)| value >= *unit)
        .unwrap_or((1.0, "B"));
    let number = value / unit;
    if number >= 9.95 || number.fract() < 0.05 {
        format!("{number:.0}\u{a0}{name}")
    } else {
        format!("{number:.1}\u{a0}{name}")
    }
}

/// A digit times a power of ten: `10⁻⁶`, `2·10⁻⁶`.
pub fn power_of_ten(value: f64) -> String {
    let exponent = value.log10().floor();
    let digit = (value / 10f64.powf(exponent)).round();
    let (digit, exponent) = if digit >= 10.0 { (1.0, exponent + 1.0) } else { (digit, exponent) };
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    let power: String = format!("{exponent:.0}").chars().map(raised).collect();
    if digit == 1.0 { format!("10{power}") } else { format!("{digit}·10{power}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten_read_as_printed() {
        let written = [1e-6, 2e-10, 1.0, 9.96e3].map(power_of_ten);
        assert_eq!(written, ["10⁻⁶", "2·10⁻¹⁰", "10⁰", "10⁴"]);
    }
}
