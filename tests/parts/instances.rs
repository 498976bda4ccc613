//! Copies of a part: turned, mirrored and scaled ones share its block to the bit, stretched ones do not; and copies by
//! EXT_mesh_gpu_instancing are instances like any other.

use equilux_assemble::equation::coupling::Coupler;
use equilux_assemble::equation::optics::whole_optics;
use equilux_assemble::equation::systems;
use equilux_assemble::exchange::exchange;
use equilux_assemble::exchange::listener::Unobserved;
use equilux_assemble::exchange::settings::{Goal, Method};
use equilux_assemble::placed_parts::PlacedParts;
use equilux_assemble::statistics::largest_difference;
use equilux_assemble::verify::classic;
use equilux_bake::elements::{ElementSize, optics, subdivide};
use equilux_bake::gltf_import::import_scene;
use equilux_bake::monitor::Monitor;
use equilux_bake::oven::Oven;
use equilux_bake::oven::prepare::PreparedPart;
use equilux_bake::treecode::EXACT;
use equilux_formats::{Instance, LocalSolver, Optics, Part, PartId, Rgb, Scene, Store, TexelChoice, Tints};
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{lamp, paint};
use equilux_tests::shapes::{coupling, joined, room, solid};
use equilux_tests::workshop::Workshop;
use glam::{DAffine3, DMat3, DQuat, DVec3, dvec3};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::path::Path;

/// A bench with a lamp on it, both of boxes, so that it hides some of itself from itself.
fn bench() -> Part {
    joined([
        solid(paint([0.5, 0.25, 0.75]), DVec3::ZERO, dvec3(1.0, 0.25, 0.5)),
        solid(lamp([4.0, 2.0, 3.0]), dvec3(0.125, 0.375, 0.125), dvec3(0.375, 0.75, 0.375)),
    ])
}

fn prepared(name: &str, part: &Part, size: f64) -> PreparedPart {
    let geometry = subdivide(part, ElementSize::Metres(size));
    let tints = Tints::plain(geometry.elements.len());
    PreparedPart {
        name: name.into(),
        optics: optics(&geometry, &part.materials, &tints),
        tints,
        materials: part.materials.clone(),
        element_size: ElementSize::Metres(size),
        unit: 1.0,
        solver: LocalSolver::Direct,
        geometry,
    }
}

fn instance(name: &str, part: u32, placement: DAffine3) -> Instance {
    Instance {
        name: name.into(),
        part: PartId(part),
        placement,
        emission_scale: 1.0,
        repainted: vec![],
        texels: TexelChoice::default(),
    }
}

/// Turned and scaled, perhaps mirrored, about the origin.
fn similarity() -> impl Strategy<Value = DMat3> {
    let turn = (-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.25..1.0_f64)
        .prop_map(|(x, y, z, w)| DQuat::from_xyzw(x, y, z, w).normalize());
    (turn, 0.5..1.5_f64, any::<bool>()).prop_map(|(turn, scale, mirrored)| {
        let mirror = if mirrored { dvec3(-scale, scale, scale) } else { DVec3::splat(scale) };
        DMat3::from_quat(turn) * DMat3::from_diagonal(mirror)
    })
}

proptest! {
    // Each case assembles a scene.
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn turned_mirrored_and_scaled_copies_use_the_parts_block_and_light_is_that_of_the_whole(
        turns in [similarity(), similarity(), similarity()],
    ) {
        let folder = tempfile::tempdir().expect("a folder");
        let store = Store::open(folder.path()).expect("a store");
        let monitor = Monitor::default();
        let oven = Oven { store: &store, file: Path::new("scene"), resolution: EXACT, monitor: &monitor };
        let hall = room(paint([0.75, 0.5, 0.5]), DVec3::splat(-4.0), dvec3(12.0, 4.0, 4.0));
        let parts = [prepared("hall", &hall, 4.0), prepared("bench", &bench(), 0.5)];
        let baked: Vec<_> = parts.iter().map(|p| oven.bake(p).expect("no error")).collect();
        let mut instances = vec![instance("hall", 0, DAffine3::IDENTITY)];
        for (number, turn) in turns.into_iter().enumerate() {
            let at = DVec3::X * 4.0 * number as f64;
            instances.push(instance("bench", 1, DAffine3::from_mat3_translation(turn, at)));
        }
        let placed = PlacedParts::new(baked, instances);
        let coupler = Coupler::new(&oven, &placed);
        let coupled: Vec<_> =
            (0..4).map(|k| coupler.couple(k).expect("no error")).collect();
        for (k, own) in coupled.iter().enumerate().skip(1) {
            prop_assert!(own.corrected.is_none(), "nothing stands inside bench {k}");
            // Computed in the scene's coordinates it must be the same matrix, but for how the corners round there.
            let (as_placed, block) = (coupling(&placed.world, k, &[k], EXACT), &placed.part_of(k).part.self_block);
            let first = placed.world.nodes_of(k).start;
            for i in 0..block.receivers() {
                let mut expected: Vec<(usize, f64)> = block.row(i).collect();
                let mut found: Vec<(usize, f64)> = as_placed.row(i).map(|(j, f)| (j - first, f)).collect();
                expected.sort_by_key(|entry| entry.0);
                found.sort_by_key(|entry| entry.0);
                prop_assert_eq!(expected.len(), found.len(), "senders of row {} of bench {}", i, k);
                for ((j, a), (l, b)) in expected.into_iter().zip(found) {
                    prop_assert!(j == l && (a - b).abs() <= 1e-12, "bench {}: F({}, {}) = {} or F({}, {}) = {}", k, i, j, a, i, l, b);
                }
            }
        }
        let each: Vec<Optics> = (0..4).map(|k| placed.optics_of(k)).collect();
        let systems = systems(&placed, &coupled, &each);
        let goal = Goal { error: 0.0, rounds: usize::MAX };
        let outcome = exchange(&systems, Method::Auto, goal, None, &monitor, &Unobserved);
        let whole = classic(&placed, &whole_optics(&placed), &monitor).expect("not stopped");
        // In the whole the own blocks are computed in the scene's coordinates: see above.
        let off = largest_difference(&outcome.radiosity, &whole.radiosity);
        prop_assert!(off <= 1e-9, "{off} away from the whole, brightest {:?}", whole_optics(&placed).emission.iter().flatten().fold(0.0, |a: f64, b| a.max(*b)));
    }
}

/// The scene of a node with these copies, after the accessors in `data`: bytes, component, type, count, normalised.
fn instanced(data: &[(Vec<u8>, u32, &str, usize, bool)], attributes: Value, extras: Value) -> Model {
    let mut node = Node::new("crate", solid(paint([0.5; 3]), DVec3::ZERO, DVec3::ONE));
    node.extras = extras;
    let mut model = Model::of(&[node]);
    for (bytes, component, kind, count, normalised) in data {
        let accessor =
            json!({ "componentType": component, "type": kind, "count": count, "normalized": normalised });
        model.add_accessor(bytes, accessor);
    }
    model.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    model.with("/nodes/0/extensions", json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } }))
}

pub fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn shorts(values: &[i16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

const F32: u32 = 5126;
const I16: u32 = 5122;
const U16: u32 = 5123;

fn imported(model: &Model) -> Result<Scene, String> {
    let workshop = Workshop::new();
    model.write(&workshop.path("scene.glb"));
    import_scene(&workshop.path("scene.glb")).map_err(|error| error.to_string())
}

#[test]
fn every_copy_is_an_instance_with_a_number_and_only_stretched_ones_are_another_part() {
    let moved = (floats(&[1., 2., 3., 4., 5., 6., 7., 8., 9., 0., 0., 0.]), F32, "VEC3", 4, false);
    // A quarter turn about y, whose halves round in sixteen bits; the same twice; and none.
    let quarter = [0, 23170, 0, 23170];
    let turned = (shorts(&[quarter, quarter, quarter, [0, 0, 0, 32767]].concat()), I16, "VEC4", 4, true);
    let scaled = (floats(&[1., 1., 1., -2., 2., 2., 1., 3., 1., 1., 3., 1.]), F32, "VEC3", 4, false);
    let attributes = json!({ "TRANSLATION": 1, "ROTATION": 2, "SCALE": 3, "_COLOUR": 77 });
    let extras =
        json!({ "emission_scale": 0.5, "materials": { "paint": { "baseColorFactor": [1, 0, 0, 1] } } });
    let scene = imported(&instanced(&[moved, turned, scaled], attributes, extras)).expect("a scene");
    let found: Vec<(&str, usize)> =
        scene.instances.iter().map(|i| (i.name.as_str(), i.part.index())).collect();
    assert_eq!(found, [("crate #0", 0), ("crate #1", 0), ("crate #2", 1), ("crate #3", 1)]);
    assert_eq!((scene.parts[0].name.as_str(), scene.parts[1].name.as_str()), ("crate #0", "crate #2"));
    for instance in &scene.instances {
        assert_eq!((instance.emission_scale, instance.repainted[0].reflectance), (0.5, Rgb([1.0, 0.0, 0.0])));
    }
    // Where the farthest corner of each comes to stand.
    let corners = [[2., 3., 2.], [6., 7., 8.], [8., 11., 8.], [1., 3., 1.]];
    for (instance, expected) in scene.instances.iter().zip(corners) {
        let size =
            scene.parts[instance.part.index()].surfaces.iter().flat_map(|s| s.corners.as_slice().to_vec());
        let corner = instance.placement.transform_point3(size.fold(DVec3::ZERO, DVec3::max));
        let off = (corner - DVec3::from_array(expected)).abs().max_element();
        // The stored quarter turn is exact once it is normalised.
        assert!(off <= 1e-12, "{}: {corner} instead of {expected:?}", instance.name);
    }
}

#[test]
fn copies_of_a_part_file_are_instances_and_copies_inside_one_are_surfaces() {
    let row = |places: [f32; 9]| {
        let places = (floats(&places), F32, "VEC3", 3, false);
        instanced(&[places], json!({ "TRANSLATION": 1 }), json!({}))
    };
    let (shelf, shelves) =
        (row([0., 0., 0., 0., 2., 0., 0., 4., 0.]), row([0., 0., 0., 0., 0., 9., 0., 0., 18.]));
    let workshop = Workshop::new();
    shelf.write(&workshop.path("shelf.glb"));
    shelves.with("/nodes/0/extras/part", json!("shelf.glb")).write(&workshop.path("scene.glb"));
    let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
    assert_eq!((scene.instances.len(), scene.parts.len()), (3, 1));
    assert_eq!(scene.parts[0].surfaces.len(), 18, "three crates of six sides");
    assert_eq!(scene.instances[2].name, "crate #2");
}

#[test]
fn bad_attributes_are_refused_by_name() {
    let places = || (floats(&[0.; 6]), F32, "VEC3", 2, false);
    let turns = |values: &[i16], kind, count, normalised| (shorts(values), I16, kind, count, normalised);
    let one = |data, name: &str| instanced(&[data], json!({ name: 1 }), json!({}));
    for (words, model) in [
        ("no attribute", instanced(&[], json!({}), json!({}))),
        ("no attribute", instanced(&[], json!(7), json!({}))),
        ("TRANSLATION in accessor 9", instanced(&[], json!({ "TRANSLATION": 9 }), json!({}))),
        ("TRANSLATION in accessor \"x\"", instanced(&[], json!({ "TRANSLATION": "x" }), json!({}))),
        ("TRANSLATION in accessor 1 as Vec4", one(turns(&[0; 8], "VEC4", 2, true), "TRANSLATION")),
        ("SCALE in accessor 1 as Vec3 of U16", one((shorts(&[0; 6]), U16, "VEC3", 2, true), "SCALE")),
        ("ROTATION in integers that are not normalised", one(turns(&[0; 8], "VEC4", 2, false), "ROTATION")),
        (
            "copy 1 with a rotation that is no quaternion",
            one(turns(&[0, 0, 0, 9, 0, 0, 0, 0], "VEC4", 2, true), "ROTATION"),
        ),
        (
            "copy 0 with a transform that is not finite",
            one((floats(&[f32::NAN; 3]), F32, "VEC3", 1, false), "SCALE"),
        ),
        ("elements reach past", one((floats(&[0.; 6]), F32, "VEC3", 3, false), "TRANSLATION")),
        ("1000000 copies", one((floats(&[0.; 6]), F32, "VEC3", 1_000_000, false), "TRANSLATION")),
        (
            "attributes of 2 and of 1 copies",
            instanced(
                &[places(), turns(&[0, 0, 0, 9], "VEC4", 1, true)],
                json!({ "TRANSLATION": 1, "ROTATION": 2 }),
                json!({}),
            ),
        ),
    ] {
        let error = imported(&model).expect_err(words);
        assert!(error.contains(words) && error.contains("node crate"), "expected '{words}' in: {error}");
    }
}
