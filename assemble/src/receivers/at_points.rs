//! Light at single points that arrives along rays, with near light from the places where rays end.

use super::Receivers;
use super::columns::Column;
use equilux_bake::rays::hemisphere::rays_from;
use equilux_bake::rays::samples::Samples;
use equilux_formats::{Element, Rgb, Rows};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Rays from a point. Their noise is a few tenths of a percent of the mean light.
const RAYS: u32 = 4096;

/// The columns on which rays end, and how many on each.
type Ends = Vec<(u32, u32)>;

impl Receivers<'_> {
    /// Irradiance at points from reflecting surfaces and from the sky, W/m².
    pub fn reflected_at(&self, points: &[Element]) -> Vec<Rgb> {
        let samples = Samples::new(RAYS);
        let ends: Vec<Ends> = points.par_iter().map(|point| self.ends(point, &samples)).collect();
        let is_place = |&column: &u32| matches!(self.columns.meaning(column as usize), Column::Place(..));
        let places: BTreeSet<u32> =
            ends.iter().flatten().map(|&(column, _)| column).filter(is_place).collect();
        let places: Vec<u32> = places.into_iter().collect();
        let sharp = Rows::from_rows(self.sharp.strengths.len(), self.sharp_on_places(&places));
        let by_places = self.sent_by_places(&places, &sharp);
        let reflected = |column: u32| match self.columns.meaning(column as usize) {
            Column::Element(element) => self.sent[element] - self.emitted[element],
            Column::Place(element, _) => by_places[&column] - self.emitted[element],
            Column::Sky(cell) => self.sky.as_ref().map_or(Rgb::BLACK, |cells| cells[cell]),
        };
        let light = |ends: &Ends| {
            let sum = ends
                .iter()
                .fold(Rgb::BLACK, |sum, &(column, count)| sum + reflected(column) * f64::from(count));
            sum / f64::from(RAYS)
        };
        ends.par_iter().map(light).collect()
    }

    /// The columns on which rays of a point end, and how many on each.
    fn ends(&self, point: &Element, samples: &Samples) -> Ends {
        let column = |ray| {
            let landing = self.scenery.land_from(ray);
            self.column_at(landing, ray.direction, (1.0, |t| ray.at(t)), 0.0)
        };
        let mut columns: Vec<u32> = rays_from(point, samples).iter().filter_map(column).collect();
        columns.sort_unstable();
        columns.chunk_by(|a, b| a == b).map(|same| (same[0], same.len() as u32)).collect()
    }
}
