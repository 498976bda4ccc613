//! Prepared part → [`BakedPart`]: its own block of form factors and its local equilibrium, from the cache if there.

pub mod batch;
pub mod cached;
pub mod depfile;
pub mod keys;
pub mod prepare;
pub mod stamp;

use crate::elements::{ElementSize, repainted};
use crate::equilibrium::endless::endless_in_block;
use crate::equilibrium::outside::boundary_responses;
use crate::equilibrium::{LocalSystem, factorise};
use crate::monitor::Monitor;
use crate::treecode::{Request, Resolution, block};
use crate::world::World;
use cached::{Origin, cached, foreseen};
use equilux_formats::{
    BakedGeometry, BakedLight, BakedPart, Content, Digest, Element, Error, Geometry, Instance, Key,
    LocalEquilibrium, LocalSolver, Manifest, MaterialId, Optics, Result, Rgb, Rows, Store,
};
use glam::DAffine3;
use prepare::PreparedPart;
use rayon::prelude::*;
use std::path::Path;
use std::time::{Duration, Instant};

/// Version of the form-factor code: part of every key, so that a change of the kernel bakes everything again.
pub const KERNEL_VERSION: u32 = 6;

/// A baked part and how it came about.
#[derive(Debug)]
pub struct Baked {
    /// The part.
    pub part: BakedPart,
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

/// What surrounds the baking of a part.
#[derive(Debug)]
pub struct Oven<'a> {
    /// The cache.
    pub store: &'a Store,
    /// The file that the parts come from, for messages and for remembering what was baked last.
    pub file: &'a Path,
    /// How exactly form factors are kept.
    pub resolution: Resolution,
    /// Progress and the wish to stop.
    pub monitor: &'a Monitor,
}

impl Oven<'_> {
    /// Read at once what the cache has of these parts: [`Oven::bake`] asks for one after the other.
    pub fn read_ahead(&self, parts: &[PreparedPart]) {
        let of = |part: &PreparedPart| {
            let key = geometry_manifest(part, self.resolution).key();
            (key, light_manifest(key.into(), &part.optics, part.solver).key())
        };
        let (form_factors, lights): (Vec<Key>, Vec<Key>) = parts.par_iter().map(of).unzip();
        self.store.read_ahead::<BakedGeometry>(&form_factors);
        self.store.read_ahead::<BakedLight>(&lights);
    }

    /// Bake one part, or take from the cache what is there. Fails if the monitor was stopped before its form factors were
    /// known.
    pub fn bake(&self, part: &PreparedPart) -> Result<Baked> {
        let manifest = geometry_manifest(part, self.resolution);
        let key = manifest.key();
        let (mut form_factor_time, receivers) = (Duration::ZERO, part.geometry.elements.len());
        let found = cached(self.store, &self.name(part, "form factors"), &manifest, self.monitor, || {
            self.monitor.begin(format!("form factors of {}", part.name), receivers, receivers as f64);
            let world = World::new([(&part.geometry, DAffine3::IDENTITY)]);
            let request = Request::of_self(&world, &[0], self.resolution);
            let timed = block(&request, self.monitor)?;
            form_factor_time = timed.time;
            Ok(BakedGeometry { geometry: without_materials(&part.geometry), self_block: timed.block })
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
            local,
        };
        let light_time = start.elapsed();
        Ok(Baked { part, key, form_factors, light: light_origin, form_factor_time, light_time })
    }

    /// The light of a baked part on its own as an instance has it repainted, and where that came from; none if the part's
    /// serves: it tells how the part answers light, which depends on reflectance alone.
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

    /// The light of a part with these optics. `material` names that of an element, for messages.
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
            if let Some(element) = endless_in_block(optics, part.self_block, &part.geometry.clusters) {
                return Err(self.endless_light(part.name, &material(element)));
            }
            let local = local_equilibrium(part.self_block, part.geometry, optics, part.solver);
            Ok(BakedLight { local, optics: optics.clone() })
        })?;
        Ok((light.local, origin))
    }

    /// Where the form factors of a part would come from. Computes none of them.
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
                "part `{part}` is closed, reflects everything and emits (material `{material}`): its light grows without end"
            ),
            "a reflectance below 1 or an opening somewhere",
            "lower a base colour below 1, or switch the emission off",
        )
    }
}

/// A part whose form factors are known, and what it is called.
struct Unlit<'a> {
    name: &'a str,
    /// What its light is called in the cache.
    what: &'a str,
    key: Key,
    geometry: &'a Geometry,
    self_block: &'a Rows,
    solver: LocalSolver,
}

/// The part's light with nothing arriving from outside, its answers to what arrives, and what its solver wants kept.
pub fn local_equilibrium(
    block: &Rows,
    geometry: &Geometry,
    optics: &Optics,
    solver: LocalSolver,
) -> LocalEquilibrium {
    let clusters = &geometry.clusters;
    let factors = factorise(block, clusters, &optics.reflectance, solver);
    let system = LocalSystem::new(block, clusters, &optics.reflectance, solver, factors.as_ref());
    let radiosity = system.solve(&optics.emission, &optics.emission);
    let answers = boundary_responses(&system, geometry);
    LocalEquilibrium { solver, radiosity, factors, answers }
}

/// Everything that the part's own form factors depend on, and nothing else. Sizes are in the part's own units, so that it is baked
/// once however large it stands; reasons mention them in metres of the scene.
pub fn geometry_manifest(part: &PreparedPart, resolution: Resolution) -> Manifest {
    let own_size = match part.element_size.in_units_of(part.unit) {
        // Scales are f32: six digits are the same however they are rounded.
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

/// Everything that the part's own light depends on.
pub fn light_manifest(form_factors: Digest, optics: &Optics, solver: LocalSolver) -> Manifest {
    Manifest::new()
        .digest("form factors", form_factors)
        .digest("reflectance", rgb_digest(&optics.reflectance))
        .digest("emission", rgb_digest(&optics.emission))
        .setting("local solver", format!("{solver:?}"))
}

/// The geometry as form factors know it: they stay when a wall gets another material.
fn without_materials(geometry: &Geometry) -> Geometry {
    let bare = |element: &Element| Element { material: MaterialId(0), ..*element };
    Geometry {
        elements: geometry.elements.iter().map(bare).collect(),
        faces: geometry.faces.clone(),
        clusters: geometry.clusters.clone(),
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
    content.digest()
}

fn rgb_digest(values: &[Rgb]) -> Digest {
    Content::new().f64s(&Rgb::channels(values)).digest()
}
