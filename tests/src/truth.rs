//! Compares the light of this project with that of a path tracer, element by element of the path tracer's mesh.

use crate::table::Table;
use glam::DVec3;
use std::fmt::{self, Display, Formatter};

/// Our result on one element of the path tracer.
#[derive(Debug, Clone, Copy, Default)]
pub struct Found {
    /// m².
    pub area: f64,
    /// Power that arrives, W.
    pub power: [f64; 3],
}

/// Our elements summed over the truth's. The truth has quads; where the mesh's two triangles do not lie in one plane,
/// as on the red wall of `cornell`, we have two elements of one of its.
pub fn gathered(
    truth: &Table,
    ours: Vec<(DVec3, DVec3)>,
    of: impl Fn(usize) -> (f64, [f64; 3]),
) -> Vec<Found> {
    let mut found = vec![Found::default(); truth.rows()];
    for (row, owner) in owners(truth, ours).into_iter().enumerate() {
        let own = &mut found[owner];
        let (area, irradiance) = of(row);
        own.area += area;
        (0..3).for_each(|channel| own.power[channel] += area * irradiance[channel]);
    }
    for (row, own) in found.iter().enumerate() {
        let expected = truth.number(row, "area");
        // The truth is written with six digits.
        assert!(
            (own.area - expected).abs() <= 1e-5 * expected,
            "element {row} of the truth has {expected} m², we found {} m² of it",
            own.area
        );
    }
    found
}

/// For each of our elements, the path tracer's element that faces the same way and whose centroid is nearest.
fn owners(truth: &Table, ours: Vec<(DVec3, DVec3)>) -> Vec<usize> {
    let truth = places(truth);
    let owner = |(centroid, normal)| {
        let alike = (0..truth.len()).filter(|&i: &usize| truth[i].1.dot(normal) > 0.99);
        let distance = |i: usize| truth[i].0.distance_squared(centroid);
        let nearest = alike.min_by(|&i, &j| distance(i).total_cmp(&distance(j)));
        nearest.unwrap_or_else(|| panic!("no element of the truth looks like ours at {centroid}"))
    };
    ours.into_iter().map(owner).collect()
}

/// Where elements are, and where they look.
pub fn places(table: &Table) -> Vec<(DVec3, DVec3)> {
    let (centroids, normals) = (table.vectors(["x", "y", "z"]), table.vectors(["nx", "ny", "nz"]));
    centroids.into_iter().zip(normals).collect()
}

/// Root of the mean square over all area, in units of the mean.
#[derive(Debug)]
pub struct Errors {
    /// Of what we found against the truth.
    pub total: f64,
    /// The truth's own standard error.
    pub noise: f64,
}

impl Errors {
    /// Of the irradiance in the first column, whose standard error is in the second.
    pub fn of(truth: &Table, found: &[Found], [value, deviation]: [String; 2], channel: usize) -> Self {
        let over_area = |quantity: &dyn Fn(usize) -> f64| {
            let weighted: f64 = (0..truth.rows()).map(|i| found[i].area * quantity(i)).sum();
            weighted / found.iter().map(|own| own.area).sum::<f64>()
        };
        let mean = over_area(&|i| truth.number(i, &value));
        let off = |i: usize| found[i].power[channel] / found[i].area - truth.number(i, &value);
        Self {
            total: over_area(&|i| off(i).powi(2)).sqrt() / mean,
            noise: over_area(&|i| truth.number(i, &deviation).powi(2)).sqrt() / mean,
        }
    }

    /// What is left of the difference without the noise, which is independent of it.
    pub fn net(&self) -> f64 {
        (self.total * self.total - self.noise * self.noise).max(0.0).sqrt()
    }
}

impl Display for Errors {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let percent = [self.net(), self.total, self.noise].map(|error| 100.0 * error);
        write!(f, "{:.2} % ({:.2} % with the truth's noise of {:.2} %)", percent[0], percent[1], percent[2])
    }
}
