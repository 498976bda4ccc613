//! Lists of what may stand between receivers and a sender. They start with the box around everything and are narrowed
//! on the way down the senders' hierarchy; entries are boxes that have not been opened, or occluders.

use super::receivers::Receivers;
use crate::occluders::Occluder;
use crate::shaft::Shaft;
use crate::visibility::Inside;
use crate::world::{Node, World};
use equilux_formats::{Face, FaceId};
use glam::DVec3;
use std::ops::Range;

/// All lists of one search, one after the other.
pub struct Candidates<'a> {
    world: &'a World,
    entries: Vec<Entry>,
    open: Vec<Entry>,
}

/// An entry of a list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Entry {
    /// Whatever is in this box of the hierarchy.
    Box(u32),
    /// This occluder.
    Occluder(u32),
}

/// What narrowing a list found.
pub enum Verdict {
    /// One occluder stands between all of the receivers and all of the sender.
    Hidden,
    /// Nothing but this list can stand in between.
    Between(Range<usize>),
}

/// Boxes larger than this share of receivers or sender are opened: smaller ones would only lengthen the list.
const OPEN_ABOVE: f64 = 0.5;

impl<'a> Candidates<'a> {
    /// No lists yet.
    pub fn new(world: &'a World) -> Self {
        Self { world, entries: vec![], open: vec![] }
    }

    /// The list that holds everything.
    pub fn all(&mut self) -> Range<usize> {
        self.entries.extend(self.world.occluders.tree.root().map(|root| Entry::Box(root as u32)));
        0..self.entries.len()
    }

    /// A list's entries.
    pub fn slice(&self, list: Range<usize>) -> &[Entry] {
        &self.entries[list]
    }

    /// What of `list` can stand between receivers and sender.
    pub fn narrow(&mut self, list: Range<usize>, receivers: &Receivers, sender: &Node) -> Verdict {
        let size = receivers.diameter.max((sender.high - sender.low).length());
        self.filter(list, receivers, sender, OPEN_ABOVE * size)
    }

    /// The same down to single occluders.
    pub fn occluders(&mut self, list: Range<usize>, receivers: &Receivers, sender: &Node) -> Verdict {
        if self.entries[list.clone()].iter().all(|entry| matches!(entry, Entry::Occluder(_))) {
            return Verdict::Between(list);
        }
        self.filter(list, receivers, sender, 0.0)
    }

    fn filter(
        &mut self,
        list: Range<usize>,
        receivers: &Receivers,
        sender: &Node,
        open_above: f64,
    ) -> Verdict {
        if list.is_empty() {
            return Verdict::Between(list);
        }
        let between = Between::new(self.world, receivers, sender);
        let first = self.entries.len();
        self.open.extend(self.entries[list].iter().rev());
        while let Some(entry) = self.open.pop() {
            match entry {
                Entry::Box(index) => {
                    let node = self.world.occluders.tree.node(index as usize);
                    if between.shaft.misses_box(node.low, node.high) {
                        continue;
                    }
                    if (node.high - node.low).length() <= open_above {
                        self.entries.push(entry);
                        continue;
                    }
                    match self.world.occluders.tree.inside(index as usize) {
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

/// The region between receivers and one sender.
struct Between<'a> {
    world: &'a World,
    receivers: &'a Receivers,
    sender: &'a Node,
    shaft: Shaft,
    /// Face and occluder of a flat sender.
    sender_face: Option<FaceId>,
    sender_occluder: Option<u32>,
}

impl<'a> Between<'a> {
    fn new(world: &'a World, receivers: &'a Receivers, sender: &'a Node) -> Self {
        let mut shaft = Shaft::between(receivers.bounds, (sender.low, sender.high));
        shaft.bound(receivers.points.points()[0], -receivers.points.normal());
        if let Some(side) = sender.side {
            shaft.bound(world.faces[side.face.index()].corners[0], -side.normal);
        }
        Self {
            world,
            receivers,
            sender,
            shaft,
            sender_face: sender.side.map(|side| side.face),
            sender_occluder: sender.side.map(|side| world.occluders.of_face[side.face.index()]),
        }
    }

    fn is_aside(&self, index: u32) -> bool {
        let occluder = &self.world.occluders.all[index as usize];
        if occluder.is_solid() {
            // A convex solid hides nothing from its own surface, and nothing of it.
            if index == self.receivers.occluder || Some(index) == self.sender_occluder {
                return true;
            }
        } else {
            let face = FaceId(occluder.faces[0]);
            let ends = [Some(self.receivers.face), self.sender_face];
            if ends.into_iter().flatten().any(|end| self.world.coplanar(end, face)) {
                return true;
            }
        }
        self.shaft.misses_box(occluder.low, occluder.high) || self.shaft.misses(&occluder.corners)
    }

    /// Whether some face of the occluder alone stands between every receiver and all of the sender.
    fn is_blocked_by(&self, index: u32) -> bool {
        let occluder: &Occluder = &self.world.occluders.all[index as usize];
        occluder.faces.iter().any(|&face| self.is_covered_by(&self.world.faces[face as usize]))
    }

    fn is_covered_by(&self, face: &Face) -> bool {
        let origin = face.corners[0];
        let side = face.normal.dot(self.receivers.points.points()[0] - origin);
        // Strictly beyond: a face must not hide a sender that it is part of.
        let slack = 1e-9 * (self.sender.high - self.sender.low).length();
        let strictly = |p: DVec3, slack: f64| face.normal.dot(p - origin) * side.signum() < -slack;
        if side == 0.0 || self.receivers.hull.iter().any(|&p| face.normal.dot(p - origin) * side <= 0.0) {
            return false;
        }
        let corners = self.sender_corners();
        if !corners.iter().all(|&p| strictly(p, slack)) {
            return false;
        }
        self.receivers.hull.iter().all(|&from| {
            (0..face.corners.len()).all(|i| {
                let (a, b) = (face.corners[i] - from, face.corners[(i + 1) % face.corners.len()] - from);
                let inwards = a.cross(b) * -side.signum();
                corners.iter().all(|&p| inwards.dot(p - from) >= 0.0)
            })
        })
    }

    fn sender_corners(&self) -> smallvec::SmallVec<[DVec3; 10]> {
        if !self.sender.polygon.is_empty() {
            return self.sender.polygon.clone();
        }
        let (l, h) = (self.sender.low, self.sender.high);
        (0..8)
            .map(|k| {
                let pick = |bit: usize, axis: usize| if k >> bit & 1 == 0 { l[axis] } else { h[axis] };
                DVec3::new(pick(0, 0), pick(1, 1), pick(2, 2))
            })
            .collect()
    }
}
