//! The reference of a sweep: irradiance at points, from a file or from the finest run.

use super::run::Run;
use crate::gather::points::places;
use crate::table::Table;
use equilux_formats::{Result, Rgb};
use glam::DVec3;
use std::path::Path;

/// Irradiance at points.
#[derive(Debug, Clone)]
pub struct Reference {
    /// The area that each point represents, in any unit.
    pub areas: Vec<f64>,
    /// W/m².
    pub irradiance: Vec<Rgb>,
    /// Standard error of that, W/m².
    pub noise: Vec<Rgb>,
}

/// The expected content of a table of truth, and the remedy in errors.
const EXPECTED: [&str; 2] = [
    "columns x, y, z, nx, ny, nz, area, Hc_r, Hc_g, Hc_b and, if there is noise, Hc_se_r, Hc_se_g, Hc_se_b, with a number in every line",
    "give a file as scenes/README.md describes it with --truth FILE.csv",
];

impl Reference {
    /// Read a table in the form of `scenes/*/truth.csv`: irradiance at the centroids of elements, with their areas. Fails if a
    /// column is missing, a number is not finite, or an area is not positive.
    pub fn read(path: &Path) -> Result<Self> {
        let table = Table::read(path, EXPECTED)?;
        places(&table, DVec3::ZERO)?;
        let areas = table.numbers("area")?;
        if let Some(row) = areas.iter().position(|&area| area <= 0.0) {
            return Err(table.wrong_line(row, &format!("has an area of {}", areas[row])));
        }
        let irradiance = table.colours(["Hc_r", "Hc_g", "Hc_b"])?;
        let noise = if table.has("Hc_se_r") {
            table.colours(["Hc_se_r", "Hc_se_g", "Hc_se_b"])?
        } else {
            vec![Rgb::BLACK; irradiance.len()]
        };
        Ok(Self { areas, irradiance, noise })
    }

    /// The light that a run gathered at points that represent equal areas.
    pub fn of(run: &Run) -> Self {
        let gathered = run.light.iter().map(|point| point.as_ref().map(|point| point.gathered));
        Self::without_noise(&vec![1.0; run.light.len()], gathered)
    }

    /// Light at points that represent these areas; points where it is unknown get an area of zero.
    pub fn without_noise(areas: &[f64], known: impl Iterator<Item = Option<Rgb>>) -> Self {
        let noise = vec![Rgb::BLACK; areas.len()];
        let (areas, irradiance) = areas
            .iter()
            .zip(known)
            .map(|(&area, known)| known.map_or((0.0, Rgb::BLACK), |irradiance| (area, irradiance)))
            .unzip();
        Self { areas, irradiance, noise }
    }

    /// The noise over the mean, in root mean square over area; the worst channel.
    pub fn noise_share(&self) -> f64 {
        let of = |c: usize| {
            let area: f64 = self.areas.iter().sum();
            let over = |values: &dyn Fn(usize) -> f64| {
                (0..self.areas.len()).map(|k| self.areas[k] * values(k)).sum::<f64>() / area
            };
            let mean = over(&|k| self.irradiance[k][c]);
            if mean > 0.0 { over(&|k| self.noise[k][c].powi(2)).sqrt() / mean } else { 0.0 }
        };
        (0..3).map(of).fold(0.0, f64::max)
    }

    /// The smallest error that can be told from zero, as a share of the mean. Subtracting the noise leaves its statistical
    /// error: the variance of a sum of n squares of standard normal numbers is 2n.
    pub fn resolves(&self) -> f64 {
        self.noise_share() * (2.0 / self.areas.len() as f64).powf(0.25)
    }
}
