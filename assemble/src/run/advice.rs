//! Finds the element size and the tolerance that reach a target error at the least cost. Input: a job and a target
//! error. Output: the job with these settings, and a record of the trials.
//!
//! The scene is solved with coarse elements, then with ever finer ones, and light is gathered at the same points each
//! time. Errors at the edges of shadows are of first order in the element size, so each change is about half of the
//! previous one, and all later changes together are about as large as the last (Richardson 1911). No work is lost:
//! the last trial is the chosen one, and its form factors are in the cache.

use crate::equation::environment::Environment;
use crate::exchange::listener::Unobserved;
use crate::gather::points::{Place, PointLight, light};
use crate::report::advice::{Advice, Trial};
use crate::run::job::Job;
use crate::solve::settings::SolveSettings;
use crate::solve::{Solved, solve_prepared};
use crate::statistics::weighted_rms_over_mean;
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Preparation, Prepared, prepare};
use equilux_bake::treecode::{Resolution, rays_for_tolerance};
use equilux_bake::world::World;
use equilux_formats::{Element, Error, Instance, Result, Rgb, Scene, Store};
use glam::DVec3;
use std::time::Instant;

/// Number of points at which light is compared, each in a different element of the default size. Half of them are
/// centroids, where light is compared from size to size: closer to contacts light may change without limit, and a
/// single point would dominate. The others lie towards a corner and measure the difference between an element's
/// single value and the light at a point.
const SAMPLE_POINTS: usize = 1500;

/// Position of the other points, as a share of the way from the centroid to a corner: not the centroid of an element
/// of half the size.
const CORNER_SHARE: f64 = 1.0 / 3.0;

/// Size of the first elements, relative to the default size.
const COARSEST_FACTOR: f64 = 4.0;

/// The search, which halves the size each time, ends when there are more elements than this; a solution then takes
/// minutes.
const MAX_ELEMENTS: usize = 50_000;

/// Tolerance as a share of the target error, and its maximum. The number of rays follows from it, and the light at points
/// is much less noisy than single rows.
const TOLERANCE_SHARE: f64 = 0.3;
/// See [`TOLERANCE_SHARE`].
const MAX_TOLERANCE: f64 = 0.03;

/// Safety factor on an error that is estimated from a few sizes.
const SAFETY_FACTOR: f64 = 1.5;

/// Light at the points for one element size.
struct SampledLight {
    /// Irradiance at centroids, W/m².
    middles: Vec<Rgb>,
    /// Irradiance at the points towards corners, W/m².
    aside: Vec<Rgb>,
    /// Irradiance of the elements at these points, W/m².
    of_elements: Vec<Rgb>,
    /// Number of elements.
    elements: usize,
}

/// Find the settings for an error of `target`, and apply them to the job. Fails where the job would, and if it is
/// stopped.
pub fn advise(job: &Job, target: f64, monitor: &Monitor) -> Result<(Job, Advice)> {
    let start = Instant::now();
    let scene = import_scene(&job.scene)?;
    job.check(&scene)?;
    job.tables(DVec3::ZERO)?;
    let environment = job.settings.environment()?;
    let store = Store::open(&job.settings.cache)?;
    let tolerance = (TOLERANCE_SHARE * target).min(MAX_TOLERANCE);
    let with = |element_size| {
        let resolution = Resolution::for_tolerance(tolerance);
        let rays = rays_for_tolerance(tolerance);
        let preparation = Preparation { element_size, resolution, rays, ..job.settings.preparation.clone() };
        SolveSettings { preparation, warm: false, ..job.settings.clone() }
    };
    let prepared = prepare(&scene, &with(None).preparation)?;
    let ElementSize::Metres(default) = prepared.element_size else {
        unreachable!("a default size is a length")
    };
    let places = spread(&prepared);
    let trials =
        TrialInputs { scene: &scene, environment: &environment, store: &store, places: &places, monitor };
    let mut advice = Advice {
        target,
        met: false,
        element_size: default,
        tolerance,
        estimated: f64::INFINITY,
        estimated_of_elements: f64::INFINITY,
        tried: vec![],
        seconds: 0.0,
    };
    refine(&mut advice, COARSEST_FACTOR * default, |size| {
        trials.sample(&with(Some(ElementSize::Metres(size))))
    })?;
    advice.seconds = start.elapsed().as_secs_f64();
    let settings =
        SolveSettings { warm: job.settings.warm, ..with(Some(ElementSize::Metres(advice.element_size))) };
    Ok((Job { settings, ..job.clone() }, advice))
}

/// Try `size`, m, and repeatedly half of it, until the target is met, there are too many elements, or elements do not
/// become finer.
fn refine(advice: &mut Advice, mut size: f64, sample: impl Fn(f64) -> Result<SampledLight>) -> Result<()> {
    let mut last: Option<SampledLight> = None;
    loop {
        let began = Instant::now();
        let sampled = sample(size)?;
        let moved = last.as_ref().map(|last| off(&last.middles, &sampled.middles));
        let is_finer = last.as_ref().is_none_or(|last| last.elements < sampled.elements);
        let seconds = began.elapsed().as_secs_f64();
        advice.tried.push(Trial { element_size: size, elements: sampled.elements, moved, seconds });
        if !is_finer {
            // Every part has its own fixed element size.
            return Ok(());
        }
        choose_last(advice, size, &sampled);
        if advice.met || sampled.elements > MAX_ELEMENTS {
            return Ok(());
        }
        last = Some(sampled);
        size /= 2.0;
    }
}

/// Choose the last trial, and estimate its error.
fn choose_last(advice: &mut Advice, size: f64, sampled: &SampledLight) {
    advice.element_size = size;
    let Some(moved) = advice.tried.last().and_then(|trial| trial.moved) else { return };
    advice.estimated = moved;
    advice.estimated_of_elements = off(&sampled.of_elements, &sampled.aside).hypot(moved);
    advice.met = SAFETY_FACTOR * moved <= advice.target;
}

/// Places on elements, each representing the same share of the area: alternately a centroid and a point towards a
/// corner.
fn spread(prepared: &Prepared) -> Vec<Place> {
    let placed = |i: &Instance| (&prepared.parts[i.part.index()].geometry, i.placement);
    let elements = World::new(prepared.instances.iter().map(placed)).elements;
    let whole: f64 = elements.iter().map(|element| element.area).sum();
    let share = |area: f64| (area / whole * SAMPLE_POINTS as f64).floor();
    let mut before = 0.0;
    let chosen = elements.iter().filter(|element| {
        let after = before + element.area;
        share(after) > share(std::mem::replace(&mut before, after))
    });
    let place = |(k, element): (usize, &Element)| {
        let aside = element.centroid.lerp(element.corners.as_slice()[0], CORNER_SHARE);
        let point = if k % 2 == 0 { element.centroid } else { aside };
        Place { point, normal: element.normal }
    };
    chosen.enumerate().map(place).collect()
}

/// The inputs that all trials share.
struct TrialInputs<'a> {
    scene: &'a Scene,
    environment: &'a Environment,
    store: &'a Store,
    places: &'a [Place],
    monitor: &'a Monitor,
}

impl TrialInputs<'_> {
    /// Solve the scene with `settings`, and gather light at the points.
    fn sample(&self, settings: &SolveSettings) -> Result<SampledLight> {
        let Self { scene, environment, store, places, monitor } = *self;
        let prepared = prepare(scene, &settings.preparation)?;
        let solved = solve_prepared(scene, prepared, environment, settings, store, monitor, &Unobserved)?;
        if monitor.stopped() {
            return Err(Error::Stopped);
        }
        let gather = solved.gather();
        let lights = light(|points| gather.irradiance(points), solved.elements(), places, monitor)?;
        Ok(SampledLight::of(&lights, &solved))
    }
}

impl SampledLight {
    /// Light at alternating centroids and points towards corners of a solved scene.
    fn of(lights: &[Option<PointLight>], solved: &Solved) -> Self {
        let dark = Rgb::BLACK;
        let [middles, aside] =
            [0, 1].map(|first| lights.iter().skip(first).step_by(2).copied().collect::<Vec<_>>());
        let at_points = |lights: &[Option<PointLight>]| {
            lights.iter().map(|light| light.map_or(dark, |light| light.irradiance)).collect()
        };
        Self {
            middles: at_points(&middles),
            aside: at_points(&aside),
            of_elements: aside.iter().map(|l| l.map_or(dark, |l| solved.irradiance[l.element])).collect(),
            elements: solved.elements().len(),
        }
    }
}

/// The root mean square difference relative to the mean of `truth`; the worst channel.
fn off(values: &[Rgb], truth: &[Rgb]) -> f64 {
    weighted_rms_over_mean(values.iter().zip(truth).map(|(&a, &b)| (a - b, b, 1.0)))
}
