//! The settings that reach a wanted error at the least cost. A job and a target error become the job with an element
//! size and a tolerance, and a record of the trials.
//!
//! The scene is solved with coarse elements, then with ever finer ones, and light is gathered at the same points each time.
//! Errors at the edges of shadows are of the first order in the size of elements, so that each step is about half of the one
//! before, and all steps to come are together about as long as the last (Richardson 1911). The work is not lost: what was
//! solved last is what is chosen, and its form factors are in the cache.

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
use equilux_bake::prepare::{Preparation, Prepared, prepare};
use equilux_bake::treecode::Resolution;
use equilux_bake::world::World;
use equilux_formats::{Element, Error, Instance, Result, Rgb, Scene, Store};
use glam::DVec3;
use std::time::Instant;

/// Points at which light is asked for, each inside another element of the default size. In the middles of half of them light is
/// compared from size to size: closer to where things touch it may change without end, and a single point would decide. Those
/// towards a corner tell how far an element's one value is from the light on it.
const POINTS: usize = 1500;

/// So far towards a corner, where no middle is of an element of half the size.
const ASIDE: f64 = 1.0 / 3.0;

/// The first elements are this many times as long as those of the default size.
const COARSEST: f64 = 4.0;

/// Each size is half of the one before; the last is that which makes more elements than this, about which minutes are spent.
const MOST_ELEMENTS: usize = 50_000;

/// The share of the error asked for that the tolerance may take, and the most it may be: what clusters do to light was
/// measured to be half of that.
const TOLERANCE: (f64, f64) = (0.3, 0.03);

/// What is estimated from a few sizes may be off by this factor.
const CAUTION: f64 = 1.5;

/// Light at points, of one size.
struct Sampled {
    /// W/m² in middles.
    middles: Vec<Rgb>,
    /// W/m² towards corners.
    aside: Vec<Rgb>,
    /// W/m² of the elements there.
    of_elements: Vec<Rgb>,
    /// How many elements there are in all.
    elements: usize,
}

/// Find the settings for an error of `target`, and the job with them. Fails where the job would, and when it is stopped.
pub fn advise(job: &Job, target: f64, monitor: &Monitor) -> Result<(Job, Advice)> {
    let start = Instant::now();
    let scene = import_scene(&job.scene)?;
    job.check(&scene)?;
    job.tables(DVec3::ZERO)?;
    let store = Store::open(&job.settings.cache)?;
    let tolerance = (TOLERANCE.0 * target).min(TOLERANCE.1);
    let with = |element_size| {
        let resolution = Resolution::for_tolerance(tolerance);
        let preparation = Preparation { element_size, resolution, ..job.settings.preparation.clone() };
        SolveSettings { preparation, warm: false, ..job.settings.clone() }
    };
    let prepared = prepare(&scene, &with(None).preparation)?;
    let ElementSize::Metres(default) = prepared.element_size else {
        unreachable!("a default size is a length")
    };
    let places = spread(&prepared);
    let trials = Trials { scene: &scene, store: &store, places: &places, monitor };
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
    refine(&mut advice, COARSEST * default, |size| trials.sample(&with(Some(ElementSize::Metres(size)))))?;
    advice.seconds = start.elapsed().as_secs_f64();
    let settings =
        SolveSettings { warm: job.settings.warm, ..with(Some(ElementSize::Metres(advice.element_size))) };
    Ok((Job { settings, ..job.clone() }, advice))
}

/// Try `size`, m, and ever half of it, until the target is met, elements are too many, or do not become finer.
fn refine(advice: &mut Advice, mut size: f64, sample: impl Fn(f64) -> Result<Sampled>) -> Result<()> {
    let mut last: Option<Sampled> = None;
    loop {
        let began = Instant::now();
        let sampled = sample(size)?;
        let moved = last.as_ref().map(|last| off(&last.middles, &sampled.middles));
        let is_finer = last.as_ref().is_none_or(|last| last.elements < sampled.elements);
        let seconds = began.elapsed().as_secs_f64();
        advice.tried.push(Trial { element_size: size, elements: sampled.elements, moved, seconds });
        if !is_finer {
            // Every part has an element size of its own.
            return Ok(());
        }
        choose_last(advice, size, &sampled);
        if advice.met || sampled.elements > MOST_ELEMENTS {
            return Ok(());
        }
        last = Some(sampled);
        size /= 2.0;
    }
}

/// Choose the last trial, and estimate its error.
fn choose_last(advice: &mut Advice, size: f64, sampled: &Sampled) {
    advice.element_size = size;
    let Some(moved) = advice.tried.last().and_then(|trial| trial.moved) else { return };
    advice.estimated = moved;
    advice.estimated_of_elements = off(&sampled.of_elements, &sampled.aside).hypot(moved);
    advice.met = CAUTION * moved <= advice.target;
}

/// Places on elements, each for the same share of the area: in turn a middle and one towards a corner.
fn spread(prepared: &Prepared) -> Vec<Place> {
    let placed = |i: &Instance| (&prepared.parts[i.part.index()].geometry, i.placement);
    let elements = World::new(prepared.instances.iter().map(placed)).elements;
    let whole: f64 = elements.iter().map(|element| element.area).sum();
    let share = |area: f64| (area / whole * POINTS as f64).floor();
    let mut before = 0.0;
    let chosen = elements.iter().filter(|element| {
        let after = before + element.area;
        share(after) > share(std::mem::replace(&mut before, after))
    });
    let place = |(k, element): (usize, &Element)| {
        let aside = element.centroid.lerp(element.corners.as_slice()[0], ASIDE);
        let point = if k % 2 == 0 { element.centroid } else { aside };
        Place { point, normal: element.normal }
    };
    chosen.enumerate().map(place).collect()
}

/// What all trials share.
struct Trials<'a> {
    scene: &'a Scene,
    store: &'a Store,
    places: &'a [Place],
    monitor: &'a Monitor,
}

impl Trials<'_> {
    /// Solve the scene with the elements of `settings`, and gather light at points.
    fn sample(&self, settings: &SolveSettings) -> Result<Sampled> {
        let Self { scene, store, places, monitor } = *self;
        let prepared = prepare(scene, &settings.preparation)?;
        let solved = solve_prepared(scene, prepared, settings, store, monitor, &Unobserved)?;
        if monitor.stopped() {
            return Err(Error::Stopped);
        }
        let lights = light(&solved.gather(), solved.elements(), places, monitor)?;
        Ok(Sampled::of(&lights, &solved))
    }
}

impl Sampled {
    /// Light at places, in turn a middle and one towards a corner, in a solved scene.
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

/// The root mean square difference over the mean of the second; the worst channel.
fn off(values: &[Rgb], truth: &[Rgb]) -> f64 {
    weighted_rms_over_mean(values.iter().zip(truth).map(|(&a, &b)| (a - b, b, 1.0)))
}
