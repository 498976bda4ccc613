//! Groups faces by the plane they lie in. Coplanar faces neither light nor hide one another, regardless of rounding.

use super::tolerance::FLATNESS;
use equilux_formats::Face;
use glam::DVec3;
use std::collections::HashMap;

/// Side of the grid cells that normals are sorted into. Neighbouring cells are searched too.
const CELL: f64 = 1.0 / 64.0;

/// A plane number for every face; faces get the same number if all corners of the one lie within the flatness
/// tolerance of the plane of the other, on either side. Larger faces define the planes, because theirs are the most accurate.
pub fn group(faces: &[Face]) -> Vec<u32> {
    let tolerances: Vec<f64> = faces.iter().map(|face| tolerance(&face.corners)).collect();
    let mut order: Vec<usize> = (0..faces.len()).collect();
    let sizes: Vec<f64> = faces.iter().map(size).collect();
    order.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]).then(a.cmp(&b)));

    let mut planes: Vec<usize> = Vec::new();
    let mut cells: HashMap<[i32; 3], Vec<Plane>> = HashMap::new();
    let mut of_face = vec![0; faces.len()];
    for index in order {
        let face = &faces[index];
        let axis = axis(face.normal);
        let near = neighbours(axis).filter_map(|cell| cells.get(&cell)).flatten();
        let known = near.filter(|plane| plane.may_hold(face.corners[0], tolerances[index])).find(|plane| {
            let plane = planes[plane.number as usize];
            lies_in(face, &faces[plane], tolerances[index].max(tolerances[plane]))
        });
        of_face[index] = known.map(|plane| plane.number).unwrap_or_else(|| {
            planes.push(index);
            let number = planes.len() as u32 - 1;
            let offset = face.normal.dot(face.corners[0]);
            let tolerance = tolerances[index];
            cells.entry(cell(axis)).or_default().push(Plane {
                normal: face.normal,
                offset,
                tolerance,
                number,
            });
            number
        });
    }
    of_face
}

/// A plane, beside others of its cell in memory: most are ruled out by one corner.
struct Plane {
    normal: DVec3,
    offset: f64,
    tolerance: f64,
    number: u32,
}

impl Plane {
    /// Whether a face with this corner and tolerance can lie in it. Rounding is far below the tolerances.
    fn may_hold(&self, corner: DVec3, tolerance: f64) -> bool {
        (self.normal.dot(corner) - self.offset).abs() <= 2.0 * self.tolerance.max(tolerance)
    }
}

/// The distance from a plane, in the unit of these points, up to which a point counts as in it.
pub fn tolerance<'a>(points: impl IntoIterator<Item = &'a DVec3>) -> f64 {
    FLATNESS * points.into_iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

fn size(face: &Face) -> f64 {
    face.corners.iter().map(|&p| (p - face.corners[0]).length_squared()).fold(0.0, f64::max)
}

fn lies_in(face: &Face, plane: &Face, tolerance: f64) -> bool {
    face.corners.iter().all(|&p| plane.normal.dot(p - plane.corners[0]).abs() <= tolerance)
}

/// The normal without its sign: opposite faces share a plane.
fn axis(normal: DVec3) -> DVec3 {
    let largest = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    if normal[largest] < 0.0 { -normal } else { normal }
}

fn cell(axis: DVec3) -> [i32; 3] {
    (axis / CELL).floor().as_ivec3().to_array()
}

/// The cells around an axis and around its opposite: where the two largest components tie, rounding decides which of
/// them sets the sign.
fn neighbours(axis: DVec3) -> impl Iterator<Item = [i32; 3]> {
    [axis, -axis].into_iter().flat_map(|axis| {
        let [x, y, z] = cell(axis);
        (0..27).map(move |k| [x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1])
    })
}
