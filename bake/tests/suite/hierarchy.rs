//! Placement of surfaces by nodes and transforms, and the choice of nodes that are parts.

use crate::gltf::{Gltf, HALVES, SQUARE, import, placed_corners, square};
use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};

#[test]
fn transforms_place_the_square_where_gltf_says() {
    let half = 0.5_f64.sqrt();
    let quarter = json!([0, 0, half, half]);
    let matrix = json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 5, 6, 7, 1]);
    for (case, node, expected) in [
        ("translation", json!({ "translation": [5, 6, 7] }), [[5., 6., 7.], [6., 6., 7.], [6., 7., 7.]]),
        (
            "turn",
            json!({ "rotation": quarter, "scale": [2, 2, 2] }),
            [[0., 0., 0.], [0., 2., 0.], [-2., 2., 0.]],
        ),
        ("matrix", json!({ "matrix": matrix }), [[5., 6., 7.], [5., 8., 7.], [3., 8., 7.]]),
        ("stretch", json!({ "scale": [2, 3, 4] }), [[0., 0., 0.], [2., 0., 0.], [2., 3., 0.]]),
        (
            "stretched turn",
            json!({ "rotation": quarter, "scale": [2, 3, 1] }),
            [[0., 0., 0.], [0., 2., 0.], [-3., 2., 0.]],
        ),
    ] {
        let corners = placed_corners(&import(&Gltf::square_at(node)));
        for (found, expected) in corners[0].iter().zip(expected.map(DVec3::from_array)) {
            // The quaternion comes as f32 and is normalised in f64: 1 ulp of f32 in a length of 3.
            assert!((*found - expected).length() < 1e-6, "{case}: {found}, expected {expected}");
        }
    }
}

#[test]
fn placements_are_similarities_and_fronts_stay_in_front() {
    let child = |scale: Value| json!([{ "name": "a", "mesh": 0, "children": [1] }, { "mesh": 0, "translation": [3, 0, 0], "scale": scale }]);
    let root = |scale: Value| json!([{ "name": "a", "mesh": 0, "scale": scale }]);
    for (case, nodes) in [
        ("mirrored root", root(json!([-1, 1, 1]))),
        ("mirrored and stretched root", root(json!([-2, 1, 1]))),
        ("mirrored child", child(json!([-1, 1, 1]))),
        ("stretched child", child(json!([1, 5, 1]))),
    ] {
        let mut gltf = Gltf::with_square();
        gltf.nodes(nodes);
        let scene = import(&gltf);
        let linear = scene.instances[0].placement.matrix3;
        let gram = linear.transpose() * linear;
        assert!(
            gram.abs_diff_eq(DMat3::from_diagonal(DVec3::splat(gram.x_axis.x)), 1e-12),
            "{case}: {linear}"
        );
        for surface in &scene.parts[0].surfaces {
            // The map of a front is the front of the map; z is left alone by all of these.
            let front = linear * surface.corners.double_area_vector();
            assert!(front.z > 0.0 && front.x == 0.0 && front.y == 0.0, "{case}: front {front}");
        }
    }
}

#[test]
fn parts_start_at_zero_and_far_ones_keep_their_digits() {
    let far = SQUARE.map(|[x, y, z]| [x + 1e6, y - 1e6, z + 2.0]);
    let mut gltf = Gltf::of_triangles(&far, &HALVES);
    gltf.mesh("near", json!({ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }));
    gltf.nodes(json!([{ "name": "far", "mesh": 0, "translation": [0, 0, 1] },
               { "name": "near", "mesh": 1, "translation": [1e6, -1e6, 0] }]));
    let scene = import(&gltf);
    assert_eq!(scene.parts.len(), 1, "equal shapes at different places are one part");
    assert_eq!(scene.parts[0].name, "far");
    let corners: Vec<DVec3> = scene.parts[0].surfaces[0].corners.as_slice().to_vec();
    assert_eq!(corners, square()[0]);
    let file_from_part = DAffine3::from_translation(scene.origin) * scene.instances[0].placement;
    assert_eq!(file_from_part, DAffine3::from_translation(DVec3::new(1e6, -1e6, 3.0)));
    assert!(
        scene.instances[0].placement.translation.length() < 100.0,
        "the scene is moved close to its origin"
    );
}

#[test]
fn roots_are_parts_and_wrappers_are_looked_through() {
    let names = |nodes: Value| {
        let mut gltf = Gltf::with_square();
        gltf.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }));
        gltf.nodes(nodes);
        let scene = import(&gltf);
        (scene.instances.iter().map(|i| i.name.clone()).collect::<Vec<_>>().join(" "), scene.parts.len())
    };
    // Each in a place of its own, as what lies on each other counts once.
    let leaf = |name: &str| {
        let place = f64::from(name.as_bytes()[0]);
        json!({ "name": name, "mesh": 0, "translation": [3.0 * place, 0, 0] })
    };
    let stretched = json!({ "name": "b", "mesh": 0, "scale": [2, 1, 1] });
    for (case, nodes, instances, parts) in [
        ("one", json!([leaf("a")]), "a", 1),
        ("shared mesh", json!([leaf("a"), { "name": "b", "mesh": 0, "scale": [3, 3, -3] }]), "a b", 1),
        ("stretch", json!([leaf("a"), stretched]), "a b", 2),
        ("wrapper", json!([{ "name": "w", "children": [1, 2] }, leaf("a"), leaf("b")]), "a b", 1),
        ("wrappers", json!([{ "children": [1] }, { "children": [2] }, leaf("a")]), "a", 1),
        ("not a wrapper", json!([{ "name": "w", "camera": 0, "children": [1] }, leaf("a")]), "w", 1),
        (
            "wish",
            json!([{ "name": "w", "extras": { "element_size": 1 }, "children": [1, 2] }, leaf("a"), { "mesh": 0, "translation": [2, 0, 0] }]),
            "w",
            1,
        ),
        ("beside", json!([leaf("a"), { "name": "empty" }, { "name": "eye", "camera": 0 }]), "a", 1),
        (
            "subtrees",
            json!([{ "name": "a", "children": [2] }, { "name": "b", "children": [3] }, leaf("c"), leaf("d")]),
            "a b",
            1,
        ),
        ("nameless", json!([{ "mesh": 0 }]), "square", 1),
    ] {
        assert_eq!(names(nodes), (instances.to_owned(), parts), "{case}");
    }
}

#[test]
fn a_wrappers_transform_reaches_the_placements() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([{ "children": [1, 2], "scale": [2, 2, 2] }, { "mesh": 0, "translation": [1, 0, 0] }, { "mesh": 0 }]));
    let scene = import(&gltf);
    let origins = scene.instances.iter().map(|i| i.placement.translation).collect::<Vec<_>>();
    // Nodes without names, in order of their places.
    assert_eq!(origins, [DVec3::ZERO, DVec3::X * 2.0]);
}

#[test]
fn a_chain_of_many_nodes_neither_recurses_nor_takes_long() {
    let depth = 100_000;
    let mut nodes: Vec<Value> = (0..depth).map(|i| json!({ "children": [i + 1] })).collect();
    nodes[0]["extras"] = json!({ "element_size": 0.5 });
    nodes.push(json!({ "mesh": 0 }));
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!(nodes));
    assert_eq!(placed_corners(&import(&gltf)), square());
}

#[test]
fn the_default_scene_decides_and_no_scene_means_all_roots() {
    let mut gltf = Gltf::with_square();
    gltf.nodes(json!([
        { "name": "a", "mesh": 0 },
        { "name": "b", "mesh": 0, "translation": [0, 0, 1], "children": [0] },
        { "name": "c", "mesh": 0, "translation": [0, 0, 2] },
    ]));
    for (scenes, default, expected) in [
        (json!([]), Value::Null, "b c"),
        (json!([{ "nodes": [2] }, { "nodes": [0, 2] }]), Value::Null, "c"),
        (json!([{ "nodes": [2] }, { "nodes": [0, 2] }]), json!(1), "a c"),
    ] {
        gltf = gltf.set("/scenes", scenes).set("/scene", default);
        let scene = import(&gltf);
        let names = scene.instances.iter().map(|i| i.name.as_str()).collect::<Vec<_>>().join(" ");
        assert_eq!(names, expected);
    }
}
