//! The difference of light from a reference in false colours: blue where ours is darker, red where it is brighter,
//! white where they agree.

use super::interpolation::InterpolatedIrradiance;
use crate::gather::points::{Place, located, read_light};
use crate::picture::BACKGROUND;
use crate::picture::canvas::Canvas;
use equilux_formats::{Element, Result, Rgb};
use glam::DVec3;
use image::RgbImage;
use rstar::RTree;
use rstar::primitives::GeomWithData;
use std::path::Path;

/// Colours for darker, equal and brighter light, linear RGB; distinguishable with red-green colour blindness.
const DARKER: Rgb = Rgb([0.02, 0.13, 0.52]);
const EQUAL: Rgb = Rgb::splat(0.9);
const BRIGHTER: Rgb = Rgb([0.64, 0.05, 0.01]);

/// The colours saturate at the difference that this share of the points exceeds.
const SATURATED_SHARE: f64 = 0.05;

/// Reference light at points.
#[derive(Debug)]
pub struct ReferenceLight {
    places: Vec<Place>,
    /// W/m².
    irradiance: Vec<Rgb>,
}

impl ReferenceLight {
    /// Read a table with the columns of [`crate::gather::points::read`], and irradiance in `Hc_r`, `Hc_g`, `Hc_b` or
    /// `H_r`, `H_g`, `H_b`, W/m². Fails if it cannot be read or lacks these columns.
    pub fn read(file: &Path, origin: DVec3) -> Result<Self> {
        let (places, irradiance) = read_light(file, origin)?;
        Ok(Self { places, irradiance })
    }
}

/// The difference of our light from a reference at the reference's points.
#[derive(Debug)]
pub struct Difference<'a> {
    elements: &'a [Element],
    /// Luminance of our irradiance minus the reference's, relative to the reference's mean, by position and by normal
    /// scaled with the scene's size, so that points with another normal are far away.
    off: RTree<GeomWithData<[f64; 6], f64>>,
    /// Largest coordinate of the points, metres.
    size: f64,
    /// The difference at which the colours saturate.
    saturation: f64,
}

impl<'a> Difference<'a> {
    /// Compare the light of elements with a reference.
    pub fn new(reference: &ReferenceLight, elements: &'a [Element], light: &InterpolatedIrradiance) -> Self {
        let size = reference.places.iter().map(|p| p.point.abs().max_element()).fold(0.0, f64::max);
        let theirs: Vec<f64> = reference.irradiance.iter().map(|h| h.luminance()).collect();
        let mean = theirs.iter().sum::<f64>() / theirs.len() as f64;
        let ours = located(elements, &reference.places);
        let off = |((place, theirs), ours): ((&Place, f64), Option<(Element, usize)>)| {
            let (at, element) = ours?;
            let ours = light.at(element, at.centroid).luminance();
            Some(GeomWithData::new(key(place, size), (ours - theirs) / mean))
        };
        let off: Vec<_> = reference.places.iter().zip(theirs).zip(ours).filter_map(off).collect();
        let mut sizes: Vec<f64> = off.iter().map(|row| row.data.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let rank = (sizes.len() as f64 * (1.0 - SATURATED_SHARE)) as usize;
        let saturation = round_up(sizes.get(rank).copied().unwrap_or(0.0));
        Self { elements, off: RTree::bulk_load(off), size, saturation }
    }

    fn at(&self, element: usize, point: DVec3) -> f64 {
        let place = Place { point, normal: self.elements[element].normal };
        self.off.nearest_neighbor(&key(&place, self.size)).map_or(0.0, |row| row.data)
    }

    /// The picture of the canvas in false colours.
    pub fn picture(&self, canvas: &Canvas) -> RgbImage {
        canvas.paint(BACKGROUND, |point, element| {
            let off = self.at(element, canvas.view().onto(point, &self.elements[element])) / self.saturation;
            let end = if off < 0.0 { DARKER } else { BRIGHTER };
            let share = off.abs().min(1.0);
            EQUAL + (end - EQUAL) * share
        })
    }

    /// The legend of the colours.
    pub fn legend(&self) -> String {
        format!(
            "error.png shows our irradiance minus the reference at each of its points: white for no difference, deep blue for {0} % of the mean darker, deep red for \
             {0} % brighter",
            100.0 * self.saturation
        )
    }
}

fn key(place: &Place, size: f64) -> [f64; 6] {
    let (p, n) = (place.point, place.normal * size);
    [p.x, p.y, p.z, n.x, n.y, n.z]
}

/// The next number of the form 1, 2 or 5 times a power of ten.
fn round_up(number: f64) -> f64 {
    if number <= 0.0 || !number.is_finite() {
        return 1.0;
    }
    let decade = 10f64.powf(number.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|step| step * decade >= number).unwrap_or(10.0);
    // Printed and parsed, so that the printed number is the number in use.
    format!("{:.0e}", step * decade).parse().unwrap_or(number)
}
