//! Lengths on the command line: plain numbers, metres. The error for `10cm` names what to write instead.

/// Units of length: (name, n, m) means that n of them are m metres.
const UNITS: [(&str, f64, f64); 9] = [
    ("um", 1e6, 1.0),
    ("mm", 1e3, 1.0),
    ("cm", 100.0, 1.0),
    ("dm", 10.0, 1.0),
    ("m", 1.0, 1.0),
    ("km", 1.0, 1e3),
    ("in", 1e4, 254.0),
    ("ft", 1e4, 3048.0),
    ("yd", 1e4, 9144.0),
];

/// The remedy for a message about lengths that cannot be parsed: `text`, one or several lengths such as `10cm`, `x=2ft`
/// or `1m,2m,3m`, in metres. Empty unless they have units.
pub fn in_metres(text: &str) -> String {
    let converted: Option<Vec<String>> = text.split(',').map(convert).collect();
    match converted.map(|parts| parts.join(",")) {
        Some(metres) if metres != text => format!("; for {text} write {metres}"),
        _ => String::new(),
    }
}

/// A length in metres, with the axis before it if there is one.
fn convert(text: &str) -> Option<String> {
    if let Some((axis, length)) = text.split_once('=') {
        return Some(format!("{axis}={}", convert(length)?));
    }
    let text = text.trim();
    let unit_at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(unit_at);
    let number: f64 = number.trim().parse().ok()?;
    if unit.is_empty() {
        return Some(number.to_string());
    }
    let (_, many, metres) = UNITS.iter().find(|(name, ..)| unit.eq_ignore_ascii_case(name))?;
    Some((number * metres / many).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_with_units_are_told_in_metres() {
        for (text, expected) in [
            ("10cm", "0.1"),
            ("7 cm", "0.07"),
            ("10mm", "0.01"),
            ("0.5M", "0.5"),
            ("2km", "2000"),
            ("1in", "0.0254"),
            ("3ft", "0.9144"),
            ("x=10cm", "x=0.1"),
            ("1m,160cm,-2m", "1,1.6,-2"),
        ] {
            assert_eq!(in_metres(text), format!("; for {text} write {expected}"), "{text}");
        }
        for text in ["coarse", "10", "1,2,3", "10 bananas", "cm", "", "nan", "x=1"] {
            assert_eq!(in_metres(text), "", "{text}");
        }
    }
}
