//! Form factors with sampled visibility, as in common practice: the unoccluded form factor of a pair times the share
//! of points on the sender that the receiver sees. Only for comparison, since the form factors of parts are exact.

use crate::gather::sampling::{evenly, place_on};
use equilux_bake::form_factor::{contour, plain};
use equilux_bake::rays::RayIndex;
use equilux_formats::Element;

/// Row `receiver`: one value for each element, from rays between the receiver's centroid and `count` points on each
/// element that faces it. The points are evenly distributed (Roberts 2018), with a different offset for each
/// receiver.
pub fn row(elements: &[Element], index: &RayIndex, receiver: usize, count: usize) -> Vec<f64> {
    let own = &elements[receiver];
    let form_factor = |sender: &Element| {
        let Some(polygon) = plain::visible_side(own, sender) else { return 0.0 };
        let seen = |k: &usize| index.sees(own.centroid, place_on(sender, shifted(*k, receiver)));
        let share = (0..count).filter(seen).count() as f64 / count as f64;
        if share == 0.0 { 0.0 } else { share * contour::form_factor(&polygon, own.normal) }
    };
    elements.iter().map(form_factor).collect()
}

/// Point k in the unit square, shifted for each receiver by multiples of the golden ratio and of √2.
fn shifted(k: usize, receiver: usize) -> (f64, f64) {
    let (u, v) = evenly(k);
    let moved = |place: f64, step: f64| (place + receiver as f64 * step).fract();
    (moved(u, 0.618_033_988_749_894_9), moved(v, 0.414_213_562_373_095))
}
