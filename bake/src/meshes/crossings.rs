//! Cuts arcs where they appear to cross: between cuts, what lies behind and in front of an arc does not change.

use super::arc::Arc;
use super::directions::{Span, Spans};
use crate::geometry::tolerance::IN_PLANE;

/// The arcs, cut wherever another appears to cross or touch them. Superfluous cuts are harmless, so near-ties cut.
pub fn cut_at_crossings(arcs: &[Arc]) -> Vec<Arc> {
    let spans: Vec<Span> = arcs.iter().map(Arc::span).collect();
    let index = Spans::new(&spans);
    let mut pieces = Vec::with_capacity(2 * arcs.len());
    let mut cuts = Vec::new();
    for (arc, span) in arcs.iter().zip(&spans) {
        cuts.clear();
        cuts.extend([0.0, 1.0]);
        index.any(span, |other| {
            cut_by(arc, &arcs[other], &mut cuts);
            false
        });
        cuts.sort_unstable_by(f64::total_cmp);
        pieces.extend(cuts.windows(2).filter_map(|pair| arc.piece(pair[0], pair[1])));
    }
    pieces
}

/// Appends where `other` crosses `arc` or ends on it, as shares of the segment.
fn cut_by(arc: &Arc, other: &Arc, cuts: &mut Vec<f64>) {
    let [c, d] = other.ends;
    let (above, below) = (arc.hidden.dot(c), arc.hidden.dot(d));
    if above.abs().min(below.abs()) > IN_PLANE {
        if above * below < 0.0 {
            // Between the ends, so it is the crossing and not its antipode.
            cuts.extend(arc.share_at(c * below.abs() + d * above.abs()));
        }
        return;
    }
    for (end, height) in [(c, above), (d, below)] {
        if height.abs() <= IN_PLANE {
            cuts.extend(arc.share_at(end));
        }
    }
}
