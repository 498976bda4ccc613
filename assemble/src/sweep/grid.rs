//! The settings of a sweep, in order: element sizes times tolerances, all other options one at a time at the default
//! settings, and the classic methods. Coarse settings come first, so that a small budget already gives a complete picture.

use super::setting::{DEFAULT_TOLERANCE, Kind, Setting};

/// Element sizes, as multiples of the scene's default, coarse to fine. Each has about twice the elements of the one before.
pub const SIZES: [f64; 8] = [
    4.0,
    2.0 * std::f64::consts::SQRT_2,
    2.0,
    std::f64::consts::SQRT_2,
    1.0,
    std::f64::consts::FRAC_1_SQRT_2,
    0.5,
    0.5 * std::f64::consts::FRAC_1_SQRT_2,
];

/// Tolerances: the default, with 256 rays a row, those with 1024, 4096 and 64, and the exact matrix, which takes longest.
const TOLERANCES: [f64; 5] = [DEFAULT_TOLERANCE, 0.003, 0.001, 0.03, 0.0];

/// Rays for each pair of elements in the classic matrix.
const RAYS: [u32; 3] = [1, 4, 16];

/// Options that are tried one at a time, with the default settings otherwise.
const ALONE: [&str; 13] = [
    "--rows exact",
    "--exchange jacobi",
    "--exchange gauss-seidel",
    "--exchange gmres",
    "--error 0.01",
    "--error 0.001",
    "--local-solver direct",
    "--local-solver gauss-seidel",
    "--local-solver progressive",
    "--local-solver iterative",
    "--bisect 2",
    "--bisect 8",
    "--threads 1",
];

/// A size in metres, rounded to three significant digits.
pub fn metres(size: f64) -> f64 {
    format!("{size:.2e}").parse().unwrap_or(size)
}

/// All settings. `size` is the element size of the scene by default, metres.
pub fn grid(size: f64) -> Vec<Setting> {
    SIZES.into_iter().flat_map(|factor| at_size(metres(size * factor), factor)).collect()
}

/// The settings with elements of `size` metres, `factor` times the scene's default.
fn at_size(size: f64, factor: f64) -> Vec<Setting> {
    let at = |kind| Setting::new(kind, size);
    let mut settings: Vec<Setting> = TOLERANCES.map(|tolerance| at(Kind::Parts { tolerance })).into();
    if factor == 1.0 {
        settings.extend(ALONE.map(|option| at(Kind::Parts { tolerance: DEFAULT_TOLERANCE }).with(option)));
        settings.push(at(Kind::Parts { tolerance: 0.0 }).with("--exchange jacobi"));
    }
    if factor == 2.0 {
        let ways = ["--exchange jacobi", "--exchange auto"];
        settings.extend(ways.map(|way| at(Kind::Verified { tolerance: 0.0 }).with(way)));
        settings.extend([0.1, 0.001].map(|unshot| at(Kind::Progressive { unshot })));
    }
    if factor >= 1.0 {
        settings.extend([Kind::Dense, Kind::Progressive { unshot: 0.01 }].map(at));
        settings.extend(RAYS.map(|rays| at(Kind::Rays(rays))));
    }
    settings
}
