//! Points on the surfaces of a scene at which light is compared: the same in every run, and their number on each element in
//! proportion to its area.

use crate::gather::points::Place;
use crate::gather::sampling::{evenly, place_on};
use equilux_formats::Element;

/// `count` points that each represent the same area. Point k lies on the element in which the cumulated area reaches the
/// share (k + ½)/count of the whole, at place k of a sequence of low discrepancy (Roberts 2018). Empty if nothing has an
/// area.
pub fn surface_points(elements: &[Element], count: usize) -> Vec<Place> {
    let reached: Vec<f64> = elements
        .iter()
        .scan(0.0, |sum, element| {
            *sum += element.area;
            Some(*sum)
        })
        .collect();
    let Some(&whole) = reached.last().filter(|&&area| area > 0.0) else { return vec![] };
    let point = |k: usize| {
        let share = whole * (k as f64 + 0.5) / count as f64;
        let element = &elements[reached.partition_point(|&area| area < share).min(elements.len() - 1)];
        Place { point: place_on(element, evenly(k)), normal: element.normal }
    };
    (0..count).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use equilux_formats::{Corners, FaceId, MaterialId};
    use glam::DVec3;

    /// A rectangle at height z, a metre wide and `length` metres long.
    fn rectangle(z: f64, length: f64) -> Element {
        let corners =
            [(0.0, 0.0), (1.0, 0.0), (1.0, length), (0.0, length)].map(|(x, y)| DVec3::new(x, y, z));
        Element::new(Corners::quad(corners), MaterialId(0), FaceId(0))
    }

    #[test]
    fn elements_get_points_by_area_and_everywhere() {
        let points = surface_points(&[rectangle(0.0, 1.0), rectangle(1.0, 3.0)], 400);
        let (low, high): (Vec<Place>, Vec<Place>) = points.iter().partition(|point| point.point.z < 0.5);
        assert_eq!((low.len(), high.len()), (100, 300));
        let quarter = high.iter().filter(|p| p.point.x < 0.5 && p.point.y < 1.5).count();
        assert!(quarter.abs_diff(75) <= 5, "{quarter} of 300 points in a quarter");
    }
}
