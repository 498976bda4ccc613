//! Pictures, models and tables say what they were given.

use equilux_assemble::outputs::scene_light::SceneLight;
use equilux_assemble::picture::camera::View;
use equilux_assemble::picture::canvas::Canvas;
use equilux_assemble::picture::exposure::Exposure;
use equilux_assemble::{outputs::elements_csv, outputs::model, picture};
use equilux_bake::clusters;
use equilux_bake::visibility::rays::RayIndex;
use equilux_bake::world::World;
use equilux_formats::{Camera, Corners, Element, Face, FaceId, Geometry, MaterialId, Rgb};
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::PI;

const RED: Rgb = Rgb([PI * 0.7, 0.0, 0.0]);
const BLUE: Rgb = Rgb([0.0, 0.0, PI * 0.7]);

/// Rectangles, each with its own face: a corner and the two sides that span it, the front towards their cross product.
fn geometry(rectangles: &[[DVec3; 3]]) -> Geometry {
    let (mut elements, mut faces) = (vec![], vec![]);
    for (face, &[corner, u, v]) in rectangles.iter().enumerate() {
        let corners = Corners::quad([corner, corner + u, corner + u + v, corner + v]);
        elements.push(Element::new(corners, MaterialId(0), FaceId::from_index(face)));
        faces.push(Face::new(corners.as_slice().to_vec()));
    }
    clusters::geometry(elements, faces)
}

/// A cube of edge 1 around `centre`, its six fronts outside.
fn cube(centre: DVec3) -> Geometry {
    let mut sides = vec![];
    for axis in 0..3 {
        let [n, u, v] = [0, 1, 2].map(|turn| DVec3::AXES[(axis + turn) % 3]);
        sides.push([centre + (n - u - v) / 2.0, u, v]);
        sides.push([centre - (n + u + v) / 2.0, v, u]);
    }
    geometry(&sides)
}

fn place(geometry: &Geometry) -> World {
    World::new([(geometry, DAffine3::IDENTITY)])
}

/// A camera on the z axis at `z` that looks towards −Z.
fn camera(z: f64) -> View {
    let placement = DAffine3 { matrix3: DMat3::IDENTITY, translation: DVec3::new(0.0, 0.0, z) };
    View::of_camera(&Camera { name: "eye".into(), placement, vertical_fov: 0.8, aspect: None })
}

fn trace(world: &World, view: View) -> Canvas {
    Canvas::trace(view, &RayIndex::new(&world.elements))
}

fn at(image: &image::RgbImage, right: f64, down: f64) -> [u8; 3] {
    image.get_pixel((f64::from(image.width()) * right) as u32, (f64::from(image.height()) * down) as u32).0
}

#[test]
fn a_red_box_is_red_and_what_is_around_it_is_background() {
    let world = place(&cube(DVec3::ZERO));
    let image = picture::shade(&trace(&world, camera(4.0)), &[RED; 6], Exposure(1.0));
    let empty = picture::shade(&trace(&world, camera(-4.0)), &[RED; 6], Exposure(1.0));
    // Linear 0.7 is 217.6 in 8-bit sRGB.
    assert_eq!(at(&image, 0.5, 0.5), [218, 0, 0]);
    assert_eq!(at(&image, 0.05, 0.05), at(&empty, 0.5, 0.5), "corner of the picture against one of nothing");
    assert_ne!(at(&image, 0.05, 0.05), [0, 0, 0], "the background is not black");
}

#[test]
fn the_nearer_surface_hides_the_farther_and_backs_are_transparent() {
    let sheet = |z: f64, u: DVec3, v: DVec3| [DVec3::new(0.0, 0.0, z) - (u + v) / 2.0, u, v];
    let red_near = sheet(1.0, DVec3::X, DVec3::Y);
    let blue_far = sheet(0.0, DVec3::X * 2.0, DVec3::Y * 2.0);
    let colour_at_centre = |rectangles: &[[DVec3; 3]]| {
        let world = place(&geometry(rectangles));
        // Elements stand in the order of their hierarchy: tell the near one by its place.
        let colours: Vec<Rgb> =
            world.elements.iter().map(|e| if e.centroid.z == 1.0 { RED } else { BLUE }).collect();
        at(&picture::shade(&trace(&world, camera(4.0)), &colours, Exposure(1.0)), 0.5, 0.5)
    };
    assert_eq!(colour_at_centre(&[red_near, blue_far]), [218, 0, 0]);
    let turned = sheet(1.0, DVec3::Y, DVec3::X);
    assert_eq!(colour_at_centre(&[turned, blue_far]), [0, 0, 218]);
}

#[test]
fn up_in_the_picture_is_up_in_the_scene_and_right_is_right() {
    let world = place(&geometry(&[[DVec3::new(0.3, 0.3, 0.0), DVec3::X, DVec3::Y]]));
    let image = picture::shade(&trace(&world, camera(4.0)), &[RED], Exposure(1.0));
    let red = [[0.65, 0.35], [0.35, 0.35], [0.35, 0.65], [0.65, 0.65]]
        .map(|[x, y]| at(&image, x, y) == [218, 0, 0]);
    assert_eq!(red, [true, false, false, false], "red at top right, top left, bottom left, bottom right");
}

#[test]
fn a_wireframe_is_dark_on_visible_edges_only() {
    // A front sheet that hides half of a grid of four.
    let cell = |x: f64, y: f64| [DVec3::new(x, y, 0.0), DVec3::X, DVec3::Y];
    let screen = [DVec3::new(0.01, -2.0, 1.0), DVec3::X * 2.0, DVec3::Y * 4.0];
    let world =
        place(&geometry(&[cell(-1.0, -1.0), cell(0.0, -1.0), cell(-1.0, 0.0), cell(0.0, 0.0), screen]));
    let canvas = trace(&world, camera(4.0));
    let image = picture::wireframe(&canvas, &world.elements);
    let (middle, left, right) = (at(&image, 0.5, 0.5)[0], at(&image, 0.45, 0.5)[0], at(&image, 0.6, 0.5)[0]);
    assert!(left < 140, "{left} on the edge between the left cells");
    assert!(middle < 140, "{middle} where four cells meet");
    assert!(right > 200, "{right} on the screen, which hides the other edge");
    assert!(at(&image, 0.4, 0.4)[0] > 200, "inside a cell");
    assert_eq!(at(&image, 0.02, 0.02), [255; 3], "paper");
}

#[test]
fn a_closed_room_is_looked_into_from_outside() {
    let mut room = cube(DVec3::ZERO);
    for element in &mut room.elements {
        *element = Element::new(element.corners.flipped(), element.material, element.face);
    }
    let world = place(&room);
    let index = RayIndex::new(&world.elements);
    let view = View::of_scene(&[], &world.elements, &index);
    assert!(view.position.abs().max_element() > 0.5, "the eye stands at {}", view.position);
    for corner in world.elements.iter().flat_map(|element| element.corners.as_slice()) {
        let point = view.project(*corner);
        let (x, y) = (point.x / point.z, point.y / point.z);
        assert!(
            point.z > 0.0 && (0.0..960.0).contains(&x) && (0.0..720.0).contains(&y),
            "corner at ({x}, {y})"
        );
    }
    let canvas = Canvas::trace(view, &index);
    let mut seen: Vec<usize> = canvas.elements().collect();
    seen.sort_unstable();
    seen.dedup();
    assert!(seen.len() >= 3, "of the room's six sides {} are seen", seen.len());
}

#[test]
fn exposure_brings_surfaces_up_and_survives_the_dark() {
    let world = place(&cube(DVec3::ZERO));
    let canvas = trace(&world, camera(4.0));
    let choose =
        |b: f64, e: f64| Exposure::choose(|| canvas.elements(), &[Rgb::splat(b); 6], &[Rgb::splat(e); 6]).0;
    // All six sides alike, so the 95th percentile is their own L = B/π. 1e-12: a few roundings.
    for b in [1e-12, 3.0, 1e12] {
        assert!((choose(b, 0.0) * b / PI - 0.8).abs() < 1e-12, "factor {} for radiosity {b}", choose(b, 0.0));
    }
    assert_eq!(choose(3.0, 3.0), choose(3.0, 0.0), "where all are lamps they count");
    assert_eq!(choose(0.0, 0.0), 1.0);
    assert_eq!(choose(f64::NAN, 0.0), 1.0);
}

/// Two instances: a box of six colours far from the origin, and a triangle.
struct Fixture {
    world: World,
    rows: [Vec<Rgb>; 4],
    names: [Vec<String>; 2],
}

impl Fixture {
    fn new() -> Self {
        let triangle = Corners::triangle([DVec3::ZERO, DVec3::X, DVec3::Y / 3.0]);
        let small = clusters::geometry(
            vec![Element::new(triangle, MaterialId(0), FaceId(0))],
            vec![Face::new(triangle.as_slice().to_vec())],
        );
        let far = DAffine3::from_translation(DVec3::new(1e7, 0.1, -3e6)) * DAffine3::from_rotation_y(0.3);
        let world = World::new([(&cube(DVec3::ZERO), far), (&small, DAffine3::IDENTITY)]);
        let rows = [0.1, 1e-17, 2e5 / 3.0, PI].map(|scale| {
            (0..world.elements.len()).map(|i| Rgb([0.1, 0.2, 0.3]) * scale * (i + 1) as f64).collect()
        });
        let names =
            [["box, \"big\"", "tri"], ["a\nb", "plain"]].map(|names| names.map(String::from).to_vec());
        Self { world, rows, names }
    }

    fn light(&self) -> SceneLight<'_> {
        let [reflectance, emission, irradiance, radiosity] = &self.rows;
        let [part_names, instance_names] = &self.names;
        SceneLight {
            world: &self.world,
            origin: DVec3::ZERO,
            reflectance,
            emission,
            irradiance,
            radiosity,
            part_names,
            instance_names,
        }
    }
}

#[test]
fn the_table_reads_back_to_the_same_bits() {
    let fixture = Fixture::new();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("elements.csv");
    elements_csv::write(&path, &fixture.light()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let (header, table) = text.split_once('\n').unwrap();
    assert_eq!(
        header,
        "x,y,z,nx,ny,nz,area,rho_r,rho_g,rho_b,E_r,E_g,E_b,H_r,H_g,H_b,B_r,B_g,B_b,part,instance"
    );
    let table =
        table.replace(",\"box, \"\"big\"\"\",\"a\nb\"", ",box,far").replace(",tri,plain", ",tri,near");
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(lines.len(), fixture.world.elements.len());
    for (i, line) in lines.iter().enumerate() {
        let fields: Vec<&str> = line.split(',').collect();
        let element = &fixture.world.elements[i];
        let mut expected: Vec<f64> = [element.centroid.to_array(), element.normal.to_array()].concat();
        expected.push(element.area);
        expected.extend(fixture.rows.iter().flat_map(|rows| rows[i]));
        let found: Vec<f64> = fields[..19].iter().map(|field| field.parse().unwrap()).collect();
        assert_eq!(found, expected, "element {i}");
        assert_eq!(fields[19..], if i < 6 { ["box", "far"] } else { ["tri", "near"] });
    }
}

#[test]
fn the_model_holds_every_element_in_place_and_colour() {
    let fixture = Fixture::new();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("result.glb");
    model::write(&path, &fixture.light(), Exposure(0.2)).unwrap();

    let gltf::Gltf { document, blob } = gltf::Gltf::open(&path).unwrap();
    let nodes: Vec<_> = document.default_scene().unwrap().nodes().collect();
    assert_eq!(nodes.iter().map(|node| node.name().unwrap()).collect::<Vec<_>>(), ["a\nb", "plain"]);
    for (instance, node) in nodes.iter().enumerate() {
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        assert!(!primitive.material().double_sided());
        let reader = primitive.reader(|_| blob.as_deref());
        let origin = DVec3::from(node.transform().decomposed().0.map(f64::from));
        let positions: Vec<DVec3> =
            reader.read_positions().unwrap().map(|p| DVec3::from(p.map(f64::from)) + origin).collect();
        let colours: Vec<[f32; 3]> = reader.read_colors(0).unwrap().into_rgb_f32().collect();

        let mut vertex = 0;
        for element in fixture.world.elements_of(instance) {
            let corners = fixture.world.elements[element].corners;
            let count = 3 * (corners.as_slice().len() - 2);
            let range = vertex..vertex + count;
            let area: DVec3 =
                positions[range.clone()].chunks(3).map(|p| (p[1] - p[0]).cross(p[2] - p[0])).sum();
            // f32 of lengths up to 2 m: 1.2e-7 each, a handful of them in an area.
            let error = (area - corners.double_area_vector()).length();
            assert!(error < 2e-6, "element {element}: area vector off by {error}");
            // Three and, for a quad, the last of its second triangle.
            for (&corner, place) in corners.as_slice().iter().zip([0, 1, 2, 5]) {
                let found = positions[vertex + place];
                assert!(corner.distance(found) < 1e-6, "element {element}: {corner} became {found}");
            }
            let expected = Exposure(0.2).shown(fixture.rows[3][element]).0.map(|light| light as f32);
            assert_eq!(colours[range], vec![expected; count]);
            vertex += count;
        }
        assert_eq!(positions.len(), vertex, "vertices of instance {instance}");
    }
}
