//! Lists of possible occluders between receivers and a sender. They start with the box around everything and are
//! narrowed on the way down the two hierarchies. Entries are unopened boxes or occluders.

use super::viewers::Viewers;
use crate::form_factor::wide::vectorised;
use crate::geometry::box_tree::Inside;
use crate::geometry::shaft::Shaft;
use crate::geometry::tolerance::ON_FACE;
use crate::world::occluders::{Shape, Together};
use crate::world::{Sender, World};
use equilux_formats::{Face, FaceId};
use glam::DVec3;
use smallvec::SmallVec;
use std::ops::Range;

/// All lists of one search, concatenated.
pub struct Candidates<'a> {
    world: &'a World,
    entries: Vec<Entry>,
    open: Vec<Entry>,
}

/// An entry of a list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Entry {
    /// Everything in this box of the hierarchy.
    Box(u32),
    /// This occluder.
    Occluder(u32),
}

/// The result of narrowing a list.
pub enum Verdict {
    /// One occluder hides all of the sender from all receivers.
    Hidden,
    /// Only the occluders of this list can hide the sender.
    Between(Range<usize>),
}

/// Boxes larger than this share of the receivers or sender are opened; opening smaller ones would only lengthen the list.
const MIN_OPENED_RATIO: f64 = 0.5;

/// Up to this many faces of a mesh are tested one by one, which detects that one of them hides everything; more occlude
/// as a mesh.
const MAX_SINGLE_FACES: usize = 8;

impl<'a> Candidates<'a> {
    /// The list of all occluders.
    pub fn all(world: &'a World) -> (Self, Range<usize>) {
        let root = world.occluders().tree.root().map(|root| Entry::Box(root as u32));
        let entries: Vec<Entry> = root.into_iter().collect();
        let list = 0..entries.len();
        (Self { world, entries, open: vec![] }, list)
    }

    /// No lists yet.
    pub fn none(world: &'a World) -> Self {
        Self { world, entries: vec![], open: vec![] }
    }

    /// Copies a list of another search.
    pub fn adopt(&mut self, list: &[Entry]) -> Range<usize> {
        let first = self.entries.len();
        self.entries.extend_from_slice(list);
        first..self.entries.len()
    }

    /// A list's entries.
    pub fn slice(&self, list: Range<usize>) -> &[Entry] {
        &self.entries[list]
    }

    /// Narrows `list` to what can stand between viewers and sender.
    pub fn narrow(&mut self, list: Range<usize>, viewers: &Viewers, sender: &Sender) -> Verdict {
        let size = viewers.diameter.max(sender.bounds.diagonal());
        self.filter(list, viewers, sender, MIN_OPENED_RATIO * size)
    }

    /// Like [`Self::narrow`], down to single occluders.
    pub fn occluders(&mut self, list: Range<usize>, viewers: &Viewers, sender: &Sender) -> Verdict {
        self.filter(list, viewers, sender, 0.0)
    }

    fn filter(&mut self, list: Range<usize>, viewers: &Viewers, sender: &Sender, open_above: f64) -> Verdict {
        if list.is_empty() {
            return Verdict::Between(list);
        }
        let around;
        let corners = if sender.polygon.is_empty() {
            around = sender.bounds.corners();
            &around
        } else {
            &sender.polygon
        };
        vectorised(
            #[inline(always)]
            || self.keep(list, &Between::new(self.world, viewers, sender, corners), open_above),
        )
    }

    #[inline(always)]
    fn keep(&mut self, list: Range<usize>, between: &Between, open_above: f64) -> Verdict {
        let first = self.entries.len();
        self.open.extend(self.entries[list].iter().rev());
        while let Some(entry) = self.open.pop() {
            match entry {
                Entry::Box(index) => {
                    let node = self.world.occluders().tree.node(index as usize);
                    if between.shaft.misses_box(&node.bounds) {
                        continue;
                    }
                    if node.bounds.diagonal() <= open_above {
                        self.entries.push(entry);
                        continue;
                    }
                    match self.world.occluders().tree.inside(index as usize) {
                        Inside::Boxes(inner) => self.open.extend(inner.map(|i| Entry::Box(i as u32))),
                        Inside::Things(things) => {
                            self.open.extend(things.iter().map(|&t| Entry::Occluder(t)))
                        }
                    }
                }
                Entry::Occluder(index) => {
                    if between.is_aside(index) {
                        continue;
                    }
                    if let Shape::Mesh(together) = &self.world.occluders().all[index as usize].shape {
                        match between.faces_of(together) {
                            Some(few) => self.open.extend(few.into_iter().map(Entry::Occluder)),
                            None => self.entries.push(entry),
                        }
                        continue;
                    }
                    if between.is_blocked_by(index) {
                        self.open.clear();
                        return Verdict::Hidden;
                    }
                    self.entries.push(entry);
                }
            }
        }
        Verdict::Between(first..self.entries.len())
    }
}

/// The region between viewers and one sender.
struct Between<'a> {
    world: &'a World,
    viewers: &'a Viewers,
    shaft: Shaft,
    /// Corners of the sender, or of the box around it.
    corners: &'a [DVec3],
    /// Face and occluder of a flat sender.
    sender_face: Option<FaceId>,
    sender_occluder: Option<u32>,
    /// The middle of the viewers and the middle of the sender.
    axis: [DVec3; 2],
    /// Lower bound of the diameter of every cross-section of the region.
    narrowest: f64,
    /// The least distance of a sender behind a face that hides it: a nearer sender may be part of the face.
    slack: f64,
}

impl<'a> Between<'a> {
    #[inline(always)]
    fn new(world: &'a World, viewers: &'a Viewers, sender: &Sender, corners: &'a [DVec3]) -> Self {
        let mut shaft = Shaft::between(viewers.bounds, sender.bounds);
        if let Some(flat) = &viewers.flat {
            shaft.bound(viewers.hull[0], -flat.normal);
        }
        if let Some(side) = sender.side {
            shaft.bound(world.faces[side.face.index()].corners[0], -side.normal);
        }
        let middle = |corners: &[DVec3]| corners.iter().sum::<DVec3>() / corners.len() as f64;
        // A share t of the way along, sections hold t of the sender and 1 − t of the viewers.
        let (near, far) = (viewers.diameter, sender.bounds.diagonal());
        Self {
            world,
            viewers,
            shaft,
            sender_face: sender.side.map(|side| side.face),
            sender_occluder: sender.side.map(|side| world.occluders().of_face[side.face.index()]),
            axis: [middle(&viewers.hull), middle(corners)],
            narrowest: if near == 0.0 { 0.0 } else { near * far / (near + far) },
            slack: ON_FACE * far,
            corners,
        }
    }

    #[inline(always)]
    fn is_aside(&self, index: u32) -> bool {
        let occluder = &self.world.occluders().all[index as usize];
        let flat = self.viewers.flat.as_ref();
        match occluder.shape {
            // A convex solid hides nothing from its own surface, and nothing of it.
            Shape::Solid(_) => {
                if flat.is_some_and(|flat| index == flat.occluder) || Some(index) == self.sender_occluder {
                    return true;
                }
            }
            Shape::Face(_) => {
                let face = FaceId(occluder.faces[0]);
                let ends = [flat.map(|flat| flat.face), self.sender_face];
                if ends.into_iter().flatten().any(|end| self.world.coplanar(end, face)) {
                    return true;
                }
            }
            Shape::Mesh(_) => {}
        }
        self.shaft.misses_box(&occluder.bounds) || self.shaft.misses(&occluder.corners)
    }

    /// The faces of a mesh that may stand in between; none if there are more than [`MAX_SINGLE_FACES`].
    fn faces_of(&self, Together { tree, first, .. }: &Together) -> Option<SmallVec<[u32; MAX_SINGLE_FACES]>> {
        let mut faces = SmallVec::new();
        let mut open: SmallVec<[usize; 32]> = tree.root().into_iter().collect();
        while let Some(index) = open.pop() {
            let node = tree.node(index);
            if self.shaft.misses_box(&node.bounds) {
                continue;
            }
            match tree.inside(index) {
                Inside::Boxes(inner) => open.extend(inner),
                Inside::Things(things) => {
                    for occluder in things.iter().map(|thing| first + thing) {
                        if self.is_aside(occluder) {
                            continue;
                        }
                        if faces.len() == MAX_SINGLE_FACES {
                            return None;
                        }
                        faces.push(occluder);
                    }
                }
            }
        }
        Some(faces)
    }

    /// Whether some face of the occluder alone stands between every viewer and all of the sender.
    fn is_blocked_by(&self, index: u32) -> bool {
        let occluder = &self.world.occluders().all[index as usize];
        if occluder.diameter < self.narrowest {
            return false;
        }
        occluder.faces.iter().any(|&face| self.is_covered_by(&self.world.faces[face as usize]))
    }

    fn is_covered_by(&self, face: &Face) -> bool {
        let origin = face.corners[0];
        let [from, to] = self.axis;
        let side = face.normal.dot(from - origin);
        // The axis is tested first, because most faces do not even cross it.
        if side == 0.0 || face.normal.dot(to - origin) * side.signum() >= -self.slack {
            return false;
        }
        let axis = to - from;
        let edge = |i: usize| {
            let next = if i + 1 == face.corners.len() { 0 } else { i + 1 };
            (face.corners[i], face.corners[next])
        };
        let inwards = |i: usize, from: DVec3| {
            let (a, b) = edge(i);
            (a - from).cross(b - a) * -side.signum()
        };
        let edges = || 0..face.corners.len();
        edges().all(|i| inwards(i, from).dot(axis) >= 0.0)
            // Strictly in front of it: viewers may lie on the face and face away from it.
            && self.viewers.hull.iter().all(|&p| {
                face.normal.dot(p - origin) * side.signum() > ON_FACE * (p - origin).length()
            })
            // Strictly beyond: a face must not hide a sender that it is part of.
            && self.corners.iter().all(|&p| face.normal.dot(p - origin) * side.signum() < -self.slack)
            && self.viewers.hull.iter().all(|&from| {
                edges().all(|i| {
                    let inwards = inwards(i, from);
                    self.corners.iter().all(|&p| inwards.dot(p - from) >= 0.0)
                })
            })
    }
}
