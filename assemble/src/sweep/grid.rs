//! Which settings are tried, and in which order: a base point of defaults, sizes of elements times tolerances, everything
//! else one at a time, and the classic ways beside them. Coarse ones come first, so that little time gives a whole answer.

use super::setting::{DEFAULT_TOLERANCE, Kind, Setting};

/// Element sizes, in units of the scene's own, coarse to fine. Each has twice the elements of the one before.
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

/// The default, those near it, and the exact matrix, which takes longest.
const TOLERANCES: [f64; 6] = [DEFAULT_TOLERANCE, 0.003, 0.001, 0.03, 0.1, 0.0];

/// Rays a pair of the classic matrix.
const RAYS: [u32; 3] = [1, 4, 16];

/// One at a time, with everything else as by default.
const ALONE: [&str; 12] = [
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

/// A size in metres as a person would write it.
pub fn metres(size: f64) -> f64 {
    format!("{size:.2e}").parse().unwrap_or(size)
}

/// All settings, the most telling first. `size` is the scene's own, metres.
pub fn grid(size: f64) -> Vec<Setting> {
    SIZES.into_iter().flat_map(|factor| at_size(metres(size * factor), factor)).collect()
}

/// The settings with elements of a size, metres, that is `factor` times the scene's own.
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
