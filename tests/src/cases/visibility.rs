//! Occlusion is exact for occluders of any size, thickness and number.

use super::form_factors::romberg;
use super::point::{facing, receiver, seen};
use super::solve::{Setting, light};
use super::{Case, Finding};
use crate::model::Node;
use crate::rooms::furnished;
use crate::shapes::{
    alone, coupling, fine, grey, joined, moved, part, rectangle, room, self_block, solid, triangle,
};
use crate::workshop::Workshop;
use equilux_bake::form_factor::{contour, plain};
use equilux_bake::gltf_import::import_scene;
use equilux_bake::treecode::EXACT;
use equilux_bake::world::World;
use equilux_formats::{Material, Part};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use std::f64::consts::PI;

/// A square of side 1 at height 1, seen from below its middle.
const SQUARE: f64 = 0.23945647046077354;

/// The cases.
pub fn cases() -> Vec<Case> {
    let few = "exact in closed form; left is the rounding of a few edge terms";
    vec![
        Case::new("a blocker hides its quarter", 1e-14, few, || {
            Finding::absolute(
                0.75 * SQUARE,
                square_behind(facing(dvec3(0., 0., 0.5), dvec3(0.5, 0.5, 0.5), DVec3::Z)),
            )
        }),
        Case::new("what is wholly hidden", 0.0, "nothing is left, not a rounded nothing", || {
            Finding::absolute(0.0, square_behind(facing(dvec3(-1., -1., 0.5), dvec3(2., 2., 0.5), DVec3::Z)))
        }),
        Case::new(
            "a fence of 16 slats lets half through",
            1e-12,
            "sixteen slats, some hundred roundings",
            || fence(16),
        ),
        Case::new(
            "a fence of 512 slats lets half through",
            1e-12,
            "some thousand roundings of 1e-17 each",
            || fence(512),
        ),
        Case::new(
            "a sliver of aspect 1e6 hides its shadow",
            1e-8,
            "the shadow, 5e-7, is known to 1e-16",
            sliver,
        ),
        Case::new("a pinhole of side 1e-3", 1e-6, "the hole's corners are known to 1e-16 / 1e-3", || {
            Finding::relative(3.183097800805324e-7, pinhole(1e-3))
        }),
        Case::new(
            "a pinhole of side 1e-6",
            1e-3,
            "seams of plates, 1e-16 wide, beside a hole of 3e-13",
            || Finding::relative(3.1830988618368457e-13, pinhole(1e-6)),
        ),
        Case::new(
            "a disc behind a disc shows its ring",
            1e-13,
            "closed form of polygons of 64 corners",
            ring,
        ),
    ]
    .into_iter()
    .chain(scenes())
    .collect()
}

fn scenes() -> Vec<Case> {
    vec![
        Case::new(
            "a square between plates, averaged",
            1e-8,
            "what Romberg's scheme leaves at 32 × 32; kinks follow the grid",
            between_plates,
        ),
        Case::new(
            "hidden never exceeds unhidden, rows never 1",
            1e-12,
            "some hundred roundings a row",
            only_taken,
        ),
        Case::new(
            "turned open boxes with f32 corners hide no more than they should",
            1e-6,
            "corners in f32 lie in a plane within 2e-7",
            open_boxes,
        ),
        Case::new("a sheet lets nothing through", 0.0, "not a rounded nothing, T-junctions or not", sheet),
        Case::new("a sheet lets nothing through, in 8 parts", 1e-15, CRACKS, cut_sheet),
    ]
}

/// Why the tolerance for a cut sheet is not zero.
const CRACKS: &str = "edges of cells that meet in T-junctions are one line but for their last digit";

fn square_behind(blocker: Part) -> f64 {
    let square = facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z);
    seen(&[receiver(dvec3(0.5, 0.5, 0.), DVec3::Z), square, blocker])
}

/// What lies at x is hidden where what lies at −x is seen.
fn fence(slats: i32) -> Finding {
    let step = 1.0 / f64::from(slats);
    let slat = |k: i32| {
        let left = f64::from(k) * step;
        facing(dvec3(left, -2., 0.5), dvec3(left + step / 2.0, 2., 0.5), DVec3::Z)
    };
    let found = seen(&[
        receiver(DVec3::ZERO, DVec3::Z),
        facing(dvec3(-0.5, -0.5, 1.), dvec3(0.5, 0.5, 1.), -DVec3::Z),
        joined((-slats / 2..slats / 2).map(slat)),
    ]);
    Finding::absolute(SQUARE / 2.0, found)
}

fn sliver() -> Finding {
    let found = square_behind(facing(dvec3(0.5 - 5e-7, 0.25, 0.5), dvec3(0.5 + 5e-7, 0.75, 0.5), DVec3::Z));
    Finding::relative(5.498151442475563e-7, SQUARE - found)
}

/// Four plates around a square hole on the axis at height 1, before a screen at height 2.
fn pinhole(side: f64) -> f64 {
    let (hole, wide) = (side / 2.0, 50.0);
    let plate = [
        (dvec3(-wide, -wide, 1.), dvec3(wide, -hole, 1.)),
        (dvec3(-wide, hole, 1.), dvec3(wide, wide, 1.)),
        (dvec3(-wide, -hole, 1.), dvec3(-hole, hole, 1.)),
        (dvec3(hole, -hole, 1.), dvec3(wide, hole, 1.)),
    ];
    seen(&[
        receiver(DVec3::ZERO, DVec3::Z),
        facing(dvec3(-2., -2., 2.), dvec3(2., 2., 2.), -DVec3::Z),
        joined(plate.map(|(low, high)| facing(low, high, -DVec3::Z))),
    ])
}

/// The form factor to a regular polygon with its middle at height h over the point: Σ of m equal edge terms. As m grows
/// it becomes R²/(R²+h²), and a ring's R²/(R²+h²) − b²/(b²+c²).
fn ring() -> Finding {
    let m = 64;
    let polygon = |radius: f64, h: f64| {
        let half = PI / f64::from(m);
        let slant = (radius * half.cos()).hypot(h);
        f64::from(m) / PI * (radius * half.cos() / slant) * (radius * half.sin() / slant).atan()
    };
    let disc = |radius: f64, height: f64| {
        let at = |k: i32| {
            let angle = 2.0 * PI * f64::from(k % m) / f64::from(m);
            dvec3(radius * angle.cos(), -radius * angle.sin(), height)
        };
        (0..m).fold(part(grey(0.5, 0.0)), |p, k| triangle(p, [dvec3(0., 0., height), at(k), at(k + 1)]))
    };
    let found = seen(&[receiver(DVec3::ZERO, DVec3::Z), disc(2.0, 2.0), disc(0.5, 1.0)]);
    Finding::absolute(polygon(2.0, 2.0) - polygon(0.5, 1.0), found)
}

/// Unit plates at distance 1, a square of side ½ midway: from the lower to the upper, averaged over the lower.
/// F = 4/π ∫∫ [(1−u)(1−v) − min(½,1−u) min(½,1−v)] / (1+u²+v²)² du dv over the unit square.
fn between_plates() -> Finding {
    let levels = [4.0, 8.0, 16.0, 32.0].map(|n: f64| {
        let lower = fine(&facing(DVec3::ZERO, dvec3(1., 1., 0.), DVec3::Z), 1.0 / n);
        let upper = fine(&facing(dvec3(0., 0., 1.), dvec3(1., 1., 1.), -DVec3::Z), 1.0);
        let blocker = fine(&facing(dvec3(0.25, 0.25, 0.5), dvec3(0.75, 0.75, 0.5), DVec3::Z), 1.0);
        let world = World::new([&lower, &upper, &blocker].map(|g| (g, DAffine3::IDENTITY)));
        let rows = coupling(&world, 0, &[1], EXACT);
        (0..rows.receivers()).map(|i| rows.row_sum(i)).sum::<f64>() / rows.receivers() as f64
    });
    Finding::absolute(0.0995062945989848, romberg(levels))
}

/// 0 ≤ F ≤ F with nothing in the way, and Σ F ≤ 1, in a furnished room.
fn only_taken() -> Finding {
    let all = joined(furnished().into_iter().filter_map(|node| node.part));
    let geometry = fine(&all, 0.5);
    let (world, block) = (alone(&geometry), self_block(&geometry));
    let unhidden = |i: usize, j: usize| {
        let [receiver, sender] = [i, j].map(|k| &world.elements[k]);
        plain::visible_side(receiver, sender).map_or(0.0, |p| contour::form_factor(&p, receiver.normal))
    };
    let excess = |i: usize| {
        let entries = block.row(i).map(move |(j, f)| (f - unhidden(i, j)).max(-f));
        entries.fold(block.row_sum(i) - 1.0, f64::max)
    };
    let worst = (0..block.receivers()).map(excess).fold(0.0, f64::max);
    Finding::of("0 ≤ F ≤ unhidden F, Σ F ≤ 1", format!("exceeded by {worst:.1e}"), worst)
}

/// Boxes without a lid, turned any way, read from a file: rows of the room around them sum to one.
fn open_boxes() -> Finding {
    let defect = |k: usize| {
        // Weyl sequences: they look random, and are the same every time.
        let [x, y, z, angle] = [0.7548776662, 0.5698402909, 0.618033988, 0.3247179572]
            .map(|step: f64| ((k + 1) as f64 * step).fract());
        let axis = dvec3(x - 0.5, y - 0.5, z).normalize();
        let turn = DQuat::from_axis_angle(axis, 6.0 * angle);
        let place = DAffine3::from_rotation_translation(turn, dvec3(0.5, 0.45, 0.55));
        let paint = Material { double_sided: true, ..grey(0.5, 0.0) };
        let mut open = moved(solid(paint, DVec3::splat(-0.1), dvec3(0.1, 0.12, 0.08)), place);
        open.surfaces.remove(k % 6);
        let walls = room(grey(0.5, 0.0), DVec3::ZERO, DVec3::ONE);
        let workshop = Workshop::with(&[Node::new("room", joined([walls, open]))]);
        let scene = import_scene(&workshop.path("scene.glb")).expect("a scene");
        let block = self_block(&fine(&scene.parts[0], 0.5));
        (0..block.receivers()).map(|i| (block.row_sum(i) - 1.0).abs()).fold(0.0, f64::max)
    };
    let worst = (0..60).map(defect).fold(0.0, f64::max);
    Finding::of("rows sum to 1", format!("1 ± {worst:.1e}"), worst)
}

/// A tower with a floor of one sheet; everything below it emits.
fn tower() -> Vec<Node> {
    let height = 0.4375;
    let lower = room(grey(0.5, 1.0), DVec3::ZERO, dvec3(1., 1., height));
    let upper = room(grey(0.5, 0.0), dvec3(0., 0., height), DVec3::ONE);
    let open = |mut part: Part| {
        part.surfaces.retain(|s| !s.corners.as_slice().iter().all(|p| p.z == height));
        part
    };
    let floor = Material { double_sided: true, ..grey(0.5, 0.0) };
    let floor = rectangle(part(floor), dvec3(0., 0., height), DVec3::X, DVec3::Y);
    vec![Node::new("tower", joined([open(lower), open(upper), floor]))]
}

fn dark_above(setting: &Setting) -> Finding {
    let solved = light(&tower(), setting);
    let above = solved
        .elements
        .iter()
        .filter(|e| e.centroid.z > 0.4375 || e.centroid.z == 0.4375 && e.normal.z > 0.0);
    let leaks = Finding::worst_absolute(above.map(|e| (0.0, e.radiosity[0])));
    let defect = solved.report.row_sum_defect.max;
    assert!(defect <= 1e-12, "a row of this closed scene sums to 1 ± {defect:e}");
    leaks.after(solved.rounds())
}

/// The grids of walls and floor are independent, so their edges meet in T-junctions.
fn sheet() -> Finding {
    Finding::worst([0.3, 0.17].map(|size| dark_above(&Setting::metres(size))))
}

fn cut_sheet() -> Finding {
    dark_above(&Setting::metres(0.3).cut(8))
}
