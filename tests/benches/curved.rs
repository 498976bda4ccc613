//! Cost of a row in a room with eight closed curved meshes: clipping by every face, and by silhouettes only.
//!
//! `cargo bench -p equilux-tests --bench curved -- [sphere|torus]… [80|1280|5120]…`; by default all.

use equilux_bake::elements::{ElementSize, subdivide};
use equilux_bake::form_factor::{contour, plain};
use equilux_bake::geometry::polygon::{Hides, Polygon, Pyramid};
use equilux_bake::meshes::{Mesh, Obstruction, SeenMesh, SeenPolygon, Span, Spans};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, EXACT, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::{Element, FaceId, Geometry};
use equilux_tests::curved::{Triangle, sphere, torus};
use equilux_tests::shapes::{fine, grey, moved, part, room, triangle};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let wanted = |names: &[&'static str]| -> Vec<&'static str> {
        let named: Vec<&str> =
            names.iter().copied().filter(|name| arguments.iter().any(|a| a == name)).collect();
        if named.is_empty() { names.to_vec() } else { named }
    };
    println!(
        "µs a row: of walls as senders, by silhouettes and by faces; of everything, on walls and on meshes; and on walls \
         by the treecode, exact and at a tolerance of 0.01"
    );
    println!(
        "{:>7} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "shape",
        "faces",
        "to walls",
        "by faces",
        "differ",
        "all",
        "on mesh",
        "seen",
        "defect",
        "exact",
        "defect",
        "0.01",
        "defect"
    );
    for shape in wanted(&["sphere", "torus"]) {
        wanted(&["80", "1280", "5120"]).into_iter().for_each(|faces| measure(shape, faces));
    }
}

fn triangles(shape: &str, faces: &str) -> Vec<Triangle> {
    match (shape, faces) {
        ("sphere", "80") => sphere(0.5, 1),
        ("sphere", "1280") => sphere(0.5, 3),
        ("sphere", _) => sphere(0.5, 4),
        (_, "80") => torus((0.4, 0.15), 10, 4),
        (_, "1280") => torus((0.4, 0.15), 32, 20),
        _ => torus((0.4, 0.15), 64, 40),
    }
}

/// The room, 1504 elements, and eight closed meshes.
struct Scene {
    world: World,
    meshes: Vec<Mesh>,
    walls: usize,
}

impl Scene {
    fn new(triangles: &[Triangle]) -> Self {
        let walls = fine(&room(grey(0.5, 0.0), DVec3::ZERO, dvec3(3.0, 5.0, 4.0)), 0.25);
        let mut geometries = vec![walls];
        for k in 0..8 {
            let place = dvec3(
                f64::from(k & 1) * 1.5 + 0.75,
                f64::from(k >> 1 & 1) * 2.5 + 1.2,
                f64::from(k >> 2) * 2.0 + 1.0,
            );
            let turn =
                DQuat::from_axis_angle(dvec3(1.0, 0.3 * f64::from(k), 0.7).normalize(), 0.9 + f64::from(k));
            geometries.push(object(triangles, DAffine3::from_rotation_translation(turn, place)));
        }
        let world = World::new(geometries.iter().map(|g| (g, DAffine3::IDENTITY)));
        let mut first = geometries[0].faces.len() as u32;
        let mut meshes = Vec::new();
        for geometry in &geometries[1..] {
            let group: Vec<u32> = (first..first + geometry.faces.len() as u32).collect();
            meshes.push(Mesh::from_faces(&group, &world.faces));
            first += geometry.faces.len() as u32;
        }
        Self { walls: geometries[0].elements.len(), world, meshes }
    }

    fn seen_from(&self, receiver: &Element) -> Vec<SeenMesh<'_>> {
        let coplanar = |face| self.world.coplanar(receiver.face, FaceId(face));
        self.meshes.iter().map(|mesh| mesh.seen_from(receiver.centroid, receiver.normal, coplanar)).collect()
    }

    fn row(&self, receiver: &Element, seen: &[SeenMesh], senders: &[Element]) -> f64 {
        let (mut pieces, mut outside): (Vec<Polygon>, Vec<Polygon>) = (vec![], vec![]);
        let mut sum = 0.0;
        for sender in senders {
            if self.world.coplanar(receiver.face, sender.face) {
                continue;
            }
            let Some(polygon) = plain::visible_side(receiver, sender) else { continue };
            let whole = SeenPolygon::new(polygon.clone(), sender.normal, sender.face.0);
            let coplanar = |face| self.world.coplanar(sender.face, FaceId(face));
            pieces.push(polygon);
            for mesh in seen.iter().filter(|mesh| mesh.span.meets(&whole.span)) {
                for piece in pieces.drain(..) {
                    let piece = SeenPolygon::new(piece, sender.normal, sender.face.0);
                    Obstruction::new(mesh, &piece, coplanar)
                        .subtract(&mut |piece| outside.push(Polygon::from_slice(piece)));
                }
                std::mem::swap(&mut pieces, &mut outside);
            }
            sum += pieces.drain(..).map(|piece| contour::form_factor(&piece, receiver.normal)).sum::<f64>();
        }
        sum
    }

    /// Every face that faces the receiver hides its own pyramid, found with the same index of directions.
    fn row_by_faces(&self, receiver: &Element, senders: &[Element]) -> f64 {
        let x = receiver.centroid;
        let faces =
            self.meshes.iter().flat_map(|mesh| &mesh.faces).map(|&face| &self.world.faces[face as usize]);
        let looking: Vec<Polygon> = faces
            .filter(|face| face.normal.dot(face.corners[0] - x) < 0.0)
            .map(|face| face.corners.iter().map(|&p| p - x).collect())
            .collect();
        let pyramids: Vec<Pyramid> =
            looking.iter().map(|f| Pyramid::over(f, (f[1] - f[0]).cross(f[2] - f[0]))).collect();
        let spans: Vec<Span> =
            looking.iter().map(|f| Span::over(f.iter().map(|p| p.normalize().as_vec3a()))).collect();
        let index = Spans::new(&spans);
        let (mut pieces, mut outside): (Vec<Polygon>, Vec<Polygon>) = (vec![], vec![]);
        let mut sum = 0.0;
        for sender in senders {
            let Some(polygon) = plain::visible_side(receiver, sender) else { continue };
            let span = Span::over(polygon.iter().map(|p| p.normalize().as_vec3a()));
            let mut before: Vec<&Pyramid> = vec![];
            let hidden = index.any(&span, |i| {
                let hides = pyramids[i].hides(&polygon);
                before.extend((hides == Hides::Part).then_some(&pyramids[i]));
                hides == Hides::All
            });
            if hidden {
                continue;
            }
            // Those that hide most come first: often nothing is left to clip.
            before.sort_by_cached_key(|pyramid| std::cmp::Reverse(pyramid.corners_inside(&polygon)));
            pieces.push(polygon);
            for pyramid in before {
                for piece in pieces.drain(..) {
                    match pyramid.hides(&piece) {
                        Hides::All => {}
                        Hides::Nothing => outside.push(piece),
                        Hides::Part => pyramid.subtract_from(piece, &mut outside),
                    }
                }
                std::mem::swap(&mut pieces, &mut outside);
            }
            sum += pieces.drain(..).map(|piece| contour::form_factor(&piece, receiver.normal)).sum::<f64>();
        }
        sum
    }

    /// The treecode's rows of everything on the walls: mean time a row, µs, and the largest defect of a row's sum.
    fn rows(&self, resolution: Resolution) -> (f64, f64) {
        let senders: Vec<usize> = (0..self.world.instances()).collect();
        let request = Request::new(&self.world, Audience::Instance(0), &senders, resolution);
        let rows = block(&request, &Monitor::default()).expect("not stopped");
        let defect = rows.row_sums.iter().map(|sum| (sum - 1.0).abs()).fold(0.0, f64::max);
        (rows.time.as_secs_f64() * 1e6 / self.walls as f64, defect)
    }
}

fn object(triangles: &[Triangle], placement: DAffine3) -> Geometry {
    let whole = triangles.iter().fold(part(grey(0.5, 0.0)), |part, t| triangle(part, *t));
    subdivide(&moved(whole, placement), ElementSize::Mesh)
}

/// Rows that are measured, of walls and of meshes, and by faces of the larger meshes.
const ROWS: (usize, usize) = (32, 4);

fn measure(shape: &str, faces: &str) {
    let scene = Scene::new(&triangles(shape, faces));
    let elements = &scene.world.elements;
    let (walls, bodies) = elements.split_at(scene.walls);
    let some = |of: &[Element], count: usize| -> Vec<Element> {
        of.iter().step_by(of.len() / count).copied().collect()
    };
    let row =
        |receiver: &Element, senders: &[Element]| scene.row(receiver, &scene.seen_from(receiver), senders);

    let on_walls = some(walls, ROWS.0);
    let seen = micros(&on_walls, |receiver| drop(scene.seen_from(receiver)));
    let to_walls = micros(&on_walls, |receiver| _ = row(receiver, walls));

    let mut differ = 0.0f64;
    let few = some(walls, if faces == "80" { ROWS.0 } else { ROWS.1 });
    let mut plain = vec![];
    let by_faces = micros(&few, |receiver| plain.push(scene.row_by_faces(receiver, walls)));
    for (receiver, plain) in few.iter().zip(plain) {
        differ = differ.max((row(receiver, walls) - plain).abs());
    }

    let mut defect = 0.0f64;
    let mut all = |receivers: &[Element]| {
        micros(receivers, |receiver| defect = defect.max((row(receiver, elements) - 1.0).abs()))
    };
    let (all, on_mesh) = (all(&on_walls), all(&some(bodies, ROWS.0)));
    print!("{shape:>7} {faces:>6} {to_walls:>9.0} {by_faces:>9.0} {differ:>9.0e} ");
    print!("{all:>9.0} {on_mesh:>9.0} {seen:>9.0} {defect:>9.0e} ");
    let (exact, defect) = scene.rows(EXACT);
    print!("{exact:>9.0} {defect:>9.0e} ");
    let (clusters, defect) = scene.rows(Resolution::for_tolerance(0.01));
    println!("{clusters:>9.0} {defect:>9.0e}");
}

/// Mean time a receiver.
fn micros(receivers: &[Element], mut work: impl FnMut(&Element)) -> f64 {
    let start = Instant::now();
    receivers.iter().for_each(&mut work);
    start.elapsed().as_secs_f64() * 1e6 / receivers.len() as f64
}
