//! Light on pieces of surface that are no unknowns, such as texels and points, where rows of the scene are counted rays.
//!
//! ```text
//! H = Σ_s F_s E_s + Σ_j k_j/R B'_j,   B'_j = ρ_j (D_j + H'_j)
//! ```
//!
//! Light with sharp shadows, of emitting surfaces, lamps and suns, has form factors of its own ([`sharp`]). All other light
//! arrives along R rays. Where a ray is long it brings the mean of the element on which it ends. A ray shorter than that element
//! is wide brings what the place reflects on which it ends ([`columns`]): its texture ρ_j, its own sharp light D_j, and the
//! element's mean H' of all other light. Rows do not depend on what lights send, nor on colours and textures.

mod at_points;
pub mod columns;
pub mod curve;
pub mod open_area;
pub mod sharp;

use crate::equation::coupling::Coupler;
use crate::gather::outside::frame;
use crate::gather::sky::SkyCells;
use crate::gather::surface_piece::cells;
use crate::placed_parts::PlacedParts;
use crate::solve::Solved;
use columns::{Column, Columns, polygon};
use curve::Curve;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::Oven;
use equilux_bake::rays::Ray;
use equilux_bake::rays::areas::{AreaRow, area_row};
use equilux_bake::rays::hemisphere::{Emitters, SurfacePoint};
use equilux_bake::rays::samples::Samples;
use equilux_bake::rays::scenery::{Landing, Scenery};
use equilux_bake::rays::sobol::hash;
use equilux_bake::rays::sources::Effort;
use equilux_bake::rays::surfaces::End;
use equilux_bake::textures::Coat;
use equilux_formats::{
    Corners, Element, Error, FaceId, Material, MaterialId, Result, Rgb, Rows, Scene, Store,
};
use glam::DVec3;
use open_area::{OpenArea, PlanePiece};
use rayon::prelude::*;
use sharp::{SharpLights, SharpRows};
use std::collections::{BTreeSet, HashMap};

/// Neighbouring places for which it is found out together what stands between them and a source.
const BUNDLE: usize = 64;

/// How far in front of its surface a piece is, as a share of the largest coordinate: corners are stored as f32.
const IN_FRONT: f64 = 1e-6;

/// A solved scene as pieces of surface see it.
#[derive(Debug)]
pub struct Receivers<'a> {
    /// The parts in their places.
    pub placed: &'a PlacedParts,
    /// Their surfaces for rays.
    pub scenery: &'a Scenery,
    /// Names and keys of blocks, the cache, and progress.
    pub coupler: Coupler<'a>,
    /// Columns of rows.
    pub columns: Columns,
    /// Light with sharp shadows.
    pub sharp: SharpLights<'a>,
    /// Rays of a row.
    pub samples: Samples,
    /// What elements send along rows, W/m².
    sent: Vec<Rgb>,
    /// What places on elements send along rows besides what they reflect, W/m².
    emitted: Vec<Rgb>,
    /// What elements receive besides sharp light, W/m².
    received: Vec<Rgb>,
    /// What the sky sends from its cells, W/m²; none without a sky.
    sky: Option<Vec<Rgb>>,
    /// By instance.
    materials: Vec<Vec<Material>>,
    /// By part; none if there are no textures.
    coats: Option<Vec<Coat<'a>>>,
    /// Made-up radiosities of elements, by instance, normal and place.
    proxies: Vec<[f64; 3]>,
    /// Widths of elements, metres.
    widths: Vec<f64>,
    /// Whether the run had been stopped before, which only ended the exchange.
    was_stopped: bool,
}

impl<'a> Receivers<'a> {
    /// A solved scene, for pieces of its surface with so many rays each; none if its rows are exact.
    pub fn new(
        scene: &'a Scene,
        solved: &'a Solved,
        store: &'a Store,
        rays: u32,
        monitor: &'a Monitor,
    ) -> Option<Self> {
        let equation = &solved.equation;
        let (placed, optics) = (&equation.placed, &equation.optics);
        let scenery = placed.scenery.as_deref()?;
        let oven = Oven { store, file: &scene.file, resolution: equation.resolution(), monitor };
        let sharp = SharpLights::new(equation);
        let emitted = if sharp.has_sources() {
            vec![Rgb::BLACK; optics.emission.len()]
        } else {
            optics.emission.clone()
        };
        let sent = solved.radiosity().iter().zip(&optics.emission).zip(&emitted);
        let sent = sent.map(|((&b, &e), &along)| b - e + along).collect();
        let sharp_of = |(k, own): (usize, &Vec<Rgb>)| -> Vec<Rgb> {
            let elements = 0..placed.world.elements_of(k).len();
            elements.map(|element| own[placed.unknown_of(k, element)]).collect()
        };
        let sharp_on = equation.direct.sharp.iter().enumerate().flat_map(sharp_of);
        let received = solved.irradiance.iter().zip(sharp_on).map(|(&h, sharp)| h - sharp).collect();
        let sky = equation.lights.sky.as_ref();
        let sky = sky.map(|(dome, sends)| SkyCells::radiosity(dome, sends, frame(&placed.world).0));
        let materials = scene.instances.iter().map(|i| i.materials(&scene.parts[i.part.index()].materials));
        let textured = scene.parts.iter().any(|part| !part.textured.is_empty());
        let coats = || scene.parts.iter().map(|part| Coat::new(&part.materials, &part.textured)).collect();
        Some(Self {
            placed,
            scenery,
            coupler: Coupler::new(&oven, placed),
            columns: Columns::new(placed.world.elements.len()),
            sharp,
            samples: Samples::new(rays),
            sent,
            emitted,
            received,
            sky,
            materials: materials.collect(),
            coats: textured.then(coats),
            proxies: proxies(placed),
            was_stopped: monitor.stopped(),
            widths: placed.world.elements.iter().map(|element| element.area.sqrt()).collect(),
        })
    }

    /// Fails if the run was stopped since the exchange.
    pub fn check_stopped(&self) -> Result<()> {
        if self.coupler.monitor.stopped() && !self.was_stopped { Err(Error::Stopped) } else { Ok(()) }
    }

    /// What the rays of a piece of an instance end on, in its coordinates. `number` chooses the rays.
    /// `least`: the size of the smallest places that count as such, metres.
    pub fn row(&self, instance: usize, area: (&Emitters, u32), least: f64) -> AreaRow {
        let scale = self.placed.instances[instance].scale();
        area_row(self.scenery, &self.samples, instance, area, &|ray, landing| {
            self.column(instance, ray, landing, [scale, least])
        })
    }

    /// What would arrive along a row if each side of each instance had made-up radiosities of its own, between 0 and 1, on three channels. It
    /// changes from place to place about as light does, but follows from geometry alone.
    pub fn proxy(&self, row: &AreaRow) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &(column, count) in &row.counts {
            let sent = match self.columns.meaning(column as usize) {
                Column::Element(element) | Column::Place(element, _) => self.proxies[element],
                Column::Sky(_) => SKY_PROXY,
            };
            (0..3).for_each(|c| sum[c] += sent[c] * f64::from(count));
        }
        sum.map(|sum| sum / f64::from(row.rays.max(1)))
    }

    /// The column of a ray of an instance, in its coordinates.
    #[inline(always)]
    fn column(
        &self,
        instance: usize,
        ray: &Ray,
        landing: Option<Landing>,
        [scale, least]: [f64; 2],
    ) -> Option<u32> {
        let here = &self.placed.instances[instance].placement;
        let direction = here.transform_vector3(ray.direction);
        self.column_at(landing, direction, (scale, |t| here.transform_point3(ray.at(t))), least)
    }

    /// The column of a ray that ends here. `direction`, and the point at a t: in scene coordinates, as is `scale` t. `least`: the
    /// size of the smallest places, metres.
    #[inline(always)]
    fn column_at(
        &self,
        landing: Option<Landing>,
        direction: DVec3,
        (scale, at): (f64, impl Fn(f64) -> DVec3),
        least: f64,
    ) -> Option<u32> {
        let Some(Landing { instance: met, end, t }) = landing else {
            return Some(self.columns.sky(SkyCells::towards(direction)));
        };
        let End::Element(number) = end else { return None };
        let element = self.placed.world.elements_of(met).start + number as usize;
        let distance = t * scale;
        if distance >= self.widths[element] {
            return Some(self.columns.element(element));
        }
        Some(self.columns.place(element, &self.placed.world.elements[element], at(t), [distance, least]))
    }

    /// The places that these rows see, by column.
    pub fn places_of(&self, rows: &Rows) -> Vec<u32> {
        let is_place = |&column: &usize| matches!(self.columns.meaning(column), Column::Place(..));
        let places: BTreeSet<u32> =
            rows.senders_seen().filter(is_place).map(|column| column as u32).collect();
        places.into_iter().collect()
    }

    /// The rows of sharp light on these places.
    pub fn sharp_on_places(&self, places: &[u32]) -> SharpRows {
        if self.sharp.strengths.is_empty() {
            return vec![vec![]; places.len()];
        }
        let instance_of = |&column: &u32| match self.columns.meaning(column as usize) {
            Column::Place(element, _) => self.instance_of(element),
            Column::Element(_) | Column::Sky(_) => usize::MAX,
        };
        let bundles =
            places.chunk_by(|a, b| instance_of(a) == instance_of(b)).flat_map(|own| own.chunks(BUNDLE));
        let bundles: Vec<&[u32]> = bundles.collect();
        let rows = |bundle: &&[u32]| {
            let instance = instance_of(&bundle[0]);
            let back = self.placed.instances[instance].placement.inverse();
            let open_area = |&column: &u32| {
                let (corners, element) = self.place(column)?;
                let corners: Vec<DVec3> = corners.iter().map(|&p| back.transform_point3(p)).collect();
                let normal = back.transform_vector3(element.normal).normalize();
                let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
                let whole = [PlanePiece { corners: &corners, normal, curve: None }];
                // A ray ended here, so it is seen, also in a narrow gap that counts as covered.
                OpenArea::of(self.scenery, instance, &whole, middle)
                    .map(|open| open.area)
                    .or_else(|| area_of(whole))
            };
            let areas: Vec<Option<Emitters>> = bundle.iter().map(open_area).collect();
            let known: Vec<&Emitters> = areas.iter().flatten().collect();
            let among = self.sharp.in_view(self.scenery, instance, known.iter().copied());
            let found = self.sharp.rows(self.scenery, instance, (&known, 0), &among, Effort::PLACES);
            let mut found = found.into_iter();
            areas.iter().map(|area| area.as_ref().and_then(|_| found.next()).unwrap_or_default()).collect()
        };
        let rows: Vec<SharpRows> = bundles.par_iter().map(rows).collect();
        rows.concat()
    }

    fn instance_of(&self, element: usize) -> usize {
        self.placed.world.instance_of_node(self.placed.world.node_of(element))
    }

    /// The polygon of a place in scene coordinates, and its element.
    fn place(&self, column: u32) -> Option<(Vec<DVec3>, &Element)> {
        let Column::Place(element, code) = self.columns.meaning(column as usize) else { return None };
        let element = &self.placed.world.elements[element];
        Some((polygon(element, code)?.to_vec(), element))
    }

    /// What all places of a list send along rows, W/m², by column. `sharp`: the rows of sharp light on them.
    pub fn sent_by_places(&self, places: &[u32], sharp: &Rows) -> HashMap<u32, Rgb> {
        let sent = |(row, &column): (usize, &u32)| {
            let Column::Place(number, _) = self.columns.meaning(column as usize) else {
                return (column, Rgb::BLACK);
            };
            let light = self.strength_of(sharp, row) + self.received[number];
            (column, self.emitted[number] + self.reflectance_at(number, column) * light)
        };
        places.par_iter().enumerate().map(|(row, column)| sent((row, column))).collect()
    }

    /// Sharp light of a row, W/m².
    pub fn strength_of(&self, sharp: &Rows, row: usize) -> Rgb {
        let strengths = &self.sharp.strengths;
        let known = sharp.row(row).filter_map(|(column, value)| Some(*strengths.get(column)? * value));
        known.fold(Rgb::BLACK, |sum, light| sum + light)
    }

    /// The reflectance of a place on an element.
    fn reflectance_at(&self, number: usize, column: u32) -> Rgb {
        let instance = self.instance_of(number);
        let element = &self.placed.world.elements[number];
        let plain = self.materials[instance][element.material.index()].reflectance;
        let Some(coats) = &self.coats else { return plain };
        let Some((corners, _)) = self.place(column) else { return plain };
        let back = self.placed.instances[instance].placement.inverse();
        let corners: Vec<DVec3> = corners.iter().map(|&p| back.transform_point3(p)).collect();
        let normal = back.transform_vector3(element.normal).normalize();
        let coat = &coats[self.placed.instances[instance].part.index()];
        plain * coat.tint(&corners, normal, element.material).0
    }

    /// What arrives along a row of a piece of an instance, W/m². `places`: what these send.
    pub fn along(&self, instance: usize, rows: &Rows, row: usize, places: &HashMap<u32, Rgb>) -> Rgb {
        let sent = |column: usize| match self.columns.meaning(column) {
            Column::Element(element) => self.sent[element] + self.sharp.along_rays(instance, element),
            Column::Sky(cell) => self.sky.as_ref().map_or(Rgb::BLACK, |cells| cells[cell]),
            Column::Place(element, _) => {
                let sent = places.get(&(column as u32)).copied();
                sent.unwrap_or(self.sent[element]) + self.sharp.along_rays(instance, element)
            }
        };
        rows.row(row).fold(Rgb::BLACK, |sum, (column, value)| sum + sent(column) * value)
    }
}

/// The made-up radiosity of the sky.
const SKY_PROXY: [f64; 3] = [1.0, 0.0, 0.5];

/// Light changes over a side within about this share of the scene's diagonal.
const PROXY_CELL: f64 = 0.1;

fn proxies(placed: &PlacedParts) -> Vec<[f64; 3]> {
    let world = &placed.world;
    let cell = PROXY_CELL * frame(world).1;
    let all = (0..placed.instances.len()).flat_map(|k| world.elements_of(k).map(move |element| (k, element)));
    let of = |(instance, element): (usize, usize)| {
        let element = &world.elements[element];
        // Sides whose normals differ by rounding have the same.
        let normal = (element.normal * 4.0).round().as_ivec3().to_array();
        [0, 1, 2].map(|channel| {
            // One channel is the same all over a side.
            let at =
                if channel == 0 { DVec3::ZERO } else { element.centroid / cell + f64::from(channel) / 3.0 };
            let words = [normal, at.floor().as_ivec3().to_array()]
                .concat()
                .into_iter()
                .chain([instance as i32, channel]);
            f64::from(words.fold(0, |seed, word| hash(seed ^ word as u32))) / f64::from(u32::MAX)
        })
    };
    all.map(of).collect()
}

/// The normals of a curved piece differ by at most about this from the one with which it is computed, radians.
const TURN: f64 = 0.1;

/// A curved polygon is cut into at most so many cells along each side.
const CURVED_CELLS: usize = 8;

/// The area of these convex polygons, a little in front of their planes; none if they have no area. Of curved surfaces, small
/// pieces with normals of their own.
pub fn area_of<'a>(polygons: impl IntoIterator<Item = PlanePiece<'a>>) -> Option<Emitters> {
    let mut elements = Vec::new();
    for PlanePiece { corners, normal, curve } in polygons {
        let largest = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let raise = normal * (IN_FRONT * largest);
        let Some(curve) = curve else {
            let flat = SurfacePoint { normal, lift: DVec3::ZERO };
            elements.extend(elements_of(corners, normal, raise).map(|element| (element, flat)));
            continue;
        };
        for cell in cells(corners, cells_along(corners, curve)) {
            let here = curve.at(cell.iter().sum::<DVec3>() / cell.len() as f64);
            elements.extend(elements_of(&cell, normal, raise).map(|element| (element, here)));
        }
    }
    (!elements.is_empty()).then(|| Emitters::curved(&elements))
}

/// The number of cells along each side of a polygon of a curved surface.
fn cells_along(corners: &[DVec3], curve: &Curve) -> usize {
    let normals: Vec<DVec3> = corners.iter().map(|&corner| curve.at(corner).normal).collect();
    let turns = normals.iter().flat_map(|a| normals.iter().map(|b| (*a - *b).length()));
    let most = turns.fold(0.0, f64::max);
    ((most / (2.0 * TURN)).ceil() as usize).clamp(1, CURVED_CELLS)
}

/// A convex polygon as elements, moved by `raise`.
fn elements_of(corners: &[DVec3], normal: DVec3, raise: DVec3) -> impl Iterator<Item = Element> + use<> {
    let pieces: Vec<Corners> = match *corners {
        [a, b, c, d] => vec![Corners::quad([a, b, c, d])],
        _ => {
            (2..corners.len()).map(|k| Corners::triangle([corners[0], corners[k - 1], corners[k]])).collect()
        }
    };
    pieces.into_iter().filter_map(move |corners| {
        let corners = corners.map(|p| p + raise);
        let area = corners.double_area_vector().length() / 2.0;
        let centroid = corners.as_slice()[0];
        let element = Element { corners, normal, centroid, area, material: MaterialId(0), face: FaceId(0) };
        (area > 0.0).then_some(element)
    })
}
