//! Evenly distributed points on elements.

use equilux_formats::Element;
use glam::DVec3;

/// Point k of the sequence in the unit square: multiples of powers of 1/p modulo 1, where p³ = p + 1 (Roberts 2018).
pub fn evenly(k: usize) -> (f64, f64) {
    let along = |step: f64| ((k as f64 + 0.5) * step).fract();
    (along(0.754_877_666_246_692_8), along(0.569_840_290_998_053_2))
}

/// Map a point of the unit square onto an element; on triangles and parallelograms the map preserves ratios of areas.
pub fn place_on(element: &Element, (u, v): (f64, f64)) -> DVec3 {
    match *element.corners.as_slice() {
        [a, b, c] if u + v > 1.0 => a + (b - a) * (1.0 - u) + (c - a) * (1.0 - v),
        [a, b, c] => a + (b - a) * u + (c - a) * v,
        [a, b, c, d] => (a * (1.0 - u) + b * u) * (1.0 - v) + (d * (1.0 - u) + c * u) * v,
        _ => element.centroid,
    }
}
