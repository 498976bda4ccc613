//! Tests whether a mesh intersects itself, or touches itself other than along shared edges of its faces.

use super::mesh::{Mesh, steps};
use crate::geometry::aabb::Aabb;
use crate::geometry::box_tree::{BoxTree, Inside};
use crate::geometry::tolerance::{IN_PLANE, INSIDE_A_FACE};
use glam::DVec3;

/// Whether an edge of any face intersects or touches the interior of another. Where faces cross, an edge of one of them
/// intersects the other.
pub(super) fn touches_itself(mesh: &Mesh) -> bool {
    let boxes: Vec<Aabb> = (0..mesh.faces.len()).map(|face| bounds(mesh, face)).collect();
    let tree = BoxTree::new(&boxes);
    let mut open = Vec::new();
    (0..boxes.len()).any(|face| {
        open.extend(tree.root());
        while let Some(node) = open.pop() {
            if !boxes[face].meets(&tree.node(node).bounds) {
                continue;
            }
            match tree.inside(node) {
                Inside::Boxes(inner) => open.extend(inner),
                Inside::Things(others) => {
                    let others = others.iter().map(|&other| other as usize);
                    if others
                        .filter(|&o| o != face && boxes[face].meets(&boxes[o]))
                        .any(|o| touches(mesh, face, o))
                    {
                        return true;
                    }
                }
            }
        }
        false
    })
}

fn bounds(mesh: &Mesh, face: usize) -> Aabb {
    Aabb::around(mesh.around(face).iter().map(|&corner| mesh.corners[corner as usize]))
}

/// Whether an edge of one face meets the interior of the other.
fn touches(mesh: &Mesh, face: usize, other: usize) -> bool {
    let at = |corner: u32| mesh.corners[corner as usize];
    let (normal, around) = (mesh.normal(other), mesh.around(other));
    let size = mesh.bounds.diagonal();
    let height = |p: DVec3| normal.dot(p - at(around[0]));
    steps(mesh.around(face)).any(|[a, b]| {
        let (a, b) = (at(a), at(b));
        let (ha, hb) = (height(a), height(b));
        let slack = IN_PLANE * size;
        if ha.min(hb) > slack || ha.max(hb) < -slack {
            return false;
        }
        // The piece of the edge over the face's inside.
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for [c, d] in steps(around) {
            let side = normal.cross(at(d) - at(c)).normalize();
            let (da, db) =
                (side.dot(a - at(c)) - INSIDE_A_FACE * size, side.dot(b - at(c)) - INSIDE_A_FACE * size);
            match (da > 0.0, db > 0.0) {
                (false, false) => return false,
                (false, true) => from = from.max(da / (da - db)),
                (true, false) => to = to.min(da / (da - db)),
                (true, true) => {}
            }
        }
        let (low, high) = (ha + (hb - ha) * from, ha + (hb - ha) * to);
        from <= to && low.min(high) <= slack && low.max(high) >= -slack
    })
}
