//! The meshes in front of a sender as seen by each receiver of a cluster, computed when first needed and reused for all
//! senders of the cluster.

use super::pieces::Pieces;
use super::receivers::Receivers;
use crate::geometry::polygon::Polygon;
use crate::meshes::{Obstruction, SeenMesh, SeenPolygon};
use crate::world::{FaceSide, World};
use equilux_formats::FaceId;
use glam::DVec3;
use smallvec::SmallVec;

/// The meshes that were needed so far.
pub struct SeenMeshes<'a> {
    world: &'a World,
    /// By occluder and receiver; an occluder that was not needed yet has no receivers.
    known: Vec<Vec<Option<Box<SeenMesh<'a>>>>>,
    /// The occluders before the sender.
    before: Vec<u32>,
}

/// The meshes that may hide parts of one sender from one receiver.
pub struct MeshOccluders<'s> {
    world: &'s World,
    side: FaceSide,
    meshes: SmallVec<[&'s SeenMesh<'s>; 8]>,
}

impl<'a> SeenMeshes<'a> {
    /// Without any mesh yet.
    pub fn new(world: &'a World) -> Self {
        Self { world, known: vec![], before: vec![] }
    }

    /// Starts with another sender, without occluders.
    pub fn clear(&mut self) {
        self.before.clear();
    }

    /// Adds a mesh occluder in front of the sender.
    pub fn add(&mut self, occluder: u32) {
        self.before.push(occluder);
    }

    /// The meshes that may hide parts of a sender from the receiver number `receiver`. `corners` are those of the
    /// sender relative to the receiver's point, above its horizon; the sender lies on `side`.
    pub fn occluders(
        &mut self,
        receivers: &Receivers,
        receiver: usize,
        corners: impl FnOnce() -> Polygon,
        side: FaceSide,
    ) -> MeshOccluders<'_> {
        let mut occluders = MeshOccluders { world: self.world, side, meshes: SmallVec::new() };
        if !self.before.is_empty() {
            self.make(receivers, receiver);
            let sender = SeenPolygon::new(corners(), side.normal, side.face.0);
            let seen = self.before.iter().filter_map(|&o| self.known[o as usize][receiver].as_deref());
            occluders.meshes.extend(seen.filter(|seen| seen.span.meets(&sender.span)));
        }
        occluders
    }

    /// Computes the meshes in front of the sender for one receiver.
    fn make(&mut self, receivers: &Receivers, receiver: usize) {
        self.known.resize_with(self.world.occluders().all.len(), Vec::new);
        for &occluder in &self.before {
            let by_receiver = &mut self.known[occluder as usize];
            by_receiver.resize_with(receivers.count(), || None);
            by_receiver[receiver]
                .get_or_insert_with(|| Box::new(seen(self.world, occluder, receivers, receiver)));
        }
    }
}

fn seen<'a>(world: &'a World, occluder: u32, receivers: &Receivers, receiver: usize) -> SeenMesh<'a> {
    let mesh = world.occluders().mesh(occluder).expect("only meshes are added");
    let own = receivers.viewers.flat.as_ref().expect("receivers lie on one face").face;
    let point = receivers.points.points()[receiver];
    mesh.seen_from(point, receivers.points.normal(), |face| world.coplanar(own, FaceId(face)))
}

impl MeshOccluders<'_> {
    /// Whether nothing is hidden.
    pub fn is_empty(&self) -> bool {
        self.meshes.is_empty()
    }

    /// Removes what they hide from `pieces` of the sender. `spare` is a buffer.
    pub fn subtract_from(&self, pieces: &mut Pieces, spare: &mut Pieces) {
        for seen in &self.meshes {
            spare.clear();
            for piece in pieces.iter() {
                let piece = SeenPolygon::new(Polygon::from_slice(piece), self.side.normal, self.side.face.0);
                let coplanar = |face| self.world.coplanar(self.side.face, FaceId(face));
                Obstruction::new(seen, &piece, coplanar).subtract(&mut |open: &[DVec3]| spare.push(open));
            }
            std::mem::swap(pieces, spare);
        }
    }
}
