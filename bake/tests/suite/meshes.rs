//! Occlusion by mesh silhouettes, compared with clipping by each face, and with the row sums of closed scenes.

#[path = "../../../tests/src/curved.rs"]
mod curved;

use curved::{Triangle, sphere, torus};
use equilux_bake::elements::clusters::geometry;
use equilux_bake::elements::{ElementSize, subdivide};
use equilux_bake::form_factor::{contour, plain};
use equilux_bake::geometry::outline::Plane;
use equilux_bake::geometry::polygon::Polygon;
use equilux_bake::meshes::{Mesh, Obstruction, SeenMesh, SeenPolygon};
use equilux_bake::world::World;
use equilux_formats::texture::Textures;
use equilux_formats::{Corners, Element, Face, FaceId, Geometry, Material, MaterialId, Part, Rgb, Surface};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// Loose faces, and meshes that hide as a whole.
struct Scene {
    world: World,
    loose: Vec<u32>,
    meshes: Vec<Mesh>,
}

impl Scene {
    fn new(loose: &[Geometry], meshes: &[Geometry]) -> Self {
        let world = World::new(loose.iter().chain(meshes).map(|g| (g, DAffine3::IDENTITY)));
        let mut first = 0;
        let mut numbers = |of: &Geometry| -> Vec<u32> {
            first += of.faces.len() as u32;
            (first - of.faces.len() as u32..first).collect()
        };
        let loose = loose.iter().flat_map(&mut numbers).collect();
        let meshes = meshes.iter().map(|mesh| Mesh::from_faces(&numbers(mesh), &world.faces)).collect();
        Self { world, loose, meshes }
    }

    /// Form factors from one receiver to all elements.
    fn row(&self, receiver: usize) -> Vec<f64> {
        let element = &self.world.elements[receiver];
        let coplanar = |face| self.world.coplanar(element.face, FaceId(face));
        let meshes = self.meshes.iter();
        let seen: Vec<SeenMesh> =
            meshes.map(|mesh| mesh.seen_from(element.centroid, element.normal, coplanar)).collect();
        (0..self.world.elements.len()).map(|sender| self.entry(receiver, sender, &seen)).collect()
    }

    fn entry(&self, receiver: usize, sender: usize, seen: &[SeenMesh]) -> f64 {
        let (receiver, sender) = (&self.world.elements[receiver], &self.world.elements[sender]);
        let coplanar = |face| self.world.coplanar(sender.face, FaceId(face));
        if coplanar(receiver.face.0) {
            return 0.0;
        }
        let Some(polygon) = plain::visible_side(receiver, sender) else { return 0.0 };
        let mut pieces = vec![polygon];
        for &face in &self.loose {
            if coplanar(face) || self.world.coplanar(receiver.face, FaceId(face)) {
                continue;
            }
            let occluder = &self.world.faces[face as usize];
            let before = Plane { normal: sender.normal, point: sender.corners.as_slice()[0] };
            let Some(pyramid) = plain::hidden_pyramid(receiver.centroid, occluder, before) else { continue };
            pieces = subtract(pieces, |piece, outside| pyramid.subtract_from(piece, outside));
        }
        for mesh in seen {
            pieces = subtract(pieces, |piece, outside| {
                let seen_sender = SeenPolygon::new(piece, sender.normal, sender.face.0);
                Obstruction::new(mesh, &seen_sender, coplanar)
                    .subtract(&mut |piece| outside.push(Polygon::from_slice(piece)));
            });
        }
        pieces.iter().map(|piece| contour::form_factor(piece, receiver.normal)).sum()
    }

    /// Every entry of about `rows` rows equals the one from clipping by every face.
    ///
    /// Both ways are exact; they add up different pieces, and rounding differs by as many units in the last place as
    /// there are pieces.
    fn rows_are_plain(&self, rows: usize) {
        for receiver in self.some(rows) {
            for (sender, &value) in self.row(receiver).iter().enumerate() {
                let plain = plain::form_factor(&self.world, receiver, sender);
                let pair = (&self.world.elements[receiver].centroid, &self.world.elements[sender].centroid);
                assert!(
                    (value - plain).abs() <= 1e-11,
                    "{receiver} ← {sender}, {pair:?}: {value} for {plain}"
                );
            }
        }
    }

    /// The light of a closed scene arrives in full, but for rounding.
    fn rows_sum_to_one(&self, rows: usize) {
        for receiver in self.some(rows) {
            let sum: f64 = self.row(receiver).iter().sum();
            assert!(
                (sum - 1.0).abs() <= 1e-12,
                "row {receiver} of a closed scene sums to 1 + {:e}",
                sum - 1.0
            );
        }
    }

    fn some(&self, count: usize) -> impl Iterator<Item = usize> {
        (0..self.world.elements.len()).step_by((self.world.elements.len() / count).max(1))
    }
}

fn subtract(pieces: Vec<Polygon>, mut from: impl FnMut(Polygon, &mut Vec<Polygon>)) -> Vec<Polygon> {
    let mut outside = Vec::new();
    pieces.into_iter().for_each(|piece| from(piece, &mut outside));
    outside
}

fn part(surfaces: impl IntoIterator<Item = Corners>, double_sided: bool) -> Part {
    let surfaces = surfaces.into_iter().map(|corners| Surface::new(corners, MaterialId(0))).collect();
    let grey = Material {
        name: String::new(),
        reflectance: Rgb([0.5; 3]),
        emission: Rgb::BLACK,
        double_sided,
        textures: Textures::default(),
    };
    Part {
        name: String::new(),
        surfaces,
        materials: vec![grey],
        textured: vec![],
        element_size: None,
        local_solver: None,
    }
}

/// A cube of two metres around the origin, seen from inside.
fn room(size: f64) -> Geometry {
    let side = |axis: usize, sign: f64| {
        let (n, u, v) = (DVec3::AXES[axis] * sign, DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3]);
        let corners = Corners::quad([n - u - v, n + u - v, n + u + v, n - u + v]);
        if sign > 0.0 { corners.flipped() } else { corners }
    };
    let sides = (0..3).flat_map(|axis| [side(axis, 1.0), side(axis, -1.0)]);
    subdivide(&part(sides, false), ElementSize::Metres(size))
}

/// The triangles, moved.
fn solid(triangles: &[Triangle], placement: DAffine3) -> Geometry {
    let moved = triangles.iter().map(|t| Corners::triangle(t.map(|p| placement.transform_point3(p))));
    subdivide(&part(moved, false), ElementSize::Mesh)
}

/// The triangles, moved, with elements on both sides.
fn sheet(triangles: &[Triangle], placement: DAffine3) -> Geometry {
    let moved = triangles.iter().map(|t| Corners::triangle(t.map(|p| placement.transform_point3(p))));
    subdivide(&part(moved, true), ElementSize::Mesh)
}

fn placed(axis: [f64; 3], angle: f64, to: [f64; 3]) -> DAffine3 {
    let turn = DQuat::from_axis_angle(DVec3::from(axis).normalize(), angle);
    DAffine3::from_rotation_translation(turn, DVec3::from(to))
}

/// Anyhow, or in line with the room, so that corners and edges cover each other to the last digits.
fn placement(reach: f64) -> impl Strategy<Value = DAffine3> {
    let long_enough = |axis: &[f64; 3]| DVec3::from(*axis).length() > 0.1;
    let axis = prop::array::uniform3(-1.0..1.0).prop_filter("an axis", long_enough);
    let anyhow = (axis, 0.0..3.0, prop::array::uniform3(-reach..reach))
        .prop_map(|(axis, angle, to)| placed(axis, angle, to));
    let aligned = (0..3usize, 0..4, prop::array::uniform3(-1..=1)).prop_map(move |(axis, quarters, to)| {
        let angle = f64::from(quarters) * FRAC_PI_2;
        placed(DVec3::AXES[axis].to_array(), angle, to.map(|steps| f64::from(steps) * reach))
    });
    prop_oneof![anyhow, aligned]
}

fn small_torus() -> Vec<Triangle> {
    torus((0.4, 0.15), 10, 4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn a_turned_torus_and_sphere_hide_what_their_faces_hide(torus_at in placement(0.3), sphere_at in placement(0.7)) {
        let meshes = [solid(&small_torus(), torus_at), solid(&sphere(0.25, 1), sphere_at)];
        let scene = Scene::new(&[room(0.5)], &meshes);
        scene.rows_are_plain(12);
    }

    #[test]
    fn light_around_interlocked_tori_arrives_in_full(at in placement(0.05)) {
        let one = torus((0.4, 0.1), 24, 12);
        let link = placed([1.0, 0.0, 0.0], 1.5, [0.4, 0.0, 0.0]);
        let scene = Scene::new(&[room(0.25)], &[solid(&one, at), solid(&one, at * link)]);
        scene.rows_sum_to_one(24);
    }

    #[test]
    fn a_torus_cut_by_a_shelf_hides_what_its_faces_hide(at in placement(0.2)) {
        let shelf = [dvec3(-0.8, 0.05, -0.8), dvec3(-0.8, 0.05, 0.8), dvec3(0.8, 0.05, 0.8), dvec3(0.8, 0.05, -0.8)];
        let shelf = subdivide(&part([Corners::quad(shelf)], true), ElementSize::Metres(0.4));
        Scene::new(&[room(1.0), shelf], &[solid(&small_torus(), at)]).rows_are_plain(24);
    }

    #[test]
    fn sheets_and_loose_triangles_hide_what_their_faces_hide(at in placement(0.2), kept in 2usize..5) {
        let torn: Vec<Triangle> =
            small_torus().into_iter().enumerate().filter(|(i, _)| i % kept != 0).map(|(_, t)| t).collect();
        let scene = Scene::new(&[room(1.0)], &[sheet(&torn, at)]);
        assert!(!scene.meshes[0].bounds_a_solid);
        scene.rows_are_plain(16);
        scene.rows_sum_to_one(32);
    }

    #[test]
    fn meshes_that_cross_themselves_hide_what_their_faces_hide(at in placement(0.2), apart in 0.1..0.3) {
        let far = placed([0.0, 0.0, 1.0], 0.3, [apart, 0.0, 0.0]);
        let mut both = sphere(0.3, 1);
        both.extend(sphere(0.3, 1).into_iter().map(|t| t.map(|p| far.transform_point3(p))));
        let scene = Scene::new(&[room(1.0)], &[sheet(&both, at)]);
        assert!(!scene.meshes[0].bounds_a_solid);
        scene.rows_are_plain(12);
        scene.rows_sum_to_one(32);
    }

    #[test]
    fn blocks_on_a_grid_hide_what_their_faces_hide(cells in prop::collection::vec(any::<bool>(), 27)) {
        // Seen from the middles of walls that the grid is in line with, edges cover each other and are seen end-on.
        let blocks = blocks(&cells);
        prop_assume!(!blocks.is_empty());
        let sides = blocks.iter().enumerate().map(|(face, &corners)| {
            let element = Element::new(corners, MaterialId(0), FaceId(face as u32));
            (element, Face::new(corners.as_slice().to_vec()))
        });
        let (elements, faces) = sides.unzip();
        Scene::new(&[room(0.4)], &[geometry(elements, faces)]).rows_are_plain(12);
        // Merged faces meet with their edges, but not edge to edge.
        let merged = subdivide(&part(blocks, false), ElementSize::Metres(0.4));
        Scene::new(&[room(0.4)], &[merged]).rows_are_plain(12);
    }
}

/// The sides of cubes in a grid of three in each direction around the origin.
fn blocks(cells: &[bool]) -> Vec<Corners> {
    let filled = |cell: [i32; 3]| {
        cell.iter().all(|c| (0..3).contains(c)) && cells[(cell[0] + 3 * cell[1] + 9 * cell[2]) as usize]
    };
    let mut sides = Vec::new();
    for cell in (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]).filter(|&cell| filled(cell)) {
        for (axis, up) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut neighbour = cell;
            neighbour[axis] += 2 * up - 1;
            if filled(neighbour) {
                continue;
            }
            let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[u, v]| {
                let mut corner = cell;
                corner[axis] += up;
                corner[(axis + 1) % 3] += u;
                corner[(axis + 2) % 3] += v;
                (DVec3::from(corner.map(f64::from)) - 1.5) * 0.4
            });
            let side = Corners::quad(corners);
            sides.push(if up == 1 { side } else { side.flipped() });
        }
    }
    sides
}

#[test]
fn a_hollow_torus_is_a_room_of_its_own() {
    let inwards: Vec<Triangle> = torus((0.6, 0.3), 12, 6).iter().map(|&[a, b, c]| [a, c, b]).collect();
    let ball = solid(&sphere(0.1, 1), placed([1.0, 2.0, 3.0], 0.4, [0.6, 0.05, -0.05]));
    let scene = Scene::new(&[], &[solid(&inwards, placed([1.0, 0.2, 0.3], 0.5, [0.0; 3])), ball]);
    assert!(scene.meshes[0].bounds_a_solid, "it bounds all the space around it");
    scene.rows_are_plain(24);
}

#[test]
fn nothing_is_seen_through_a_mesh_from_within() {
    // The receivers of the inner sphere are inside of the outer one's solid, and its fronts face away from them.
    let scene = Scene::new(
        &[room(1.0)],
        &[solid(&sphere(0.5, 1), DAffine3::IDENTITY), solid(&sphere(0.2, 1), DAffine3::IDENTITY)],
    );
    scene.rows_are_plain(40);
}
