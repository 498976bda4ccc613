//! Estimated work of a run besides form factors and exchange, in rows of form factors, for the progress display.
//! Rough factors suffice, since they only affect the estimate of the remaining time.

use crate::gather::points::{Place, ROWS_PER_POINT};
use crate::lightmap::ROWS_PER_TEXEL;
use crate::lightmap::atlas::Atlas;
use crate::outputs::requests::OutputRequests;
use crate::proof::audit::ROWS_PER_UNKNOWN;
use crate::proof::exact_rows::ROWS_PER_EXACT_ROW;
use crate::proof::sample::ExactRows;
use equilux_bake::treecode::Resolution;

/// The work of the requested outputs of a scene with this number of elements.
pub fn expected_work(
    requests: &OutputRequests,
    (elements, resolution): (usize, Resolution),
    atlas: Option<&Atlas>,
    places: Option<&[Place]>,
) -> f64 {
    let compared = |asked: Option<ExactRows>| asked.map_or(0, |rows| rows.of(elements)) as f64;
    let compared = if resolution.rays.is_some() {
        ROWS_PER_UNKNOWN * compared(requests.exact_rows)
    } else if resolution.opening > 0.0 {
        compared(requests.exact_rows.or(Some(ExactRows::ENOUGH)))
    } else {
        0.0
    };
    let classic = if requests.verify { elements } else { 0 };
    let texels: usize = atlas.map_or(0, |atlas| atlas.tiles().iter().map(|tile| tile.texels()).sum());
    ROWS_PER_EXACT_ROW * (compared + classic as f64)
        + ROWS_PER_TEXEL * texels as f64
        + ROWS_PER_POINT * places.map_or(0, <[Place]>::len) as f64
}
