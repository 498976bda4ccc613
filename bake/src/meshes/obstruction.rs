//! A mesh in front of a sender: the arcs that bound the hidden part of the sender.

use super::arc::Arc;
use super::covers::Sight;
use super::crossings::cut_at_crossings;
use super::mesh::steps;
use super::seen::{Arcs, Hiding, SeenMesh};
use super::sender::{SeenPolygon, middle};
use crate::geometry::polygon::Hides;
use crate::geometry::tolerance::{APART, IN_PLANE, TEN_OPERATIONS};
use glam::DVec3;

/// A mesh and a sender, both as seen by one receiver.
#[derive(Debug)]
pub struct Obstruction<'a, C: Fn(u32) -> bool> {
    seen: &'a SeenMesh<'a>,
    pub(super) sender: &'a SeenPolygon,
    /// Whether a face, by its number in the world, lies in the sender's plane.
    coplanar: C,
    place: MeshPosition,
}

/// The position of the mesh relative to the sender.
#[derive(Debug, Clone, Copy, PartialEq)]
enum MeshPosition {
    /// Where it can hide nothing.
    Aside,
    /// All of it between the receiver and the sender's plane.
    Before,
    /// Partly behind the sender's plane, or on it.
    Across,
}

impl<'a, C: Fn(u32) -> bool> Obstruction<'a, C> {
    /// `coplanar` returns whether a face, by its number in the world, lies in the sender's plane and therefore hides
    /// nothing of it.
    pub fn new(seen: &'a SeenMesh<'a>, sender: &'a SeenPolygon, coplanar: C) -> Self {
        Self { place: place(seen, sender), seen, sender, coplanar }
    }

    /// How much of the sender the mesh hides. If it hides a part, `arcs` receives the arcs that bound it.
    pub(super) fn outline(&self, arcs: &mut Vec<Arc>) -> Hides {
        arcs.clear();
        if self.place == MeshPosition::Aside {
            return Hides::Nothing;
        }
        self.find_arcs(arcs);
        if !arcs.is_empty() {
            Hides::Part
        } else if self.hides_piece(&self.sender.corners) {
            Hides::All
        } else {
            Hides::Nothing
        }
    }

    /// Whether the mesh hides a piece of the sender on which visibility does not change.
    pub(super) fn hides_piece(&self, piece: &[DVec3]) -> bool {
        self.hides(&Sight::along(middle(piece)))
    }

    fn find_arcs(&self, arcs: &mut Vec<Arc>) {
        let sides = self.sender.sides();
        self.clip(&self.seen.outer, &sides, arcs);
        if self.place == MeshPosition::Before {
            return;
        }
        let mut others = Vec::new();
        self.clip(&self.seen.inner, &sides, &mut others);
        if self.may_touch() {
            self.seams(&sides, &mut others);
            // What lies behind an arc also changes where the mesh intersects the sender.
            others.append(arcs);
            others = cut_at_crossings(&others);
        }
        arcs.extend(others.into_iter().filter(|arc| self.is_open_beside(arc)));
    }

    /// The arcs, clipped to the sender.
    fn clip(&self, from: &Arcs, sides: &[DVec3], arcs: &mut Vec<Arc>) {
        from.spans.any(&self.sender.span, |index| {
            arcs.extend(inside(from.all[index], sides).and_then(|arc| self.before(arc)));
            false
        });
    }

    fn before(&self, arc: Arc) -> Option<Arc> {
        if self.place == MeshPosition::Before {
            return Some(arc);
        }
        let hides = !(self.coplanar)(self.seen.mesh.faces[arc.face as usize]);
        if hides { arc.above(|p| self.sender.height(p), self.slack(0.0)) } else { None }
    }

    /// Whether the mesh may intersect or touch the sender.
    fn may_touch(&self) -> bool {
        let (mesh, point) = (self.seen.mesh, self.seen.point);
        let margin = APART * mesh.bounds.diagonal();
        (mesh.touches_itself || !mesh.has(self.sender.face))
            && self.sender.meets_box(mesh.bounds.moved(-point).grown(margin))
    }

    /// The seams where faces intersect the sender or end on it: the part of a face in front of the plane hides one side
    /// of the seam.
    fn seams(&self, sides: &[DVec3], arcs: &mut Vec<Arc>) {
        self.seen.hiding_in(&self.sender.span, |hiding| {
            if !(self.coplanar)(self.seen.mesh.faces[hiding.face as usize]) {
                arcs.extend(self.seam(hiding).and_then(|seam| inside(seam, sides)));
            }
        });
    }

    /// The edge where the sender's plane cuts off the piece of a face in front of it. The edge runs from where the
    /// face's boundary passes behind the plane to where it returns, with the hidden side on the left for a front.
    fn seam(&self, Hiding { face, front }: Hiding) -> Option<Arc> {
        let slack = self.slack(0.0);
        let corners = self.seen.mesh.around(face as usize);
        let height = |corner: u32| self.sender.height(self.seen.corner(corner));
        // Corners within rounding of the plane are on it; others are in front of it or behind it.
        let level = |corner: u32| Some(height(corner)).filter(|h| h.abs() > slack).unwrap_or(0.0);
        if !corners.iter().any(|&corner| level(corner) > 0.0) {
            return None;
        }
        let (mut down, mut up) = (None, None);
        for [a, b] in steps(corners) {
            let (ha, hb) = (level(a), level(b));
            let cut = || {
                let (p, q) = (self.seen.corner(a), self.seen.corner(b));
                p + (q - p) * (ha / (ha - hb))
            };
            if ha > 0.0 && hb <= 0.0 {
                down = Some(cut());
            } else if ha <= 0.0 && hb > 0.0 {
                up = Some(cut());
            }
        }
        Arc::new(if front { [down?, up?] } else { [up?, down?] }, face)
    }

    /// Whether the sender is visible next to the arc, on the side that the arc's own face does not hide.
    fn is_open_beside(&self, arc: &Arc) -> bool {
        !self.hides(&Sight::beside(arc.middle(), -arc.hidden))
    }

    fn hides(&self, sight: &Sight) -> bool {
        self.seen.covers(sight, |face| {
            self.place == MeshPosition::Before
                || !(self.coplanar)(self.seen.mesh.faces[face]) && self.is_before(face, sight)
        })
    }

    fn is_before(&self, face: usize, sight: &Sight) -> bool {
        let distance = self.seen.distance(face, sight.along);
        let height = self.sender.height(sight.along * distance);
        // Rounding affects the distance of a face more, the nearer to edge-on it is seen.
        let grazing = self.seen.mesh.normal(face).dot(sight.along).abs();
        if height.abs() > self.slack(distance) + TEN_OPERATIONS * distance / grazing {
            height > 0.0
        } else {
            sight.rises(self.seen.mesh.normal(face), self.sender.normal)
        }
    }

    /// Heights up to this count as in the plane.
    fn slack(&self, distance: f64) -> f64 {
        IN_PLANE * self.sender.reach.max(distance)
    }
}

/// The arc clipped by all planes through the receiver's point.
fn inside(arc: Arc, sides: &[DVec3]) -> Option<Arc> {
    sides.iter().try_fold(arc, |rest, &side| rest.clip(side))
}

fn place(seen: &SeenMesh, sender: &SeenPolygon) -> MeshPosition {
    if !seen.span.meets(&sender.span) {
        return MeshPosition::Aside;
    }
    let (centre, half) = (seen.mesh.bounds.centre(), seen.mesh.bounds.size() / 2.0);
    let (lowest, highest) = sender.heights_of_box(centre - seen.point, half);
    if highest <= IN_PLANE * sender.reach {
        MeshPosition::Aside
    } else if lowest > APART * half.length() {
        MeshPosition::Before
    } else {
        MeshPosition::Across
    }
}
