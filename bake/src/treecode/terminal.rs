//! Form factors from all receivers of a cluster to one sender polygon behind a short list of occluders.
//!
//! What is the same for all receivers is done once: the horizon cuts the sender, and the sender's plane tells which
//! occluders stand before it. Then each receiver takes away what each occluder hides from it.

use super::candidates::Entry;
use super::receivers::Receivers;
use crate::form_factor::contour;
use crate::form_factor::plain::IN_PLANE;
use crate::form_factor::polygon::{Hides, Polygon, Pyramid, Side, clip};
use crate::occluders::face_pyramid;
use crate::world::{Node, World};
use equilux_formats::FaceId;
use glam::DVec3;
use std::collections::HashMap;

/// Computes entries, and remembers the pyramids that were needed for it.
pub struct Evaluator<'a> {
    world: &'a World,
    receivers: usize,
    /// Where the pyramids of an occluder stand, one a receiver.
    slots: HashMap<u32, usize>,
    pyramids: Vec<Remembered>,
    /// Unoccluded form factors of the receivers.
    whole: Vec<f64>,
    between: Vec<Blocker>,
    scratch: Vec<Pyramid>,
    pieces: Vec<Polygon>,
    outside: Vec<Polygon>,
}

/// The pyramid an occluder hides from a receiver.
#[expect(clippy::large_enum_variant, reason = "short-lived; a box would cost an allocation a cut")]
enum Remembered {
    Unknown,
    EdgeOn,
    Known(Pyramid),
}

/// Something before the sender.
#[expect(clippy::large_enum_variant, reason = "short-lived; a box would cost an allocation a cut")]
enum Blocker {
    /// An occluder wholly before the sender's plane.
    Whole(usize, u32),
    /// A solid that the sender's plane cuts.
    Cut(u32),
    /// The piece of a face that stands before the sender's plane.
    Piece(Polygon, DVec3),
}

impl<'a> Evaluator<'a> {
    /// For clusters of this many receivers.
    pub fn new(world: &'a World, receivers: usize) -> Self {
        Self {
            world,
            receivers,
            slots: HashMap::new(),
            pyramids: vec![],
            whole: vec![],
            between: vec![],
            scratch: vec![],
            pieces: vec![],
            outside: vec![],
        }
    }

    /// Append a form factor for every receiver; false if all of them are zero.
    pub fn evaluate(
        &mut self,
        receivers: &Receivers,
        sender: &Node,
        occluders: &[Entry],
        values: &mut Vec<f64>,
    ) -> bool {
        let origin = receivers.points.points()[0];
        let normal = receivers.points.normal();
        let cut = clip(&sender.polygon, |p| normal.dot(p - origin));
        let polygon = match &cut {
            Side::All => &sender.polygon,
            Side::None => return false,
            Side::Piece(piece) => piece,
        };
        self.whole.clear();
        receivers.points.form_factors(polygon, &mut self.whole);
        self.turn_away(receivers, sender);
        self.find_blockers(sender, occluders);
        let mut any = false;
        let plane = (sender.side.map_or(DVec3::ZERO, |side| side.normal), sender.polygon[0]);
        for (i, &point) in receivers.points.points().iter().enumerate() {
            let whole = self.whole[i];
            let clear = whole == 0.0 || self.between.is_empty();
            let left = if clear { whole } else { self.occluded(i, point, polygon, plane, normal, whole) };
            any |= left != 0.0;
            values.push(left);
        }
        any
    }

    /// Receivers behind the sender's plane see nothing of it; nor do those in it.
    fn turn_away(&mut self, receivers: &Receivers, sender: &Node) {
        let Some(side) = sender.side else { return };
        for (value, &point) in self.whole.iter_mut().zip(receivers.points.points()) {
            let to_corner = sender.polygon[0] - point;
            let reach =
                sender.polygon.iter().map(|&p| (p - point).length_squared()).fold(0.0, f64::max).sqrt();
            if -side.normal.dot(to_corner) <= IN_PLANE * reach {
                *value = 0.0;
            }
        }
    }

    /// What of the list stands before the sender's plane, whichever receiver looks.
    fn find_blockers(&mut self, sender: &Node, occluders: &[Entry]) {
        self.between.clear();
        let side = sender.side.expect("a sender with an outline is flat");
        let corner = sender.polygon[0];
        for entry in occluders {
            let Entry::Occluder(index) = *entry else { unreachable!("lists of terminals are opened") };
            let occluder = &self.world.occluders.all[index as usize];
            let reach = (occluder.high - occluder.low).length() + (occluder.corners[0] - corner).length();
            let height = |p: DVec3| side.normal.dot(p - corner);
            let (low, high) = occluder
                .corners
                .iter()
                .map(|&p| height(p))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
            if high <= IN_PLANE * reach {
                continue;
            }
            if low >= -IN_PLANE * reach {
                let slot = self.slot(index);
                self.between.push(Blocker::Whole(slot, index));
                continue;
            }
            if occluder.is_solid() {
                self.between.push(Blocker::Cut(index));
                continue;
            }
            for &face in &occluder.faces {
                if self.world.coplanar(FaceId(face), side.face) {
                    continue;
                }
                let face = &self.world.faces[face as usize];
                match clip(&face.corners, height) {
                    Side::All => {
                        self.between.push(Blocker::Piece(face.corners.iter().copied().collect(), face.normal))
                    }
                    Side::None => {}
                    Side::Piece(piece) => self.between.push(Blocker::Piece(piece, face.normal)),
                }
            }
        }
    }

    fn slot(&mut self, occluder: u32) -> usize {
        let (receivers, pyramids) = (self.receivers, &mut self.pyramids);
        *self.slots.entry(occluder).or_insert_with(|| {
            let slot = pyramids.len();
            pyramids.resize_with(slot + receivers, || Remembered::Unknown);
            slot
        })
    }

    /// The form factor of what is left of `polygon` for one receiver, whose unoccluded form factor is `whole`.
    fn occluded(
        &mut self,
        receiver: usize,
        point: DVec3,
        polygon: &Polygon,
        plane: (DVec3, DVec3),
        normal: DVec3,
        whole: f64,
    ) -> f64 {
        let polygon: Polygon = polygon.iter().map(|&p| p - point).collect();
        self.scratch.clear();
        for blocker in &self.between {
            let made;
            let pyramid = match blocker {
                Blocker::Whole(slot, index) => {
                    let remembered = &mut self.pyramids[slot + receiver];
                    if matches!(remembered, Remembered::Unknown) {
                        let occluder = &self.world.occluders.all[*index as usize];
                        *remembered = occluder
                            .pyramid(point, &self.world.faces)
                            .map_or(Remembered::EdgeOn, Remembered::Known);
                    }
                    match remembered {
                        Remembered::Known(pyramid) => &*pyramid,
                        _ => continue,
                    }
                }
                Blocker::Cut(index) => {
                    let occluder = &self.world.occluders.all[*index as usize];
                    made = occluder.pyramid_above(point, &self.world.faces, |p| plane.0.dot(p - plane.1));
                    &made
                }
                Blocker::Piece(corners, normal) => {
                    let Some(pyramid) = face_pyramid(corners, *normal, point) else { continue };
                    made = pyramid;
                    &made
                }
            };
            match pyramid.hides(&polygon) {
                Hides::All => return 0.0,
                Hides::Part => self.scratch.push(pyramid.clone()),
                Hides::Nothing => {}
            }
        }
        match self.scratch.len() {
            0 => whole,
            1 => {
                let hidden = self.scratch[0].intersect(&polygon);
                whole - hidden.map_or(0.0, |hidden| contour::form_factor(&hidden, normal))
            }
            _ => self.left_over(polygon, normal),
        }
    }

    fn left_over(&mut self, polygon: Polygon, normal: DVec3) -> f64 {
        // Those that hide most come first: often nothing is left for the others.
        self.scratch.sort_by_cached_key(|pyramid| std::cmp::Reverse(pyramid.corners_inside(&polygon)));
        self.pieces.clear();
        self.pieces.push(polygon);
        for pyramid in &self.scratch {
            self.outside.clear();
            for piece in self.pieces.drain(..) {
                match pyramid.hides(&piece) {
                    Hides::All => {}
                    Hides::Nothing => self.outside.push(piece),
                    Hides::Part => pyramid.subtract_from(piece, &mut self.outside),
                }
            }
            std::mem::swap(&mut self.pieces, &mut self.outside);
            if self.pieces.is_empty() {
                return 0.0;
            }
        }
        self.pieces.iter().map(|piece| contour::form_factor(piece, normal)).sum()
    }
}
