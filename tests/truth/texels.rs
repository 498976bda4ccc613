//! Texels as large as the truth's elements against its averages over them: direct light exact over each, reflected light
//! from a coarse solution. The level is modelled coarsely, as levels are; only the truth is cut finely.

use equilux_tests::averages::{Compared, compared};

/// Largest RMS error of averages relative to the mean, without the truth's own noise.
const TOLERANCE: f64 = 0.01;

#[test]
fn texels_of_wood_have_the_averages_of_path_tracing() {
    agrees("wood", 0.125, 0.01);
}

#[test]
fn texels_of_shadow_have_the_averages_of_path_tracing() {
    agrees("shadow", 0.25, 0.01);
}

#[test]
fn texels_of_cornell_have_the_averages_of_path_tracing() {
    agrees("cornell", 0.5, 0.03);
}

/// The scene with elements of so many metres.
fn agrees(name: &str, size: f64, tolerance: f64) {
    let Compared { errors, .. } = compared(name, size, tolerance);
    for (errors, colour) in errors.iter().zip(["r", "g", "b"]) {
        println!("{name} {colour}: {errors}");
        assert!(
            errors.total <= TOLERANCE + errors.noise,
            "{name}, channel {colour}: averages are {errors} off, more than {TOLERANCE} and the noise"
        );
    }
}
