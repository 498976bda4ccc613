//! Bakes parts: computes the self block and local equilibrium of a part, or takes them from the cache.

pub mod batch;
pub mod cached;
pub mod depfile;
pub mod keys;
pub mod own_order;
pub mod placed_keys;
pub mod prepare;
pub mod stamp;

use crate::elements::{ElementSize, repainted};
use crate::equilibrium::endless::endless_in_block;
use crate::equilibrium::outside::boundary_responses;
use crate::equilibrium::{LocalSystem, factorise};
use crate::monitor::Monitor;
use crate::rays::alone::{AloneRows, alone};
use crate::rays::samples::Samples;
use crate::rays::surfaces::Surfaces;
use crate::treecode::{Request, Resolution, block};
use crate::world::World;
use cached::{Origin, cached, foreseen};
use equilux_formats::baked::{BakedGeometry, BakedLight, Escapes, LocalEquilibrium};
use equilux_formats::fingerprint::{Content, Digest, Key, Manifest};
use equilux_formats::{
    BakedPart, Element, Error, Geometry, Instance, LocalSolver, MaterialId, Optics, Result, Rgb, Rows, Store,
};
use glam::DAffine3;
use prepare::PreparedPart;
use rayon::prelude::*;
use std::path::Path;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Version of the form-factor code: part of every key, so that a change of the kernel bakes everything again.
pub const KERNEL_VERSION: u32 = 10;

/// A baked part, with origins and times.
#[derive(Debug)]
pub struct Baked {
    /// The part.
    pub part: BakedPart,
    /// Its surfaces for rays, made where they are first needed.
    pub surfaces: OnceLock<Arc<Surfaces>>,
    /// Key of its geometry and form factors.
    pub key: Key,
    /// Where its form factors came from.
    pub form_factors: Origin,
    /// Where its local equilibrium came from.
    pub light: Origin,
    /// Time spent on form factors, summed over threads.
    pub form_factor_time: Duration,
    /// Time spent on the local equilibrium.
    pub light_time: Duration,
}

impl Baked {
    /// Its surfaces for rays.
    pub fn surfaces(&self) -> Arc<Surfaces> {
        self.surfaces.get_or_init(|| Arc::new(Surfaces::new(&self.part.geometry))).clone()
    }
}

/// The settings and services for baking parts.
#[derive(Debug)]
pub struct Oven<'a> {
    /// The cache.
    pub store: &'a Store,
    /// The file that the parts come from, for messages and for the names of cached results.
    pub file: &'a Path,
    /// How exactly form factors are kept.
    pub resolution: Resolution,
    /// Progress, and the request to stop.
    pub monitor: &'a Monitor,
}

impl Oven<'_> {
    /// Reads the cached results of these parts in parallel, for later calls of [`Oven::bake`].
    pub fn read_ahead(&self, parts: &[PreparedPart]) {
        let of = |part: &PreparedPart| {
            let key = geometry_manifest(part, self.resolution).key();
            (key, light_manifest(key.into(), &part.optics, part.solver).key())
        };
        let (form_factors, lights): (Vec<Key>, Vec<Key>) = parts.par_iter().map(of).unzip();
        self.store.read_ahead::<BakedGeometry>(&form_factors);
        self.store.read_ahead::<BakedLight>(&lights);
    }

    /// Bakes one part, or takes its results from the cache. Fails if the monitor was stopped before its form factors
    /// were complete.
    pub fn bake(&self, part: &PreparedPart) -> Result<Baked> {
        let manifest = geometry_manifest(part, self.resolution);
        let key = manifest.key();
        let (mut form_factor_time, receivers) = (Duration::ZERO, part.geometry.unknowns().elements());
        let surfaces = OnceLock::new();
        let found = cached(self.store, &self.name(part, "form factors"), &manifest, self.monitor, || {
            self.monitor.begin(format!("form factors of {}", part.name), receivers, receivers as f64);
            let (self_block, escapes);
            (self_block, escapes, form_factor_time) = self.rows_alone(&part.geometry, &surfaces)?;
            Ok(BakedGeometry { geometry: without_materials(&part.geometry), self_block, escapes })
        });
        let (geometry, form_factors) = found?;
        if form_factors.is_reused() {
            self.monitor.spare(receivers as f64);
        }
        let start = Instant::now();
        let unlit = Unlit {
            name: &part.name,
            what: "light",
            key,
            geometry: &part.geometry,
            self_block: &geometry.self_block,
            solver: part.solver,
        };
        let (local, light_origin) = self.light(&unlit, &part.optics, |element| {
            part.materials[part.geometry.elements[element].material.index()].name.clone()
        })?;
        let part = BakedPart {
            name: part.name.clone(),
            geometry: part.geometry.clone(),
            optics: part.optics.clone(),
            tints: part.tints.clone(),
            materials: part.materials.clone(),
            self_block: geometry.self_block,
            escapes: geometry.escapes,
            local,
        };
        let light_time = start.elapsed();
        Ok(Baked { part, surfaces, key, form_factors, light: light_origin, form_factor_time, light_time })
    }

    /// The rows of a part alone, what their rays may still meet, and the time that they took, summed over threads. By rays also
    /// its surfaces.
    fn rows_alone(
        &self,
        geometry: &Geometry,
        surfaces: &OnceLock<Arc<Surfaces>>,
    ) -> Result<(Rows, Escapes, Duration)> {
        if let Some(patches) = &geometry.patches {
            let start = Instant::now();
            let surfaces = surfaces.get_or_init(|| Arc::new(Surfaces::new(geometry)));
            let AloneRows { self_block, escapes } =
                alone(surfaces, &Samples::new(patches.rays), self.monitor)?;
            return Ok((self_block, escapes, start.elapsed() * rayon::current_num_threads() as u32));
        }
        let world = World::new([(geometry, DAffine3::IDENTITY)]);
        let timed = block(&Request::of_self(&world, &[0], self.resolution), self.monitor)?;
        Ok((timed.block, Escapes::default(), timed.time))
    }

    /// The local equilibrium of a repainted instance, and its origin; none if the reflectance is that of the part, so
    /// that the factors and boundary responses of the part apply.
    pub fn relight(&self, baked: &Baked, instance: &Instance) -> Result<Option<(LocalEquilibrium, Origin)>> {
        let part = &baked.part;
        let optics = repainted(&part.geometry, &part.optics, &part.tints, &instance.repainted);
        if optics.reflectance == part.optics.reflectance {
            return Ok(None);
        }
        let unlit = Unlit {
            name: &instance.name,
            what: "repainted light",
            key: baked.key,
            geometry: &part.geometry,
            self_block: &part.self_block,
            solver: part.local.solver,
        };
        let material =
            |element: usize| part.materials[part.geometry.elements[element].material.index()].name.clone();
        self.light(&unlit, &optics, material).map(Some)
    }

    /// The local equilibrium of a part with these optics, and its origin. `material` returns the material name of an
    /// element, for messages.
    fn light(
        &self,
        part: &Unlit,
        optics: &Optics,
        material: impl Fn(usize) -> String,
    ) -> Result<(LocalEquilibrium, Origin)> {
        let manifest = light_manifest(part.key.into(), optics, part.solver);
        let name = self.named(part.name, part.what);
        let (light, origin) = cached(self.store, &name, &manifest, self.monitor, || {
            self.monitor.begin(format!("local equilibrium of {}", part.name), 0, 0.0);
            let of_unknowns = part.geometry.optics_of_unknowns(optics);
            if let Some(unknown) = endless_in_block(&of_unknowns, part.self_block, part.geometry.unknowns()) {
                return Err(self.endless_light(part.name, &material(part.geometry.element_of(unknown))));
            }
            let local = local_equilibrium(part.self_block, part.geometry, optics, part.solver);
            Ok(BakedLight { local, optics: optics.clone() })
        })?;
        Ok((light.local, origin))
    }

    /// The origin that the form factors of a part would have. Computes none of them.
    pub fn foresee(&self, part: &PreparedPart) -> Origin {
        let manifest = geometry_manifest(part, self.resolution);
        foreseen::<BakedGeometry>(self.store, &self.name(part, "form factors"), &manifest)
    }

    fn name(&self, part: &PreparedPart, what: &str) -> String {
        self.named(&part.name, what)
    }

    fn named(&self, name: &str, what: &str) -> String {
        format!("{what} of {name} in {}", self.file.display())
    }

    fn endless_light(&self, part: &str, material: &str) -> Error {
        Error::new(
            self.file,
            format!(
                "no equilibrium exists: part `{part}` is closed, reflects everything and emits (material `{material}`), so that its \
                 light grows without end"
            ),
            "a reflectance below 1 or an opening somewhere",
            "lower a base colour below 1, or switch the emission off",
        )
    }
}

/// A part with form factors, before its local equilibrium is solved.
struct Unlit<'a> {
    name: &'a str,
    /// The name of its light in the cache.
    what: &'a str,
    key: Key,
    geometry: &'a Geometry,
    self_block: &'a Rows,
    solver: LocalSolver,
}

/// Solves the local equilibrium, and computes its boundary responses and the factors of a direct solver.
pub fn local_equilibrium(
    block: &Rows,
    geometry: &Geometry,
    optics: &Optics,
    solver: LocalSolver,
) -> LocalEquilibrium {
    let (unknowns, optics) = (geometry.unknowns(), geometry.optics_of_unknowns(optics));
    let factors = factorise(block, unknowns, &optics.reflectance, solver);
    let system = LocalSystem::new(block, unknowns, &optics.reflectance, solver, factors.as_ref());
    let radiosity = system.solve(&optics.emission, &optics.emission);
    let answers = boundary_responses(&system, geometry);
    LocalEquilibrium { solver, radiosity, factors, answers }
}

/// The inputs of a part's form factors, and nothing else. Sizes are in the part's own units, so that instances of any
/// scale share them; reasons give sizes in metres of the scene.
pub fn geometry_manifest(part: &PreparedPart, resolution: Resolution) -> Manifest {
    let own_size = match part.element_size.in_units_of(part.unit) {
        // Scales are f32: six digits do not depend on their rounding.
        ElementSize::Metres(size) => format!("{size:.5e}"),
        ElementSize::Mesh => "mesh".into(),
    };
    Manifest::new()
        .setting("kernel", KERNEL_VERSION)
        .remark("element size", part.element_size)
        .detail("element size in the part's units", own_size)
        .setting("resolution", resolution)
        .digest("geometry", geometry_digest(&part.geometry))
}

/// The inputs of a part's local equilibrium.
pub fn light_manifest(form_factors: Digest, optics: &Optics, solver: LocalSolver) -> Manifest {
    Manifest::new()
        .digest("form factors", form_factors)
        .digest("reflectance", rgb_digest(&optics.reflectance))
        .digest("emission", rgb_digest(&optics.emission))
        .setting("local solver", format!("{solver:?}"))
}

/// The geometry without materials, on which form factors do not depend.
fn without_materials(geometry: &Geometry) -> Geometry {
    let bare = |element: &Element| Element { material: MaterialId(0), ..*element };
    Geometry {
        elements: geometry.elements.iter().map(bare).collect(),
        faces: geometry.faces.clone(),
        clusters: geometry.clusters.clone(),
        patches: geometry.patches.clone(),
    }
}

fn geometry_digest(geometry: &Geometry) -> Digest {
    let mut content = Content::new();
    for element in &geometry.elements {
        let corners = element.corners.as_slice().iter().flat_map(|p| p.to_array());
        content = content.f64s(&corners.collect::<Vec<_>>()).bytes(element.face.0.to_le_bytes());
    }
    for face in &geometry.faces {
        content = content.f64s(&face.corners.iter().flat_map(|p| p.to_array()).collect::<Vec<_>>());
    }
    for patch in geometry.patches.iter().flat_map(|patches| &patches.of) {
        content = content.bytes(patch.to_le_bytes());
    }
    content.digest()
}

fn rgb_digest(values: &[Rgb]) -> Digest {
    Content::new().f64s(&Rgb::channels(values)).digest()
}
