//! Faces without area and repeated faces are dropped, and counted.

use crate::gltf::{Gltf, SQUARE, import, noted, placed_corners, square};
use serde_json::json;

#[test]
fn bad_faces_are_dropped_and_counted_by_name() {
    let mut positions = SQUARE.to_vec();
    positions.push([0.5, 0., 0.]);
    let faces = [[0, 1, 2], [0, 2, 3], [0, 0, 1], [0, 4, 1], [1, 1, 1], [1, 2, 0], [2, 3, 0], [0, 3, 2]];
    let scene = import(&Gltf::of_triangles(&positions, faces.as_flattened()));
    let expected = "hall: dropped 3 faces without area and 2 duplicate faces";
    assert!(scene.notes.iter().any(|note| note == expected), "{:?}", scene.notes);
    assert_eq!(scene.parts[0].surfaces.len(), 2, "the square and half of its back are left");
}

/// Beside a corner at 1e30 m a square of 1 m is nothing, even in f64: no surface may be left without an area.
#[test]
fn what_vanishes_beside_a_huge_face_is_dropped() {
    let huge = [[-1e30, 0., 0.], [1e30, 0., 0.], [0., 1e30, 0.]];
    let scene =
        import(&Gltf::of_triangles(&[SQUARE.as_slice(), &huge].concat(), &[0, 1, 2, 0, 2, 3, 4, 5, 6]));
    let areas = scene.parts[0].surfaces.iter().map(|s| s.corners.double_area_vector().length() / 2.0);
    assert_eq!(areas.map(|area| area > 1.0).collect::<Vec<_>>(), [true]);
    assert!(noted(&scene, "hall: dropped 1 face without area"), "{:?}", scene.notes);
}

#[test]
fn two_nodes_in_one_place_make_one_surface() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([{ "name": "hall", "mesh": 0, "children": [1, 2] }, { "mesh": 0 }, { "mesh": 0, "scale": [1, 0, 1] }]));
    let scene = import(&gltf);
    assert_eq!(placed_corners(&scene), square());
    assert!(noted(&scene, "hall: dropped 1 face without area and 1 duplicate face"), "{:?}", scene.notes);
}
