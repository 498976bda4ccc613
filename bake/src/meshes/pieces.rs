//! The visible part of a sender behind a mesh, as convex pieces.
//!
//! The arcs that bound the hidden part cut the sender into pieces of constant visibility. Each arc cuts only the pieces
//! it crosses. Whether a piece without arcs is hidden follows from its side of the last arc that cut it (a solid-leaf
//! BSP: Thibault & Naylor 1987).

use super::arc::Arc;
use super::obstruction::Obstruction;
use crate::geometry::polygon::{Clipped, Hides, Polygon, clip};
use crate::geometry::tolerance::SHORTEST_ARC;
use glam::DVec3;

impl<C: Fn(u32) -> bool> Obstruction<'_, C> {
    /// Calls `outside` with the convex pieces of the sender that the mesh does not hide, and returns how much it hides.
    pub fn subtract(&self, outside: &mut impl FnMut(&[DVec3])) -> Hides {
        let mut arcs = Vec::new();
        let hides = self.outline(&mut arcs);
        match hides {
            Hides::All => {}
            Hides::Nothing => outside(&self.sender.corners),
            Hides::Part => self.cut(self.sender.corners.clone(), arcs, outside),
        }
        hides
    }

    /// Cuts `polygon` along the longest of its arcs, and both halves along the others.
    fn cut(&self, mut polygon: Polygon, mut arcs: Vec<Arc>, outside: &mut impl FnMut(&[DVec3])) {
        while let Some(splitter) = take_longest(&mut arcs) {
            let [hidden, open] =
                [splitter.hidden, -splitter.hidden].map(|plane| half(&polygon, &arcs, plane));
            let mut rest = None;
            // The half with fewer arcs first, which bounds the depth of the stack.
            let halves = if hidden.as_ref().map_or(0, arcs_in) < open.as_ref().map_or(0, arcs_in) {
                [(hidden, true), (open, false)]
            } else {
                [(open, false), (hidden, true)]
            };
            for (half, side) in halves {
                let Some((piece, inside)) = half else { continue };
                if inside.is_empty() {
                    if !self.is_hidden(&piece, &splitter, side) {
                        outside(&piece);
                    }
                } else if let Some((piece, inside)) = rest.replace((piece, inside)) {
                    self.cut(piece, inside, outside);
                }
            }
            let Some(larger) = rest else { return };
            (polygon, arcs) = larger;
        }
    }

    fn is_hidden(&self, piece: &[DVec3], splitter: &Arc, side: bool) -> bool {
        if splitter.length() > SHORTEST_ARC { side } else { self.hides_piece(piece) }
    }
}

/// A piece of the sender and the arcs in it.
type Half = (Polygon, Vec<Arc>);

fn arcs_in(half: &Half) -> usize {
    half.1.len()
}

fn take_longest(arcs: &mut Vec<Arc>) -> Option<Arc> {
    let length = |i: &usize| arcs[*i].length();
    let longest = (0..arcs.len()).max_by(|a, b| length(a).total_cmp(&length(b)))?;
    Some(arcs.swap_remove(longest))
}

/// The part on the positive side of a plane.
fn half(polygon: &Polygon, arcs: &[Arc], plane: DVec3) -> Option<Half> {
    let piece = match clip(polygon, |p| plane.dot(p)) {
        Clipped::All => polygon.clone(),
        Clipped::None => return None,
        Clipped::Piece(piece) => piece,
    };
    Some((piece, arcs.iter().filter_map(|arc| arc.clip(plane)).collect()))
}
