//! Form factors from all receivers of a cluster to one sender polygon behind a short list of occluders.
//!
//! Work common to all receivers is done once: the horizon clips the sender, and the sender's plane selects the
//! occluders in front of it. Then the sender is classified against the pyramid of each occluder, for a few receivers
//! (lanes) at a time. Polygons are clipped only for receivers where a pyramid cuts the sender; then parts hidden by
//! meshes are removed.

use super::candidates::Entry;
use super::pieces::{Pieces, Scissors};
use super::pyramids::{EdgePlanes, LAST_BIT, Lies, OccluderPyramids, Pyramids, lies, normal_of};
use super::receivers::Receivers;
use super::seen_meshes::{MeshOccluders, SeenMeshes};
use crate::form_factor::contour;
use crate::form_factor::edges::Edges;
use crate::form_factor::wide::{LANES, Lane, STEEP, Vectors, contours, squared, towards, vectorised};
use crate::geometry::outline::Outline;
use crate::geometry::polygon::{Clipped, Polygon, clip};
use crate::geometry::tolerance::IN_PLANE;
use crate::world::occluders::Shape;
use crate::world::{Sender, World};
use equilux_formats::FaceId;
use glam::DVec3;
use smallvec::SmallVec;

/// Computes entries, and caches the pyramids that it needed.
pub struct Evaluator<'a> {
    world: &'a World,
    /// Pyramids of whole occluders.
    whole: Pyramids,
    /// The pyramids of each occluder that was needed so far.
    known: Vec<Option<OccluderPyramids>>,
    /// Pyramids of occluders that one sender's plane has clipped.
    pieces: Pyramids,
    meshes: SeenMeshes<'a>,
    /// The pyramids in front of the sender.
    before: Vec<Before>,
    chunk: Chunk,
    clipper: Clipper,
    edges: Edges,
}

/// A pyramid in front of the sender, and the list it is in.
#[derive(Clone, Copy)]
enum Before {
    Whole(OccluderPyramids),
    Piece(OccluderPyramids),
}

/// The view of one sender from several receivers, one a lane.
#[derive(Default)]
struct Chunk {
    /// The sender's corners relative to the receivers.
    corners: Vec<Vectors>,
    /// Unoccluded form factors; zero where the sender is hidden.
    values: Lane,
    /// Lanes whose vectorised contour is inaccurate: far from the sender, or very near.
    plain: [bool; LANES],
    /// Smaller distances count as zero.
    slack: Lane,
    /// The pyramids that cut the sender, and by which planes.
    cuts: [Vec<PyramidCut>; LANES],
}

/// A pyramid (by its place in the list) that cuts the sender, and by which of its planes.
#[derive(Clone, Copy)]
struct PyramidCut {
    before: u32,
    planes: u64,
}

impl<'a> Evaluator<'a> {
    /// An evaluator for one cluster of receivers.
    pub fn new(world: &'a World) -> Self {
        Self {
            world,
            whole: Pyramids::default(),
            known: vec![None; world.occluders().all.len()],
            pieces: Pyramids::default(),
            meshes: SeenMeshes::new(world),
            before: vec![],
            chunk: Chunk::default(),
            clipper: Clipper::default(),
            edges: Edges::default(),
        }
    }

    /// Appends a form factor for every receiver; returns false if all are zero.
    pub fn evaluate(
        &mut self,
        receivers: &Receivers,
        sender: &Sender,
        occluders: &[Entry],
        values: &mut Vec<f64>,
    ) -> bool {
        let origin = receivers.points.points()[0];
        let normal = receivers.points.normal();
        let cut = clip(&sender.polygon, |p| normal.dot(p - origin));
        let polygon = match &cut {
            Clipped::All => &sender.polygon,
            Clipped::None => return false,
            Clipped::Piece(piece) => piece,
        };
        self.find_before(receivers, sender, occluders);
        let Self { whole, pieces, meshes, before, chunk, clipper, edges, .. } = self;
        let side = sender.side.expect("a sender with an outline is flat");
        let first = values.len();
        for (number, points) in receivers.points.lanes().iter().enumerate() {
            let planes_of = |before: &Before| match *before {
                Before::Whole(pyramids) => whole.planes(pyramids, number),
                Before::Piece(pyramids) => pieces.planes(pyramids, number),
            };
            let planes: SmallVec<[&[EdgePlanes]; 16]> = before.iter().map(planes_of).collect();
            vectorised(
                #[inline(always)]
                || chunk.look(points, polygon, normal, side.normal, &planes),
            );
            let count = LANES.min(receivers.count() - (values.len() - first));
            for lane in 0..count {
                values.push(chunk.values[lane]);
                if chunk.values[lane] == 0.0 {
                    continue;
                }
                let receiver = number * LANES + lane;
                let occluders = meshes.occluders(receivers, receiver, || chunk.corners_of(lane), side);
                let seen = ReceiverView { chunk, planes: &planes, occluders, lane, normal };
                clipper.add(seen, values, edges);
            }
        }
        edges.flush(values);
        values[first..].iter().any(|&value| value != 0.0)
    }

    /// Selects the occluders in front of the sender's plane, for all receivers.
    fn find_before(&mut self, receivers: &Receivers, sender: &Sender, occluders: &[Entry]) {
        self.before.clear();
        self.pieces.clear();
        self.meshes.clear();
        let side = sender.side.expect("a sender with an outline is flat");
        let corner = sender.polygon[0];
        let height = |p: DVec3| side.normal.dot(p - corner);
        let lanes = receivers.points.lanes();
        for entry in occluders {
            let Entry::Occluder(index) = *entry else {
                unreachable!("lists of senders that are evaluated are opened")
            };
            let occluder = &self.world.occluders().all[index as usize];
            let slack = IN_PLANE * (occluder.diameter + (occluder.corners[0] - corner).length());
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for &p in &occluder.corners {
                low = low.min(height(p));
                high = high.max(height(p));
            }
            if high <= slack {
                continue;
            }
            let outline = match &occluder.shape {
                Shape::Face(outline) | Shape::Solid(outline) => outline,
                Shape::Mesh(_) => {
                    self.meshes.add(index);
                    continue;
                }
            };
            if low >= -slack {
                let whole = &mut self.whole;
                let known = &mut self.known[index as usize];
                let pyramids = known.get_or_insert_with(|| whole.add(outline, lanes));
                self.before.push(Before::Whole(*pyramids));
                continue;
            }
            let piece = if !outline.thin {
                let faces = occluder.faces.iter().map(|&face| &self.world.faces[face as usize]);
                outline.above(faces.map(|face| face.corners.as_slice()), height)
            } else if self.world.coplanar(FaceId(occluder.faces[0]), side.face) {
                continue;
            } else {
                match clip(&occluder.corners, height) {
                    Clipped::All => outline.clone(),
                    Clipped::None => continue,
                    Clipped::Piece(piece) => Outline::of_face(&piece, outline.sides[0].normal),
                }
            };
            self.before.push(Before::Piece(self.pieces.add(&piece, lanes)));
        }
    }
}

impl Chunk {
    /// Classifies the sender `polygon`, whose front faces along `facing`, against all pyramids.
    #[inline(always)]
    fn look(
        &mut self,
        points: &Vectors,
        polygon: &[DVec3],
        normal: DVec3,
        facing: DVec3,
        pyramids: &[&[EdgePlanes]],
    ) {
        self.corners.clear();
        let mut reach2 = [0.0; LANES];
        for &corner in polygon {
            let to = towards(corner, points);
            let length2 = squared(&to);
            for (reach2, length2) in reach2.iter_mut().zip(length2) {
                *reach2 = if length2 > *reach2 { length2 } else { *reach2 };
            }
            self.corners.push(to);
        }
        self.slack = reach2.map(|reach2| IN_PLANE * reach2.sqrt());
        // Receivers behind the sender's plane, or in it, do not see it.
        let mut dark = [false; LANES];
        let to = &self.corners[0];
        for lane in 0..LANES {
            let before = -(facing.x * to[0][lane] + facing.y * to[1][lane] + facing.z * to[2][lane]);
            dark[lane] = before <= self.slack[lane];
        }
        self.cuts.iter_mut().for_each(Vec::clear);
        for (number, planes) in pyramids.iter().enumerate() {
            let Lies { aside, cuts } = lies(planes, &self.corners, &self.slack);
            for lane in 0..LANES {
                dark[lane] |= (aside[lane] > 0.0) & (cuts[lane] == 0);
            }
            for lane in 0..LANES {
                if aside[lane] > 0.0 && cuts[lane] != 0 {
                    self.cuts[lane].push(PyramidCut { before: number as u32, planes: cuts[lane] });
                }
            }
            if dark == [true; LANES] {
                self.values = [0.0; LANES];
                return;
            }
        }
        let (sums, lowest) = contours(&self.corners, normal);
        let size2 = (polygon[0] - polygon[polygon.len() / 2]).length_squared();
        for lane in 0..LANES {
            self.values[lane] = if dark[lane] { 0.0 } else { sums[lane] };
            let far = reach2[lane] > size2 * (contour::FAR * contour::FAR * 0.25);
            self.plain[lane] = far | (lowest[lane] < STEEP);
        }
    }

    fn corners_of(&self, lane: usize) -> Polygon {
        self.corners.iter().map(|v| DVec3::new(v[0][lane], v[1][lane], v[2][lane])).collect()
    }
}

/// The view of one sender from one receiver.
struct ReceiverView<'a> {
    chunk: &'a mut Chunk,
    planes: &'a [&'a [EdgePlanes]],
    occluders: MeshOccluders<'a>,
    lane: usize,
    normal: DVec3,
}

/// Subtracts the hidden parts of a sender from one receiver's form factor.
#[derive(Default)]
struct Clipper {
    scissors: Scissors,
    pieces: Pieces,
    outside: Pieces,
}

impl Clipper {
    /// Corrects the last of `values`, which is an unoccluded form factor above zero.
    fn add(&mut self, seen: ReceiverView, values: &mut [f64], edges: &mut Edges) {
        let ReceiverView { chunk, planes, occluders, lane, normal } = seen;
        let place = values.len() - 1;
        if chunk.cuts[lane].is_empty() && occluders.is_empty() && !chunk.plain[lane] {
            return;
        }
        let plain = chunk.plain[lane];
        let mut sum = |polygon: &[DVec3], sign: f64, values: &mut [f64]| {
            if plain {
                values[place] += sign * contour::form_factor(polygon, normal);
            } else {
                edges.add(polygon, normal, sign, place, values);
            }
        };
        let polygon = chunk.corners_of(lane);
        if plain {
            values[place] = contour::form_factor(&polygon, normal);
        }
        // The last bit may stand for planes that do not exist for this receiver.
        let cutting = |cut: &PyramidCut| {
            let planes = planes[cut.before as usize];
            let normals = bits(cut.planes, planes.len()).map(move |number| normal_of(&planes[number], lane));
            normals.filter(|&normal| normal != DVec3::ZERO)
        };
        match chunk.cuts[lane].as_mut_slice() {
            [] if occluders.is_empty() => {}
            [cut] if occluders.is_empty() => {
                let hidden = self.scissors.intersect(&polygon, cutting(cut), chunk.slack[lane]);
                if !hidden.is_empty() {
                    sum(hidden, -1.0, values);
                }
            }
            cuts => {
                // Pyramids with few cutting planes come first: they hide more and leave fewer pieces.
                cuts.sort_by_key(|cut| cut.planes.count_ones());
                self.pieces.clear();
                self.pieces.push(&polygon);
                for cut in &*cuts {
                    self.outside.clear();
                    for piece in self.pieces.iter() {
                        self.scissors.subtract(piece, cutting(cut), chunk.slack[lane], &mut self.outside);
                    }
                    std::mem::swap(&mut self.pieces, &mut self.outside);
                }
                occluders.subtract_from(&mut self.pieces, &mut self.outside);
                values[place] = 0.0;
                for piece in self.pieces.iter() {
                    sum(piece, 1.0, values);
                }
            }
        }
    }
}

/// The numbers of the bits that are set, of `count` planes; the last bit stands for all from there on.
fn bits(mut set: u64, count: usize) -> impl Iterator<Item = usize> + Clone {
    let rest = if set >> LAST_BIT == 1 { LAST_BIT..count } else { 0..0 };
    set &= !(1 << LAST_BIT);
    let low = std::iter::from_fn(move || {
        let number = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (number < 64).then_some(number)
    });
    low.chain(rest)
}
