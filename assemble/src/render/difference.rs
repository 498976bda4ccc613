//! How far light is from a reference, in false colours: blue where ours is darker, red where it is brighter, white where the
//! two agree.

use super::interpolation::Interpolated;
use crate::canvas::Canvas;
use crate::exposure::luminance;
use crate::picture::BACKGROUND;
use crate::points::{Place, read_light};
use equilux_formats::{Element, Result, Rgb};
use image::RgbImage;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::path::Path;

/// The colours of ours darker, alike and brighter, linear RGB; far enough from each other for those who do not see red and green.
const DARKER: Rgb = [0.02, 0.13, 0.52];
const ALIKE: Rgb = [0.9, 0.9, 0.9];
const BRIGHTER: Rgb = [0.64, 0.05, 0.01];

/// The colours are full where this share of the area is further off.
const FULL: f64 = 0.05;

/// Light at places, to compare with.
pub struct Reference {
    /// By place and, scaled by the size of the scene, by normal: who looks another way is far away.
    tree: RTree<GeomWithData<[f64; 6], f64>>,
    size: f64,
    /// Luminance of the mean irradiance, W/m².
    mean: f64,
}

impl Reference {
    /// Read a table with the columns that [`crate::points::read`] asks for, and irradiance in `Hc_r`, `Hc_g`, `Hc_b` or `H_r`, `H_g`,
    /// `H_b`, W/m². Fails if it cannot be read or has no such columns.
    pub fn read(file: &Path) -> Result<Self> {
        let light = read_light(file)?;
        let size = light.iter().map(|(place, _)| place.point.abs().max_element()).fold(0.0, f64::max);
        let mean = light.iter().map(|(_, h)| luminance(*h)).sum::<f64>() / light.len() as f64;
        let rows = light.iter().map(|(place, h)| GeomWithData::new(key(place, size), luminance(*h)));
        Ok(Self { tree: RTree::bulk_load(rows.collect()), size, mean })
    }

    /// The irradiance nearest to a place, as luminance.
    fn at(&self, place: &Place) -> f64 {
        self.tree.nearest_neighbor(&key(place, self.size)).map_or(0.0, |row| row.data)
    }
}

fn key(place: &Place, size: f64) -> [f64; 6] {
    let (p, n) = (place.point, place.normal * size);
    [p.x, p.y, p.z, n.x, n.y, n.z]
}

/// Our light beside a reference.
pub struct Difference<'a> {
    reference: &'a Reference,
    elements: &'a [Element],
    light: &'a Interpolated<'a>,
    /// Where the colours are full, of the reference's mean.
    full: f64,
}

impl<'a> Difference<'a> {
    /// Compare the light of elements.
    pub fn new(reference: &'a Reference, elements: &'a [Element], light: &'a Interpolated<'a>) -> Self {
        let mut difference = Self { reference, elements, light, full: 1.0 };
        let mut off: Vec<(f64, f64)> = elements
            .iter()
            .enumerate()
            .map(|(number, element)| (difference.at(number, element.centroid).abs(), element.area))
            .collect();
        off.sort_by(|a, b| b.0.total_cmp(&a.0));
        let whole: f64 = off.iter().map(|(_, area)| area).sum();
        let mut passed = 0.0;
        let reached = off.iter().find(|(_, area)| {
            passed += area;
            passed >= FULL * whole
        });
        difference.full = round_up(reached.map_or(0.0, |(off, _)| *off));
        difference
    }

    /// Ours minus the reference's at a point of an element, of the reference's mean.
    fn at(&self, element: usize, point: glam::DVec3) -> f64 {
        let place = Place { point, normal: self.elements[element].normal };
        (luminance(self.light.at(element, point)) - self.reference.at(&place)) / self.reference.mean
    }

    /// What the canvas shows, in false colours.
    pub fn picture(&self, canvas: &Canvas) -> RgbImage {
        canvas.paint(BACKGROUND, |point, element| {
            let off = self.at(element, canvas.view().onto(point, &self.elements[element])) / self.full;
            let end = if off < 0.0 { DARKER } else { BRIGHTER };
            let share = off.abs().min(1.0);
            [0, 1, 2].map(|c| ALIKE[c] + share * (end[c] - ALIKE[c]))
        })
    }

    /// What the colours mean.
    pub fn legend(&self) -> String {
        format!(
            "error.png shows our irradiance minus the reference's: white for none, deep blue for {0} % of the mean darker, deep red for \
             {0} % brighter",
            100.0 * self.full
        )
    }
}

/// The next number of the form 1, 2 or 5 times a power of ten.
fn round_up(number: f64) -> f64 {
    if number <= 0.0 || !number.is_finite() {
        return 1.0;
    }
    let decade = 10f64.powf(number.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|step| step * decade >= number).unwrap_or(10.0);
    // Written out and read again, so that the number printed is the number used.
    format!("{:.0e}", step * decade).parse().unwrap_or(number)
}
