//! Lengths are in metres of the scene for any scale of nodes: a room modelled in centimetres, integer positions, copies
//! of several sizes.

use super::instances::floats;
use equilux_assemble::lightmap::LightmapOptions;
use equilux_assemble::outputs::requests::Pictures;
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::oven::prepare::{Division, Preparation, Prepared, RowMethod, prepare};
use equilux_bake::treecode::EXACT;
use equilux_formats::{Element, Part};
use equilux_tests::model::{Model, Node};
use equilux_tests::rooms::{lamp, paint};
use equilux_tests::shapes::{grey, joined, moved, room, solid};
use equilux_tests::table::Table;
use equilux_tests::workshop::{Workshop, assembled};
use glam::{DAffine3, DVec3, dvec3};
use proptest::prelude::*;
use serde_json::{Value, json};

fn scaled(part: Part, by: f64) -> Part {
    moved(part, DAffine3::from_scale(DVec3::splat(by)))
}

/// The scale of a node, the same along all axes.
fn evenly(scale: f64) -> Value {
    json!([scale, scale, scale])
}

/// A room of 5 × 3 × 4 m with a lamp below its ceiling and a crate, in units of `unit` metres.
fn furnished_in(unit: f64) -> Part {
    let metres = joined([
        room(paint([0.7, 0.6, 0.5]), DVec3::ZERO, dvec3(5.0, 3.0, 4.0)),
        solid(lamp([20.0, 18.0, 15.0]), dvec3(2.0, 2.5, 1.5), dvec3(3.0, 2.75, 2.5)),
        solid(paint([0.9, 0.2, 0.2]), dvec3(0.5, 0.25, 0.5), dvec3(1.5, 1.25, 1.5)),
    ]);
    scaled(metres, 1.0 / unit)
}

/// Case 33. Nothing that is chosen for the scene depends on its units either.
#[test]
fn a_room_is_the_same_in_any_units() {
    let run = |unit: f64| {
        let workshop = Workshop::new();
        let model = Model::of(&[Node::new("room", furnished_in(unit))]);
        model.with("/nodes/0/scale", evenly(unit)).write(&workshop.path("scene.glb"));
        let by_default = prepared(&workshop, None, Division::Authored);
        let mut job = workshop.job(Division::Authored);
        job.settings.preparation.element_size = Some(ElementSize::Metres(0.25));
        job.outputs.elements = Some(workshop.path("elements.csv"));
        job.outputs.lightmaps =
            Some(LightmapOptions { texel_size: Some(0.25), ..LightmapOptions::default() });
        job.outputs.pictures = Pictures::None;
        assembled(&job);
        let table = Table::read(&workshop.path("elements.csv"));
        let [centroids, normals] = [["x", "y", "z"], ["nx", "ny", "nz"]].map(|names| table.vectors(names));
        let light = |row: usize| ["B_r", "B_g", "B_b"].map(|name| table.number(row, name));
        let elements: Vec<_> =
            (0..table.rows()).map(|row| (centroids[row], normals[row], light(row))).collect();
        let (_, texels) = crate::lightmaps::files::texels(&workshop.path("out/scene/lightmap.exr"));
        (elements, texels, (elements_of(&by_default), by_default.element_size))
    };
    let (elements, texels, by_default) = run(1.0);
    let mean = elements.iter().map(|(_, _, b)| b[0]).sum::<f64>() / elements.len() as f64;
    // Of equal walls another may come first: texels by what they hold.
    let channel = |texels: &[[f32; 3]], c: usize| {
        let mut values: Vec<f32> = texels.iter().map(|texel| texel[c]).collect();
        values.sort_by(f32::total_cmp);
        values
    };
    for power in [-3, -2, -1, 1, 2] {
        let (found, found_texels, found_by_default) = run(10f64.powi(power));
        assert_eq!(found_by_default, by_default, "by default, in units of 1e{power} m");
        assert_eq!(found.len(), elements.len(), "elements in units of 1e{power} m");
        assert_eq!(found_texels.len(), texels.len(), "texels in units of 1e{power} m");
        for &(centroid, normal, light) in &found {
            let distance =
                |(p, n, _): &&(DVec3, DVec3, [f64; 3])| (p - centroid).length() + (n - normal).length();
            let same = elements.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("elements");
            // Corners are rounded to f32 in other units.
            assert!(distance(&same) < 1e-5, "1e{power} m: an element at {centroid} is not there in metres");
            let near = |c: usize| (same.2[c] - light[c]).abs() <= 1e-6 * same.2[c].max(mean);
            assert!((0..3).all(near), "1e{power} m: {light:?} W/m² at {centroid}, in metres {:?}", same.2);
        }
        for c in 0..3 {
            for (&a, &b) in channel(&texels, c).iter().zip(&channel(&found_texels, c)) {
                // Texels between those that are gathered may be off by a hundredth, and which are gathered is a matter
                // of rounding.
                let near = (a - b).abs() <= 0.01 * a.max(b);
                assert!(near, "1e{power} m: a texel of {b} W/m², in metres {a}");
            }
        }
    }
}

/// How a mesh in units of so many metres comes to its size in the scene.
#[derive(Debug, Clone, Copy)]
enum Above {
    Root,
    Matrix,
    Wrappers,
    PartFile,
    Copies,
    Quantised,
}

/// A crate of 1.5 × 1 × 0.5 m, in units of `unit` metres.
fn crate_in(unit: f64) -> Part {
    scaled(solid(grey(0.5, 1.0), DVec3::ZERO, dvec3(1.5, 1.0, 0.5)), 1.0 / unit)
}

/// The crate as scene.glb in a folder, with these extras on its node; the largest where it stands in several sizes.
fn written(above: Above, unit: f64, extras: &Value) -> Workshop {
    let workshop = Workshop::new();
    let node = |part| Node { extras: extras.clone(), ..Node::new("crate", part) };
    let mut model = Model::of(&[node(crate_in(unit))]);
    let scale = evenly(unit);
    let model = match above {
        Above::Root => model.with("/nodes/0/scale", scale),
        Above::Matrix => {
            model.json["nodes"][0].as_object_mut().expect("a node").remove("translation");
            // A quarter turn, mirrored.
            let (u, o) = (unit, 0.0);
            model.with("/nodes/0/matrix", json!([o, u, o, o, u, o, o, o, o, o, u, o, 1, 2, 3, 1]))
        }
        Above::Wrappers => {
            let wrapper = |child: usize| json!({ "children": [child], "scale": evenly(unit.sqrt()) });
            model.json["nodes"].as_array_mut().expect("nodes").extend([wrapper(0), wrapper(1)]);
            model.with("/scenes/0/nodes", json!([2]))
        }
        Above::PartFile => {
            model.write(&workshop.path("crate.glb"));
            Model::of(&[Node::of_file("crate", "crate.glb")]).with("/nodes/0/scale", scale)
        }
        Above::Copies => {
            let scales: Vec<f32> =
                [0.5, 1.0, 0.25].into_iter().flat_map(|by| [(by * unit) as f32; 3]).collect();
            let accessor = json!({ "componentType": 5126, "type": "VEC3", "count": 3 });
            let scales = model.add_accessor(&floats(&scales), accessor);
            let extension = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "SCALE": scales } } });
            model.with("/nodes/0/extensions", extension)
        }
        Above::Quantised => {
            // Half a metre is a whole number of steps.
            let step = 0.5 / (0.5 / unit).round().max(1.0);
            quantised(Model::of(&[node(crate_in(step))])).with("/nodes/0/scale", evenly(step))
        }
    };
    model.write(&workshop.path("scene.glb"));
    workshop
}

/// The model with the positions of its only mesh, whole numbers, in 16 bits (KHR_mesh_quantization).
fn quantised(mut model: Model) -> Model {
    let count = model.json["accessors"][0]["count"].as_u64().expect("a count") as usize;
    let numbers = model.binary[..12 * count].chunks(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let whole: Vec<i16> = numbers.map(|x| x.round() as i16).collect();
    let bytes: Vec<u8> =
        whole.chunks(3).flat_map(|p| [p[0], p[1], p[2], 0]).flat_map(i16::to_le_bytes).collect();
    let accessor = json!({ "componentType": 5122, "type": "VEC3", "count": count });
    let positions = model.add_accessor(&bytes, accessor);
    let view = model.json["accessors"][positions]["bufferView"].as_u64().expect("a view") as usize;
    model.json["bufferViews"][view]["byteStride"] = json!(8);
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    model.with("/meshes/0/primitives/0/attributes/POSITION", json!(positions))
}

fn prepared(workshop: &Workshop, element_size: Option<f64>, division: Division) -> Prepared {
    let scene = import_scene(&workshop.path("scene.glb")).unwrap_or_else(|error| panic!("{error}"));
    let element_size = element_size.map(ElementSize::Metres);
    let wanted = Preparation {
        element_size,
        division,
        resolution: EXACT,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    };
    prepare(&scene, &wanted).unwrap_or_else(|error| panic!("{error}"))
}

/// The longest edge of an element anywhere in the scene, metres.
fn longest_edge(prepared: &Prepared) -> f64 {
    let edges = |element: &Element, scale: f64| {
        let corners = element.corners.as_slice();
        let edge = |i: usize| (corners[(i + 1) % corners.len()] - corners[i]).length() * scale;
        (0..corners.len()).map(edge).fold(0.0, f64::max)
    };
    let of_instance = prepared.instances.iter().flat_map(|instance| {
        let elements = &prepared.parts[instance.part.index()].geometry.elements;
        elements.iter().map(|element| edges(element, instance.scale()))
    });
    of_instance.fold(0.0, f64::max)
}

fn elements_of(prepared: &Prepared) -> usize {
    prepared.instances.iter().map(|i| prepared.parts[i.part.index()].geometry.elements.len()).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn element_sizes_are_metres_of_the_scene(
        above in prop_oneof![
            Just(Above::Root), Just(Above::Matrix), Just(Above::Wrappers),
            Just(Above::PartFile), Just(Above::Copies), Just(Above::Quantised),
        ],
        power in -3.0..2.0_f64,
        size in 0.05..0.5_f64,
        asked in 0..3,
    ) {
        let (extras, option) = match asked {
            0 => (json!({}), Some(size)),
            1 => (json!({ "element_size": size }), Some(7.0)),
            _ => (json!({}), None),
        };
        let [there, in_metres] = [10f64.powf(power), 1.0].map(|unit| {
            prepared(&written(above, unit, &extras), option, Division::Authored)
        });
        let edge = longest_edge(&there);
        match (asked, there.element_size) {
            // Half of it or less would be one cut too many; scales are f32.
            (0 | 1, _) => prop_assert!(edge <= size * (1.0 + 2e-6) && edge > size / 2.0, "{} m of {}", edge, size),
            (_, ElementSize::Metres(size)) => prop_assert!(edge <= size * (1.0 + 2e-6), "{} m of {}", edge, size),
            (_, ElementSize::Mesh) => prop_assert!(false, "a size in metres by default"),
        }
        prop_assert_eq!(elements_of(&there), elements_of(&in_metres));
        prop_assert_eq!(there.element_size, in_metres.element_size);
        if asked == 0 {
            let cells = prepared(&written(above, 10f64.powf(power), &extras), option, Division::Bisect(3));
            prop_assert!(longest_edge(&cells) <= size * (1.0 + 2e-6), "{} m of {}", longest_edge(&cells), size);
        }
    }
}

/// The keys of parts: the same elements are baked once, whatever their size in a scene.
#[test]
fn a_part_baked_alone_serves_where_it_stands_larger() {
    let workshop = written(Above::PartFile, 1.0, &json!({}));
    let baked = workshop.run("bake", &["crate.glb", "--element-size", "0.25"]);
    assert!(baked.stdout.contains("1 baked"), "{}{}", baked.stdout, baked.stderr);
    let scene = Model::of(&[Node::of_file("crate", "crate.glb")]).with("/nodes/0/scale", json!([2, 2, 2]));
    scene.write(&workshop.path("scene.glb"));
    let plan = workshop.run("assemble", &["plan", "scene.glb", "--element-size", "0.5"]);
    assert!(plan.stdout.contains("form factors reused"), "{}{}", plan.stdout, plan.stderr);
    assert!(plan.stdout.contains("(0.5 m"), "sizes are told in metres of the scene: {}", plan.stdout);
}
