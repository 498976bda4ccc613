//! The settings that reach a wanted error at the least cost. In goes a job and the error; out comes the job with an element
//! size and a tolerance, and what was learnt on the way.
//!
//! The scene is solved with coarse elements, then with ever finer ones, and light is gathered at the same points each time.
//! Errors at the edges of shadows are of the first order in the size of elements, so that each step is about half of the one
//! before, and all steps to come are together about as long as the last (Richardson 1911). The work is not lost: what was
//! solved last is what is chosen, and its form factors are in the cache.

use crate::account::refuse_endless_light;
use crate::classic::whole;
use crate::direct::with_direct;
use crate::equation::Equation;
use crate::exchange::{Outcome, exchange};
use crate::gather::sky::{Radiances, Sky};
use crate::observer::Unobserved;
use crate::points::{Place, PointLight, light};
use crate::run::Job;
use equilux_bake::elements::ElementSize;
use equilux_bake::equilibrium::subtract;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::prepare::{Preparation, Prepared, prepare};
use equilux_bake::treecode::Resolution;
use equilux_bake::world::World;
use equilux_formats::{Element, Error, Instance, Result, Rgb, Scene, Store};
use glam::DVec3;
use serde::Serialize;
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

/// What was chosen, and why.
#[derive(Debug, Clone, Serialize)]
pub struct Advice {
    /// The error asked for: of light at points of surfaces, root mean square over the mean, the worst channel.
    pub target: f64,
    /// Whether the estimate is as much below the target as caution asks for.
    pub met: bool,
    /// Largest edge of elements, m.
    pub element_size: f64,
    /// What clusters may do to the answer.
    pub tolerance: f64,
    /// The error expected at points, as lightmaps and tables of points have them.
    pub estimated: f64,
    /// The error expected where each element has one value, as pictures and models have them.
    pub estimated_of_elements: f64,
    /// The sizes that were tried, in order.
    pub tried: Vec<Trial>,
    /// Wall time of all trials.
    pub seconds: f64,
}

/// One size that was tried.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    /// Largest edge of elements, m.
    pub element_size: f64,
    /// Number of elements.
    pub elements: usize,
    /// How far light at points moved from the size before, root mean square over the mean; none of the first.
    pub moved: Option<f64>,
    /// Wall time.
    pub seconds: f64,
}

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
    let sky = job.sky.as_ref().map(Sky::read).transpose()?;
    let store = Store::open(&job.cache)?;
    let tolerance = (TOLERANCE.0 * target).min(TOLERANCE.1);
    let with = |element_size| {
        let resolution = Resolution::for_tolerance(tolerance);
        Job {
            preparation: Preparation { element_size, resolution, ..job.preparation.clone() },
            ..job.clone()
        }
    };
    let prepared = prepare(&scene, &with(None).preparation)?;
    let ElementSize::Metres(default) = prepared.element_size else {
        unreachable!("a default size is a length")
    };
    let places = spread(&prepared);
    let laboratory = Laboratory { scene: &scene, sky: sky.as_ref(), store: &store, places: &places, monitor };
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
    let mut last: Option<Sampled> = None;
    let mut size = COARSEST * default;
    loop {
        let began = Instant::now();
        let sampled = laboratory.sample(&with(Some(ElementSize::Metres(size))))?;
        let moved = last.as_ref().map(|last| off(&last.middles, &sampled.middles));
        let is_finer = last.as_ref().is_none_or(|last| last.elements < sampled.elements);
        let seconds = began.elapsed().as_secs_f64();
        advice.tried.push(Trial { element_size: size, elements: sampled.elements, moved, seconds });
        if !is_finer {
            // Every part says itself how large its elements are.
            break;
        }
        advice.take(size, &sampled);
        if advice.met || sampled.elements > MOST_ELEMENTS {
            break;
        }
        last = Some(sampled);
        size /= 2.0;
    }
    advice.seconds = start.elapsed().as_secs_f64();
    Ok((with(Some(ElementSize::Metres(advice.element_size))), advice))
}

impl Advice {
    /// What was chosen, for a person.
    pub fn lines(&self) -> Vec<String> {
        let percent = |error: f64| format!("{:.2} %", 100.0 * error);
        let tried = |trial: &Trial| {
            let moved = trial.moved.map_or(String::new(), |moved| format!(", moved by {}", percent(moved)));
            format!("{} m ({} elements{moved}, {:.2} s)", trial.element_size, trial.elements, trial.seconds)
        };
        let tried: Vec<String> = self.tried.iter().map(tried).collect();
        let found = if self.met {
            format!("light at points is expected to be off by {}", percent(self.estimated))
        } else if self.estimated.is_finite() {
            format!("NOT reached: light at points is expected to be off by {}", percent(self.estimated))
        } else {
            "NOT reached: every part says its own element size, so that nothing was learnt".into()
        };
        vec![
            format!("error asked for: {} of the mean in RMS; {found}", percent(self.target)),
            format!("with one value an element, as in pictures, by {}", percent(self.estimated_of_elements)),
            format!("tried {}", tried.join("; ")),
            format!("chosen: --element-size {} --tolerance {}", self.element_size, self.tolerance),
        ]
    }

    /// Take the last trial for what is chosen, and estimate what it errs by.
    fn take(&mut self, size: f64, sampled: &Sampled) {
        self.element_size = size;
        let Some(moved) = self.tried.last().and_then(|trial| trial.moved) else { return };
        self.estimated = moved;
        self.estimated_of_elements = off(&sampled.of_elements, &sampled.aside).hypot(self.estimated);
        self.met = CAUTION * self.estimated <= self.target;
    }
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
struct Laboratory<'a> {
    scene: &'a Scene,
    sky: Option<&'a Radiances>,
    store: &'a Store,
    places: &'a [Place],
    monitor: &'a Monitor,
}

impl Laboratory<'_> {
    /// Solve the scene with the elements that `job` asks for, and gather light at points.
    fn sample(&self, job: &Job) -> Result<Sampled> {
        let Self { scene, sky, store, places, monitor } = *self;
        let stopped = || {
            let remedy = "run the same command again: what was finished is in the cache";
            Error::new(&job.scene, "stopped before the settings were found", "a complete run", remedy)
        };
        let equation =
            Equation::of(job, scene, sky, prepare(scene, &job.preparation)?, store, monitor, &Unobserved)?;
        let elements = &equation.placed.world.elements;
        let nodes = equation.nodes();
        refuse_endless_light(&equation.placed, &nodes, &whole(&equation.driven), &job.scene)?;
        let Outcome { radiosity, mut irradiance, .. } = exchange(&nodes, job.method, job.goal, None, monitor);
        if monitor.stopped() {
            return Err(stopped());
        }
        let lights = light(&equation.gather(&radiosity), elements, places, monitor).ok_or_else(stopped)?;
        with_direct(&mut irradiance, &equation.direct.irradiance);
        let dark = [0.0; 3];
        let [middles, aside] =
            [0, 1].map(|first| lights.iter().skip(first).step_by(2).copied().collect::<Vec<_>>());
        let at_points = |lights: &[Option<PointLight>]| {
            lights.iter().map(|light| light.map_or(dark, |light| light.irradiance)).collect()
        };
        Ok(Sampled {
            middles: at_points(&middles),
            aside: at_points(&aside),
            of_elements: aside.iter().map(|l| l.map_or(dark, |l| irradiance[l.element])).collect(),
            elements: elements.len(),
        })
    }
}

/// The root mean square difference over the mean of the second; the worst channel.
fn off(values: &[Rgb], truth: &[Rgb]) -> f64 {
    let channel = |c: usize| {
        let squares: f64 = values.iter().zip(truth).map(|(&a, &b)| subtract(a, b)[c].powi(2)).sum();
        let sum: f64 = truth.iter().map(|light| light[c]).sum();
        let count = truth.len() as f64;
        if squares == 0.0 { 0.0 } else { (squares / count).sqrt() / (sum / count) }
    };
    (0..3).map(channel).fold(0.0, f64::max)
}
