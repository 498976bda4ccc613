//! Irradiance at any point of an element: the element's own, or interpolated between the values at its corners.

use equilux_formats::{Element, Rgb};
use glam::DVec3;

/// The irradiance of elements.
#[derive(Debug)]
pub struct InterpolatedIrradiance<'a> {
    /// The elements.
    pub elements: &'a [Element],
    /// Irradiance at their corners, W/m², if it is interpolated.
    pub corners: Option<&'a [[Rgb; 4]]>,
    /// Their own irradiance, W/m².
    pub flat: &'a [Rgb],
}

impl InterpolatedIrradiance<'_> {
    /// The irradiance at a point of an element, W/m².
    pub fn at(&self, element: usize, point: DVec3) -> Rgb {
        let Some(corners) = self.corners else { return self.flat[element] };
        let mut sum = Rgb::BLACK;
        for (weight, value) in weights(&self.elements[element], point).into_iter().zip(corners[element]) {
            (0..3).for_each(|c| sum[c] += weight * value[c]);
        }
        sum
    }
}

/// The weights of the corners of a convex polygon at a point inside: mean value coordinates, which are linear on
/// triangles (Floater 2003). w_i = (tan(α_{i−1}/2) + tan(α_i/2)) / r_i with the angles α at the point between
/// adjacent corners.
fn weights(element: &Element, point: DVec3) -> [f64; 4] {
    let corners = element.corners.as_slice();
    let count = corners.len();
    let mut weights = [0.0; 4];
    let to = |i: usize| corners[i % count] - point;
    let tangent = |i: usize| {
        let (a, b) = (to(i), to(i + 1));
        // tan(α/2) = sinα / (1 + cosα).
        a.cross(b).dot(element.normal) / (a.length() * b.length() + a.dot(b))
    };
    for (i, weight) in weights.iter_mut().enumerate().take(count) {
        *weight = (tangent(i + count - 1) + tangent(i)).max(0.0) / to(i).length();
    }
    let sum: f64 = weights.iter().sum();
    if sum.is_finite() && sum > 0.0 { weights.map(|weight| weight / sum) } else { nearest(corners, point) }
}

/// All weight on the nearest corner, for points on corners and edges, where the formula divides by zero.
fn nearest(corners: &[DVec3], point: DVec3) -> [f64; 4] {
    let near = |&i: &usize, &j: &usize| {
        corners[i].distance_squared(point).total_cmp(&corners[j].distance_squared(point))
    };
    let nearest = (0..corners.len()).min_by(near).unwrap_or(0);
    std::array::from_fn(|i| f64::from(u8::from(i == nearest)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use equilux_formats::{Corners, FaceId, MaterialId};

    #[test]
    fn light_that_is_linear_over_a_convex_polygon_is_kept() {
        let corners = [(0.0, 0.0), (2.0, 0.1), (1.7, 1.2), (0.2, 1.0)].map(|(x, y)| DVec3::new(x, y, 0.5));
        let element = Element::new(Corners::quad(corners), MaterialId(0), FaceId(0));
        let linear = |p: DVec3| 1.0 + 2.0 * p.x - 0.5 * p.y;
        for (u, v) in [(0.5, 0.5), (0.1, 0.9), (0.97, 0.03), (0.33, 0.66)] {
            let point = corners[0] * (1.0 - u) * (1.0 - v)
                + corners[1] * u * (1.0 - v)
                + corners[2] * u * v
                + corners[3] * (1.0 - u) * v;
            let found: f64 = weights(&element, point).iter().zip(corners).map(|(w, p)| w * linear(p)).sum();
            // Rounding of a few operations.
            assert!((found - linear(point)).abs() < 1e-12, "{found} at {point}, expected {}", linear(point));
        }
    }
}
