//! Each scene against light that another program found by other means: path tracing, which states its own noise
//! as standard errors. `scenes/<name>/truth.csv` holds one line an element; `scenes/README.md` says what its
//! columns mean.

mod texels;

use equilux_assemble::exchange::{Goal, Method};
use equilux_assemble::gather::outside::LightUnits;
use equilux_assemble::proof::sample::ExactRows;
use equilux_assemble::run::{Job, Pictures, run};
use equilux_bake::elements::ElementSize;
use equilux_bake::monitor::Monitor;
use equilux_bake::prepare::{Division, Preparation};
use equilux_bake::treecode::EXACT;
use equilux_tests::table::Table;
use glam::DVec3;
use std::fmt::{self, Display, Formatter};
use std::path::{Path, PathBuf};

/// What a path tracer and collocation at centroids may differ by once the noise is out: the light within a sender is
/// taken to be constant. Measured: 0.35 % to 0.83 %.
const TOLERANCE: f64 = 0.01;

#[test]
fn wood_is_lit_as_path_tracing_lights_it() {
    agrees("wood");
}

#[test]
fn shadow_is_lit_as_path_tracing_lights_it() {
    agrees("shadow");
}

#[test]
fn cornell_is_lit_as_path_tracing_lights_it() {
    agrees("cornell");
}

#[test]
fn corridor_is_lit_as_path_tracing_lights_it() {
    agrees("corridor");
}

fn agrees(name: &str) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name);
    let truth = Table::read(&folder.join("truth.csv"));
    let ours = assembled(&folder.join(name).with_extension("glb"));
    let found = gathered(&truth, places(&ours), |row| {
        (ours.number(row, "area"), ["H_r", "H_g", "H_b"].map(|colour| ours.number(row, colour)))
    });
    for (channel, colour) in ["r", "g", "b"].iter().enumerate() {
        let at_centroids =
            Errors::of(&truth, &found, ["Hc", "Hc_se"].map(|k| format!("{k}_{colour}")), channel);
        let averages = Errors::of(&truth, &found, ["Ha", "Ha_se"].map(|k| format!("{k}_{colour}")), channel);
        println!("{name} {colour}: {at_centroids}; averages over elements: {averages}");
        assert!(
            at_centroids.net() <= TOLERANCE,
            "{name}, channel {colour}: irradiance is {at_centroids} off, more than {TOLERANCE}"
        );
    }
}

/// The scene's elements with their light, each face of its mesh one element.
fn assembled(scene: &Path) -> Table {
    let folder = tempfile::tempdir().unwrap();
    let elements: PathBuf = folder.path().join("elements.csv");
    let job = Job {
        scene: scene.to_path_buf(),
        cache: folder.path().join("cache"),
        out: folder.path().join("out"),
        preparation: Preparation {
            resolution: EXACT,
            element_size: Some(ElementSize::Mesh),
            division: Division::Authored,
            local_solver: None,
        },
        method: Method::Auto,
        goal: Goal { error: 1e-6, rounds: usize::MAX },
        exact_rows: ExactRows::About(0),
        explain: false,
        verify: false,
        warm: false,
        pictures: Pictures::Rounds,
        elements: Some(elements.clone()),
        depfile: None,
        lightmaps: None,
        light_units: LightUnits::Radiometric,
        sky: None,
        cache_limit: None,
    };
    let report = run(&job, &Monitor::default()).unwrap();
    assert!(report.converged, "the exchange ended without the error asked for: {:?}", report.rounds.last());
    Table::read(&elements)
}

/// What we found on one element of the truth.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    /// m².
    area: f64,
    /// Power that arrives, W.
    power: [f64; 3],
}

/// Our elements summed over the truth's. The truth has quads; where the mesh's two triangles do not lie in one plane,
/// as on the red wall of `cornell`, we have two elements of one of its.
fn gathered(truth: &Table, ours: Vec<(DVec3, DVec3)>, of: impl Fn(usize) -> (f64, [f64; 3])) -> Vec<Found> {
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

/// For each of our elements the one of the truth that looks the same way and whose centroid is nearest.
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
fn places(table: &Table) -> Vec<(DVec3, DVec3)> {
    let (centroids, normals) = (table.vectors(["x", "y", "z"]), table.vectors(["nx", "ny", "nz"]));
    centroids.into_iter().zip(normals).collect()
}

/// Root of the mean square over all area, in units of the mean.
struct Errors {
    /// Of what we found against the truth.
    total: f64,
    /// The truth's own standard error.
    noise: f64,
}

impl Errors {
    /// Of the irradiance in the first column, whose standard error is in the second.
    fn of(truth: &Table, found: &[Found], [value, deviation]: [String; 2], channel: usize) -> Self {
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
    fn net(&self) -> f64 {
        (self.total * self.total - self.noise * self.noise).max(0.0).sqrt()
    }
}

impl Display for Errors {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        let percent = [self.net(), self.total, self.noise].map(|error| 100.0 * error);
        write!(f, "{:.2} % ({:.2} % with the truth's noise of {:.2} %)", percent[0], percent[1], percent[2])
    }
}
