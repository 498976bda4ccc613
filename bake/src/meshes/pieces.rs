//! What is left of a sender behind a mesh, as convex pieces.
//!
//! The arcs that bound what is hidden cut the sender into pieces on which visibility is constant, one after the other,
//! each only the piece it crosses. A piece without arcs is hidden or not as the side of the last arc was that cut it
//! out (a solid-leaf BSP: Thibault & Naylor 1987).

use super::arc::Arc;
use super::obstruction::Obstruction;
use crate::form_factor::polygon::{Hides, Polygon, Side, clip};
use glam::DVec3;
use std::ops::Range;

/// Memory for cutting, kept from one sender to the next.
#[derive(Default)]
pub struct Splitter {
    arcs: Vec<Arc>,
}

/// A shorter arc, in radians, does not tell on its own on which side of it is what; a face is asked.
const TELLING: f64 = 1e-7;

impl Splitter {
    /// Append to `outside` the convex pieces of the sender that the mesh does not hide.
    pub fn subtract<C: Fn(u32) -> bool>(
        &mut self,
        obstruction: &Obstruction<C>,
        polygon: Polygon,
        outside: &mut Vec<Polygon>,
    ) {
        match obstruction.outline(&mut self.arcs) {
            Hides::All => {}
            Hides::Nothing => outside.push(polygon),
            Hides::Part => {
                let mut cutting = Cutting { arcs: &mut self.arcs, obstruction, outside };
                let all = 0..cutting.arcs.len();
                cutting.cut(polygon, all);
            }
        }
    }
}

struct Cutting<'a, 'b, C: Fn(u32) -> bool> {
    /// The arcs in the piece that is being cut, after those of the pieces that it is part of.
    arcs: &'a mut Vec<Arc>,
    obstruction: &'a Obstruction<'b, C>,
    outside: &'a mut Vec<Polygon>,
}

impl<C: Fn(u32) -> bool> Cutting<'_, '_, C> {
    /// Cut `polygon` along the longest of its arcs, and both halves along the others.
    fn cut(&mut self, polygon: Polygon, arcs: Range<usize>) {
        let length = |i: &usize| self.arcs[*i].length();
        let longest = arcs.clone().max_by(|a, b| length(a).total_cmp(&length(b))).expect("there are arcs");
        let splitter = self.arcs[longest];
        for (plane, hidden) in [(splitter.hidden, true), (-splitter.hidden, false)] {
            let piece = match clip(&polygon, |p| plane.dot(p)) {
                Side::All => polygon.clone(),
                Side::None => continue,
                Side::Piece(piece) => piece,
            };
            let first = self.arcs.len();
            for i in arcs.clone().filter(|&i| i != longest) {
                let inside = self.arcs[i].clip(plane);
                self.arcs.extend(inside);
            }
            let rest = first..self.arcs.len();
            if !rest.is_empty() {
                self.cut(piece, rest);
            } else if !self.is_hidden(&piece, &splitter, hidden) {
                self.outside.push(piece);
            }
            self.arcs.truncate(first);
        }
    }

    fn is_hidden(&self, piece: &[DVec3], splitter: &Arc, side: bool) -> bool {
        if splitter.length() > TELLING { side } else { self.obstruction.hides_piece(piece) }
    }
}
