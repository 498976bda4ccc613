//! A mesh as seen from one receiver: which faces hide something, and its silhouette.

use super::arc::Arc;
use super::covers::Sight;
use super::crossings::cut_at_crossings;
use super::directions::{Span, Spans};
use super::mesh::{Edge, Mesh, steps};
use crate::geometry::tolerance::IN_PLANE;
use glam::{DVec3, Vec3A};

/// The view of a mesh from one receiver, shared by all senders.
#[derive(Debug)]
pub struct SeenMesh<'a> {
    pub(super) mesh: &'a Mesh,
    /// The receiver's point.
    pub(super) point: DVec3,
    /// Unit vectors to the mesh's corners.
    toward: Vec<DVec3>,
    /// Faces that hide something above the receiver's horizon.
    hiding: Vec<Hiding>,
    spans: Spans,
    /// Box around the directions in which something is hidden.
    pub span: Span,
    /// Arcs whose open side is not covered by the mesh.
    pub(super) outer: Arcs,
    /// Arcs with part of the mesh in front of or behind them on their open side.
    pub(super) inner: Arcs,
}

/// A face that hides something.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hiding {
    /// Its position in the mesh's list.
    pub face: u32,
    /// Whether the receiver sees its front.
    pub front: bool,
}

/// Arcs with an index.
#[derive(Debug, Default)]
pub(super) struct Arcs {
    pub all: Vec<Arc>,
    pub spans: Spans,
}

/// Which side of a face the receiver is on; none if the face hides nothing.
type SeenSide = Option<bool>;

impl Mesh {
    /// The mesh as the receiver at `point` with the unit normal `normal` sees it. `coplanar` returns whether a face, by
    /// its number in the world, lies in the receiver's own plane and therefore hides nothing from it.
    pub fn seen_from(&self, point: DVec3, normal: DVec3, coplanar: impl Fn(u32) -> bool) -> SeenMesh<'_> {
        let mut seen = SeenMesh {
            mesh: self,
            point,
            toward: self.corners.iter().map(|&p| (p - point).normalize_or_zero()).collect(),
            hiding: vec![],
            spans: Spans::default(),
            span: Span::EMPTY,
            outer: Arcs::default(),
            inner: Arcs::default(),
        };
        let (sides, grooves) = seen.sides(normal, coplanar);
        seen.find_hiding(&sides, normal);
        seen.find_arcs(&sides, grooves, normal);
        seen
    }
}

impl SeenMesh<'_> {
    /// Whether a face for which `counts` hides what is behind it along `sight`.
    pub(super) fn covers(&self, sight: &Sight, counts: impl Fn(usize) -> bool) -> bool {
        self.spans.any(&Span::at(sight.along), |i| {
            let Hiding { face, front } = self.hiding[i];
            self.stands_in(face as usize, front, sight) && counts(face as usize)
        })
    }

    /// Calls `found` with the faces that may hide something within `span`.
    pub(super) fn hiding_in(&self, span: &Span, mut found: impl FnMut(Hiding)) {
        self.spans.any(span, |i| {
            found(self.hiding[i]);
            false
        });
    }

    /// Distance to a face along a unit vector that meets it.
    pub(super) fn distance(&self, face: usize, along: DVec3) -> f64 {
        let normal = self.mesh.normal(face);
        normal.dot(self.corner(self.mesh.around(face)[0])) / normal.dot(along)
    }

    /// A corner relative to the receiver's point.
    pub(super) fn corner(&self, corner: u32) -> DVec3 {
        self.mesh.corners[corner as usize] - self.point
    }

    fn stands_in(&self, face: usize, front: bool, sight: &Sight) -> bool {
        steps(self.mesh.around(face)).all(|[a, b]| {
            let (a, b) = (self.toward[a as usize], self.toward[b as usize]);
            if front { sight.passes_left(a, b) } else { sight.passes_left(b, a) }
        })
    }

    /// The side of each face that hides something, and the sign of the rise of edges that cannot be silhouette.
    ///
    /// In front of each back of a solid lies a front that hides as much, so one side of the faces is enough. At the
    /// edge of a front in a groove, the groove's other side lies in front, and in front of that another front. Seen
    /// from inside the solid, it is the other way round.
    fn sides(&self, normal: DVec3, coplanar: impl Fn(u32) -> bool) -> (Vec<SeenSide>, f64) {
        let heights = self.heights(coplanar);
        let side = |&height: &f64| (height != 0.0).then_some(height > 0.0);
        if !self.mesh.bounds_a_solid {
            return (heights.iter().map(side).collect(), 0.0);
        }
        let front = !self.is_inside(normal, &heights);
        let sides = heights.iter().map(|height| side(height).filter(|&seen| seen == front)).collect();
        (sides, if front { 1.0 } else { -1.0 })
    }

    /// Height of the receiver's point over each face; zero in its plane.
    fn heights(&self, coplanar: impl Fn(u32) -> bool) -> Vec<f64> {
        let far: Vec<f64> = self.mesh.corners.iter().map(|&p| (p - self.point).length_squared()).collect();
        let height = |(position, &face): (usize, &u32)| {
            let around = self.mesh.around(position);
            let height = -self.mesh.normal(position).dot(self.corner(around[0]));
            let far = around.iter().map(|&corner| far[corner as usize]).fold(0.0, f64::max);
            if height * height <= IN_PLANE * IN_PLANE * far || coplanar(face) { 0.0 } else { height }
        };
        self.mesh.faces.iter().enumerate().map(height).collect()
    }

    /// Whether the receiver is inside the solid, decided by the next face along its normal.
    fn is_inside(&self, normal: DVec3, heights: &[f64]) -> bool {
        if !self.mesh.bounds.holds(self.point) {
            return !self.mesh.looks_out;
        }
        let sight = Sight::along(normal);
        let mut nearest = (f64::INFINITY, !self.mesh.looks_out);
        for (face, &height) in heights.iter().enumerate() {
            let approach = -self.mesh.normal(face).dot(normal);
            let (distance, front) = (height / approach, approach > 0.0);
            if distance > 0.0 && distance < nearest.0 && self.stands_in(face, front, &sight) {
                nearest = (distance, !front);
            }
        }
        nearest.1
    }

    fn find_hiding(&mut self, sides: &[SeenSide], normal: DVec3) {
        let above: Vec<bool> = self.toward.iter().map(|&direction| normal.dot(direction) > 0.0).collect();
        let toward: Vec<Vec3A> = self.toward.iter().map(|direction| direction.as_vec3a()).collect();
        let mut spans = Vec::with_capacity(sides.len());
        self.hiding.reserve(sides.len());
        for (face, side) in sides.iter().enumerate() {
            let Some(front) = *side else { continue };
            let around = self.mesh.around(face);
            if around.iter().any(|&corner| above[corner as usize]) {
                self.hiding.push(Hiding { face: face as u32, front });
                spans.push(Span::over(around.iter().map(|&corner| toward[corner as usize])));
            }
        }
        self.spans = Spans::new(&spans);
        self.span = self.spans.whole();
    }

    /// The silhouette above the horizon, cut where it crosses itself.
    fn find_arcs(&mut self, sides: &[SeenSide], grooves: f64, normal: DVec3) {
        let arcs: Vec<Arc> = self
            .mesh
            .edges
            .iter()
            .filter(|edge| edge.rise * grooves <= 0.0)
            .filter_map(|edge| self.arc(edge, sides)?.clip(normal))
            .collect();
        let is_outer = |arc: &Arc| !self.covers(&Sight::beside(arc.middle(), -arc.hidden), |_| true);
        let (outer, inner) = cut_at_crossings(&arcs).into_iter().partition(is_outer);
        (self.outer, self.inner) = (Arcs::new(outer), Arcs::new(inner));
    }

    /// The arc of an edge that belongs to the silhouette: an edge whose two sides differ in what is hidden.
    fn arc(&self, edge: &Edge, sides: &[SeenSide]) -> Option<Arc> {
        let left = sides[edge.left as usize];
        let right = edge.right.and_then(|right| sides[right as usize]);
        if left == right {
            return None;
        }
        let [a, b] = edge.ends.map(|corner| self.corner(corner));
        let (face, forth) = match left {
            Some(front) => (edge.left, front),
            None => (edge.right?, !right?),
        };
        Arc::new(if forth { [a, b] } else { [b, a] }, face)
    }
}

impl Arcs {
    fn new(all: Vec<Arc>) -> Self {
        let spans: Vec<Span> = all.iter().map(Arc::span).collect();
        Self { spans: Spans::new(&spans), all }
    }
}
