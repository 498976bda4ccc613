//! A mesh before a sender: the arcs along which the sender begins to be hidden.

use super::arc::Arc;
use super::covers::Sight;
use super::crossings::cut_at_crossings;
use super::mesh::steps;
use super::seen::{Arcs, Hiding, SeenMesh};
use super::sender::{SeenPolygon, middle};
use crate::geometry::polygon::Hides;
use crate::geometry::tolerance::{APART, IN_PLANE, TEN_OPERATIONS};
use glam::DVec3;

/// A mesh and a sender, both as one receiver sees them.
#[derive(Debug)]
pub struct Obstruction<'a, C: Fn(u32) -> bool> {
    seen: &'a SeenMesh<'a>,
    pub(super) sender: &'a SeenPolygon,
    /// Which faces, as numbered outside, lie in the sender's plane.
    coplanar: C,
    place: Place,
}

/// Where the mesh is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Where it can hide nothing.
    Aside,
    /// All of it between the receiver and the sender's plane.
    Before,
    /// Partly behind the sender's plane, or on it.
    Across,
}

impl<'a, C: Fn(u32) -> bool> Obstruction<'a, C> {
    /// `coplanar` tells which faces, as numbered outside, lie in the sender's plane: those hide nothing of it.
    pub fn new(seen: &'a SeenMesh<'a>, sender: &'a SeenPolygon, coplanar: C) -> Self {
        Self { place: place(seen, sender), seen, sender, coplanar }
    }

    /// What the mesh hides of the sender; if only a part, `arcs` are what bounds it on the sender.
    pub(super) fn outline(&self, arcs: &mut Vec<Arc>) -> Hides {
        arcs.clear();
        if self.place == Place::Aside {
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
        if self.place == Place::Before {
            return;
        }
        let mut others = Vec::new();
        self.clip(&self.seen.inner, &sides, &mut others);
        if self.may_touch() {
            self.seams(&sides, &mut others);
            // What stands behind an arc also changes where the mesh goes through the sender.
            others.append(arcs);
            others = cut_at_crossings(&others);
        }
        arcs.extend(others.into_iter().filter(|arc| self.is_open_beside(arc)));
    }

    /// The arcs as far as they stand before the sender's inside.
    fn clip(&self, from: &Arcs, sides: &[DVec3], arcs: &mut Vec<Arc>) {
        from.spans.any(&self.sender.span, |index| {
            arcs.extend(inside(from.all[index], sides).and_then(|arc| self.before(arc)));
            false
        });
    }

    fn before(&self, arc: Arc) -> Option<Arc> {
        if self.place == Place::Before {
            return Some(arc);
        }
        let hides = !(self.coplanar)(self.seen.mesh.faces[arc.face as usize]);
        if hides { arc.above(|p| self.sender.height(p), self.slack(0.0)) } else { None }
    }

    /// Whether the mesh may go through the sender, or touch it.
    fn may_touch(&self) -> bool {
        let (mesh, point) = (self.seen.mesh, self.seen.point);
        let margin = APART * mesh.bounds.diagonal();
        (mesh.touches_itself || !mesh.has(self.sender.face))
            && self.sender.meets_box(mesh.bounds.moved(-point).grown(margin))
    }

    /// Where faces go through the sender or end on it: what is before its plane hides what is beside the seam.
    fn seams(&self, sides: &[DVec3], arcs: &mut Vec<Arc>) {
        self.seen.hiding_in(&self.sender.span, |hiding| {
            if !(self.coplanar)(self.seen.mesh.faces[hiding.face as usize]) {
                arcs.extend(self.seam(hiding).and_then(|seam| inside(seam, sides)));
            }
        });
    }

    /// The edge that the sender's plane gives to the piece of a face before it. Around the front of a face, what the
    /// face hides is on the left; so along the seam it is, from where the face goes down to where it comes up.
    fn seam(&self, Hiding { face, front }: Hiding) -> Option<Arc> {
        let slack = self.slack(0.0);
        let corners = self.seen.mesh.around(face as usize);
        let height = |corner: u32| self.sender.height(self.seen.corner(corner));
        // Further in than rounding, a corner is before the plane or behind it; if not, it is on it.
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

    /// Whether one sees past the arc to the sender, on the side that its own face does not hide.
    fn is_open_beside(&self, arc: &Arc) -> bool {
        !self.hides(&Sight::beside(arc.middle(), -arc.hidden))
    }

    fn hides(&self, sight: &Sight) -> bool {
        self.seen.covers(sight, |face| {
            self.place == Place::Before
                || !(self.coplanar)(self.seen.mesh.faces[face]) && self.is_before(face, sight)
        })
    }

    fn is_before(&self, face: usize, sight: &Sight) -> bool {
        let distance = self.seen.distance(face, sight.along);
        let height = self.sender.height(sight.along * distance);
        // A face that is seen nearly edge-on is met at a distance that rounding shifts the more.
        let grazing = self.seen.mesh.normal(face).dot(sight.along).abs();
        if height.abs() > self.slack(distance) + TEN_OPERATIONS * distance / grazing {
            height > 0.0
        } else {
            sight.rises(self.seen.mesh.normal(face), self.sender.normal)
        }
    }

    /// Heights up to this are on the plane.
    fn slack(&self, distance: f64) -> f64 {
        IN_PLANE * self.sender.reach.max(distance)
    }
}

/// The arc as far as it is inside of all planes through the receiver's point.
fn inside(arc: Arc, sides: &[DVec3]) -> Option<Arc> {
    sides.iter().try_fold(arc, |rest, &side| rest.clip(side))
}

fn place(seen: &SeenMesh, sender: &SeenPolygon) -> Place {
    if !seen.span.meets(&sender.span) {
        return Place::Aside;
    }
    let (centre, half) = (seen.mesh.bounds.centre(), seen.mesh.bounds.size() / 2.0);
    let (lowest, highest) = sender.heights_of_box(centre - seen.point, half);
    if highest <= IN_PLANE * sender.reach {
        Place::Aside
    } else if lowest > APART * half.length() {
        Place::Before
    } else {
        Place::Across
    }
}
