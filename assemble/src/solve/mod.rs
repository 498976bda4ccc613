//! Solves a scene: its file → baked, placed and coupled parts, lights → radiosity in equilibrium.

mod last_light;
pub mod settings;

use crate::equation::Equation;
use crate::equation::environment::Environment;
use crate::equation::observer::Observer;
use crate::equation::reflected::ElementListener;
use crate::exchange::exchange;
use crate::exchange::listener::Unobserved;
use crate::exchange::outcome::Outcome;
use crate::gather::Gather;
use crate::proof::endless::refuse_endless_light;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::Oven;
use equilux_bake::oven::prepare::{Prepared, prepare};
use equilux_formats::{Element, Result, Rgb, Scene, Store};
use last_light::{keep, last_light};
use settings::SolveSettings;
use std::path::Path;

/// A solved scene.
#[derive(Debug)]
pub struct Solved {
    /// The radiosity equation.
    pub equation: Equation,
    /// The radiosity, the rounds of the exchange and the proved error.
    pub outcome: Outcome,
    /// Irradiance of all elements, including that of lamps, suns and sky, W/m², linear RGB.
    pub irradiance: Vec<Rgb>,
}

impl Solved {
    /// All elements in scene coordinates, instance after instance.
    pub fn elements(&self) -> &[Element] {
        &self.equation.placed.world.elements
    }

    /// Radiosity of all elements, W/m², linear RGB.
    pub fn radiosity(&self) -> &[Rgb] {
        &self.outcome.radiosity
    }

    /// This light, for evaluation at any point.
    pub fn gather(&self) -> Gather {
        self.equation.gather(&self.outcome.radiosity)
    }
}

/// Light the scene of a .gltf or .glb file. Fails if the file cannot be read, the cache cannot be used, or no equilibrium
/// exists.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// use equilux_assemble::{SolveSettings, solve};
/// use equilux_bake::elements::ElementSize;
///
/// let mut settings = SolveSettings { cache: folder.path().into(), ..SolveSettings::default() };
/// settings.preparation.element_size = Some(ElementSize::Metres(1.0));
/// let solved = solve("../scenes/house/house.gltf".as_ref(), &settings)?;
/// let brightest = solved.irradiance.iter().map(|h| h[1]).fold(0.0, f64::max);
/// println!("{} elements, up to {brightest:.1} W/m²", solved.elements().len());
/// assert!(solved.outcome.converged && brightest > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve(file: &Path, settings: &SolveSettings) -> Result<Solved> {
    let scene = import_scene(file)?;
    let prepared = prepare(&scene, &settings.preparation)?;
    let environment = settings.environment()?;
    let store = Store::open(&settings.cache)?;
    solve_prepared(&scene, prepared, &environment, settings, &store, &Monitor::default(), &Unobserved)
}

/// Like [`solve`], for a scene that is already divided into elements, reporting progress to `monitor` and `observer`.
/// Also fails if `monitor` is stopped before all form factors are available; a later stop ends the exchange after its
/// current round.
pub fn solve_prepared(
    scene: &Scene,
    prepared: Prepared,
    environment: &Environment,
    settings: &SolveSettings,
    store: &Store,
    monitor: &Monitor,
    observer: &dyn Observer,
) -> Result<Solved> {
    let (file, resolution) = (&scene.file, prepared.resolution);
    let oven = Oven { store, file, resolution, monitor };
    let equation = Equation::new(&oven, scene, prepared, environment, observer)?;
    let Equation { placed, coupled, optics, .. } = &equation;
    let systems = equation.systems();
    refuse_endless_light(placed, &systems, &equation.driven_optics(), file)?;
    observer.coupled_all(placed, coupled, optics);
    let start = if settings.warm { last_light(placed, store, file) } else { None };
    let start = start.map(|start| equation.start_from(&start));
    let listener = ElementListener { equation: &equation, listener: observer };
    let outcome = exchange(&systems, settings.method, settings.goal, start.as_deref(), monitor, &listener);
    drop(systems);
    let irradiance = equation.irradiance_of_elements(&outcome.irradiance);
    let outcome = equation.of_elements(outcome);
    if settings.warm {
        keep(placed, store, file, &outcome.radiosity)?;
    }
    Ok(Solved { equation, outcome, irradiance })
}
