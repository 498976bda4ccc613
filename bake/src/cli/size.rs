//! Parses sizes such as `2GB` and `512 MiB`, and formats counts such as `1 file`.

/// Units in lower case, and their sizes in bytes.
const UNITS: [(&str, f64); 8] = [
    ("b", 1.0),
    ("kb", 1e3),
    ("mb", 1e6),
    ("gb", 1e9),
    ("tb", 1e12),
    ("kib", 1024.0),
    ("mib", 1048576.0),
    ("gib", 1073741824.0),
];

/// The number of bytes that `text` denotes.
pub fn parse(text: &str) -> Result<u64, String> {
    let unit_at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(unit_at);
    if unit.is_empty() && number.trim().parse::<f64>().is_ok_and(|number| number > 0.0) {
        return Err(format!("a size has a unit: write {0}GB, {0}MB or {0}B", number.trim()));
    }
    // Only zero needs no unit.
    let unit = if unit.is_empty() { "b" } else { unit };
    let scale = UNITS.iter().find(|(name, _)| unit.eq_ignore_ascii_case(name)).map(|(_, scale)| scale);
    match (number.trim().parse::<f64>(), scale) {
        (Ok(number), Some(scale)) if number >= 0.0 && number.is_finite() => Ok((number * scale) as u64),
        _ => Err("a size is a number of B, kB, MB, GB, TB, KiB, MiB or GiB, such as 2GB".into()),
    }
}

/// `1 file`, `2 files`.
pub fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_people_write_them() {
        let sizes = [("2GB", 2_000_000_000), ("1.5 kb", 1500), ("512MiB", 512 << 20), ("0", 0), ("77b", 77)];
        for (text, bytes) in sizes {
            assert_eq!(parse(text), Ok(bytes), "{text}");
        }
        for text in ["", "GB", "-1", "2", "1e9", "-1B", "2 XB", "nan", "inf", "1e400", "1 2"] {
            assert!(parse(text).is_err(), "{text}: {:?}", parse(text));
        }
        assert!(parse("2").is_err_and(|message| message.contains("2GB")), "{:?}", parse("2"));
    }
}
