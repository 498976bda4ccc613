//! Finds parts that cannot see each other, from their faces alone: light passes between two faces only if each has a
//! point in front of the other. Conservative: pairs that are hidden by walls are not found.

use equilux_bake::geometry::tolerance::IN_PLANE;
use equilux_bake::world::World;
use equilux_formats::FaceId;
use glam::DVec3;

/// The pairs of instances that cannot see each other, the smaller number first, in ascending order.
pub fn unseen_pairs(world: &World) -> Vec<[usize; 2]> {
    let fronts: Vec<Vec<Front>> = (0..world.instances()).map(|k| fronts(world, k)).collect();
    let pairs = (0..fronts.len()).flat_map(|a| (a + 1..fronts.len()).map(move |b| [a, b]));
    pairs.filter(|&[a, b]| !can_see(&fronts[a], &fronts[b])).collect()
}

/// A side of a face that has elements.
struct Front<'a> {
    corners: &'a [DVec3],
    normal: DVec3,
    face: FaceId,
}

/// The distinct fronts of an instance's elements. Elements of one front are adjacent.
fn fronts(world: &World, instance: usize) -> Vec<Front<'_>> {
    let mut fronts: Vec<Front> = Vec::new();
    for element in &world.elements[world.elements_of(instance)] {
        let known = |front: &Front| front.face == element.face && front.normal.dot(element.normal) > 0.0;
        if !fronts.last().is_some_and(known) {
            let corners = &world.faces[element.face.index()].corners;
            fronts.push(Front { corners, normal: element.normal, face: element.face });
        }
    }
    fronts
}

fn can_see(a: &[Front], b: &[Front]) -> bool {
    a.iter().any(|a| {
        let mut before = b.iter().filter(|b| a.has_before(b.corners));
        before.any(|b| b.has_before(a.corners))
    })
}

impl Front<'_> {
    /// Whether any corner of a polygon lies in front of this face, by more than rounding.
    fn has_before(&self, polygon: &[DVec3]) -> bool {
        let origin = self.corners[0];
        polygon.iter().any(|&p| self.normal.dot(p - origin) > IN_PLANE * (p - origin).length())
    }
}
