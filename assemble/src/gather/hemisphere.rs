//! Reflected light and light of the sky at points by rays, where the rows of the scene are counted rays.

use crate::gather::Gather;
use crate::gather::sky::SkyCells;
use equilux_bake::rays::hemisphere::rays_from;
use equilux_bake::rays::samples::Samples;
use equilux_bake::rays::scenery::{Landing, Scenery};
use equilux_bake::rays::surfaces::End;
use equilux_formats::{Element, Rgb};
use rayon::prelude::*;

/// Rays from a point. Their noise is a few tenths of a percent of the mean light.
const RAYS: u32 = 4096;

impl Gather {
    /// Irradiance at points from reflecting surfaces and from the sky, W/m².
    pub(super) fn reflected_by_rays(&self, scenery: &Scenery, points: &[Element]) -> Vec<Rgb> {
        let samples = Samples::new(RAYS);
        let sky = self.sky_cells();
        let light = |landing: Option<Landing>, direction| match landing {
            None => sky.as_ref().map_or(Rgb::BLACK, |cells| cells[SkyCells::towards(direction)]),
            Some(Landing { instance, end: End::Element(element), .. }) => {
                self.reflected[self.world.nodes_of(instance).start + element as usize]
            }
            Some(_) => Rgb::BLACK,
        };
        let at = |point: &Element| {
            let rays = rays_from(point, &samples);
            let sum =
                rays.iter().fold(Rgb::BLACK, |sum, ray| sum + light(scenery.land_from(ray), ray.direction));
            sum / f64::from(RAYS)
        };
        points.par_iter().map(at).collect()
    }

    /// What the sky sends from each of its cells, W/m²; none without a sky.
    fn sky_cells(&self) -> Option<Vec<Rgb>> {
        let own = self.world.elements_of(self.sky?);
        let first = self.world.nodes_of(self.sky?).start;
        let mut cells = vec![Rgb::BLACK; SkyCells::COUNT];
        for (place, cell) in self.world.elements[own].iter().enumerate() {
            cells[SkyCells::towards(cell.centroid - self.centre)] = self.shining[first + place];
        }
        Some(cells)
    }
}
