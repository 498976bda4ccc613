//! Light units of known glTF exporters, identified by `asset.generator`.

use equilux_formats::LightUnits;

/// The name of Blender's exporter, before its version.
const BLENDER: &str = "Khronos glTF Blender I/O";

/// Its name until 2019, without a version.
const EARLY_BLENDER: &str = "Khronos Blender glTF 2.0";

/// The version in which it began to write candela and lux by default (lighting mode Standard: 683 lm/W, and 4π sr to a lamp).
/// Before, it wrote the watts of lamps as they were. Its other modes leave no trace in a file.
const IN_CANDELA: (u32, u32) = (3, 4);

/// The units of light intensities in a file written by `generator`. The specification requires candela and lux but
/// defines no luminous efficacy; numbers of unknown exporters are used unchanged, as radiometric units.
pub(super) fn light_units(generator: Option<&str>) -> LightUnits {
    let name = generator.unwrap_or_default();
    match name.strip_prefix(BLENDER).map(major_and_minor) {
        Some(Some(version)) if version < IN_CANDELA => LightUnits::BlenderRaw,
        Some(_) => LightUnits::Photometric,
        None if name.starts_with(EARLY_BLENDER) => LightUnits::BlenderRaw,
        None => LightUnits::Radiometric,
    }
}

/// The first two numbers of a version such as ` v3.4.50`.
fn major_and_minor(version: &str) -> Option<(u32, u32)> {
    let mut numbers = version.trim_start().strip_prefix('v')?.split('.');
    Some((numbers.next()?.parse().ok()?, numbers.next()?.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blender_wrote_watts_before_3_4_and_candela_since() {
        for (generator, units) in [
            (None, LightUnits::Radiometric),
            (Some("glTF-Transform v4.1.1"), LightUnits::Radiometric),
            (Some("Khronos glTF Blender I/O v1.8.19"), LightUnits::BlenderRaw),
            (Some("Khronos glTF Blender I/O v3.3.27"), LightUnits::BlenderRaw),
            (Some("Khronos glTF Blender I/O v3.4.50"), LightUnits::Photometric),
            (Some("Khronos glTF Blender I/O v3.10.1"), LightUnits::Photometric),
            (Some("Khronos glTF Blender I/O v4.2.60"), LightUnits::Photometric),
            (Some("Khronos glTF Blender I/O"), LightUnits::Photometric),
            (Some("Khronos Blender glTF 2.0 I/O"), LightUnits::BlenderRaw),
        ] {
            assert_eq!(light_units(generator), units, "{generator:?}");
        }
    }
}
