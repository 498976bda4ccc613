//! Light with sharp shadows on pieces of surface: of emitting surfaces, lamps and suns, each at unit strength. What they send
//! is not part of the rows, so that a lamp that is dimmed or painted costs products.

use crate::equation::Equation;
use crate::equation::facing::facing_instances;
use crate::equation::sources::Sources;
use crate::gather::lamps::Lamp;
use equilux_bake::rays::hemisphere::Emitters;
use equilux_bake::rays::scenery::Scenery;
use equilux_bake::rays::sources::{Effort, Source, form_factors_of_areas, in_view, mean_of_point};
use equilux_formats::Rgb;
use equilux_formats::fingerprint::{Content, Digest};

/// Lights with sharp shadows. Columns of their rows are sources, then lamps, then suns.
#[derive(Debug)]
pub struct SharpLights<'a> {
    sources: Option<Sources>,
    lamps: &'a [Lamp],
    suns: Vec<Source>,
    /// For each instance the sources whose light it gets by form factors; that of others arrives along rays.
    facing: Vec<Vec<u32>>,
    /// What each sends: sources and suns W/m², lamps W/sr.
    pub strengths: Vec<Rgb>,
}

/// Rows of pieces of surface: columns and values.
pub type SharpRows = Vec<Vec<(u32, f64)>>;

impl<'a> SharpLights<'a> {
    /// The lights of a scene.
    pub fn new(equation: &'a Equation) -> Self {
        let Equation { placed, optics, lights, coupled, .. } = equation;
        let sources = Sources::emitting(placed, &optics.emission);
        let sent = sources.iter().flat_map(|sources| sources.emission().iter().copied());
        let lamps = lights.lamps.iter().map(|lamp| lamp.intensity);
        let suns = lights.suns.iter().map(|sun| sun.radiosity);
        let facing = sources.as_ref().map(|sources| facing_instances(placed, coupled, sources));
        let strengths = sent.chain(lamps).chain(suns).collect();
        let suns = lights.suns.iter().map(|sun| Source::new(sun.polygons.elements.clone())).collect();
        Self { sources, lamps: &lights.lamps, suns, facing: facing.unwrap_or_default(), strengths }
    }

    /// Whether light of emitting surfaces is among them.
    pub fn has_sources(&self) -> bool {
        self.sources.is_some()
    }

    /// What rows depend on besides the scene's geometry.
    pub fn digest(&self) -> Digest {
        let lamps = self.lamps.iter().map(|lamp| format!("{:?} {:?}", lamp.position, lamp.cone));
        let suns = self.suns.iter().map(|sun| format!("{sun:?}"));
        let all = lamps.chain(suns).fold(Content::new(), |content, text| content.bytes(text));
        let sources = self.sources.as_ref().map(|sources| format!("{:?}", sources.digest()));
        all.bytes(sources.unwrap_or_default()).digest()
    }

    fn sources(&self) -> &[Source] {
        self.sources.as_ref().map_or(&[], |sources| &sources.sources)
    }

    /// The sources that any of these pieces of an instance may see.
    pub fn in_view<'b>(
        &self,
        scenery: &Scenery,
        instance: usize,
        areas: impl Iterator<Item = &'b Emitters> + Clone,
    ) -> Vec<u32> {
        if areas.clone().next().is_none() {
            return vec![];
        }
        let facing = self.facing.get(instance).into_iter().flatten();
        let facing: Vec<(u32, &Source)> = facing.map(|&n| (n, &self.sources()[n as usize])).collect();
        in_view(scenery, instance, areas, &facing)
    }

    /// What an element sends to an instance along rays, because its source does not face it, W/m².
    pub fn along_rays(&self, instance: usize, element: usize) -> Rgb {
        let source = self.sources.as_ref().and_then(|sources| sources.of_element_at(element));
        match source {
            Some(source) if self.facing[instance].binary_search(&source).is_err() => {
                self.strengths[source as usize]
            }
            _ => Rgb::BLACK,
        }
    }

    /// The rows of neighbouring pieces of an instance, in its coordinates. `among`: the sources that they may see. `number`
    /// chooses places on them.
    pub fn rows(
        &self,
        scenery: &Scenery,
        instance: usize,
        (areas, number): (&[&Emitters], u32),
        among: &[u32],
        effort: Effort,
    ) -> SharpRows {
        if areas.is_empty() {
            return vec![];
        }
        let sources: Vec<(u32, &Source)> = among.iter().map(|&n| (n, &self.sources()[n as usize])).collect();
        let mut rows = form_factors_of_areas(scenery, instance, (areas, number), &sources, effort);
        let (placement, first) = (scenery.placement_of(instance), self.sources().len() as u32);
        for (lamp, column) in self.lamps.iter().zip(first..) {
            let towards = placement.inverse().transform_point3(lamp.position);
            for (area, row) in areas.iter().zip(&mut rows) {
                let arriving = |place, normal| {
                    let normal = placement.transform_vector3(normal).normalize();
                    lamp.arriving(placement.transform_point3(place), normal)
                };
                let light = mean_of_point(scenery, instance, (area, number), towards, arriving);
                row.extend((light > 0.0).then_some((column, light)));
            }
        }
        let first = first + self.lamps.len() as u32;
        let suns: Vec<(u32, &Source)> = (first..).zip(&self.suns).collect();
        if !suns.is_empty() {
            let found = form_factors_of_areas(scenery, instance, (areas, number), &suns, Effort::SUN);
            rows.iter_mut().zip(found).for_each(|(row, own)| row.extend(own));
        }
        rows
    }
}
