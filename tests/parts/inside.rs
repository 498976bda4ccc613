//! Notes name solids that intersect, with the number of elements inside them, but not solids that only touch.

use equilux_assemble::equation::interpenetration::{ElementsInside, elements_inside, sentences};
use equilux_bake::world::World;
use equilux_formats::{Geometry, Instance, Part, PartId, TexelChoice};
use equilux_tests::rooms::paint;
use equilux_tests::shapes::{fine, joined, part, rectangle, room, solid};
use glam::{DAffine3, DQuat, DVec3, dvec3};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Parts at their places. No form factor matters here.
struct Placed {
    geometries: Vec<Geometry>,
    instances: Vec<Instance>,
    world: World,
}

impl Placed {
    fn new(parts: Vec<(Part, DAffine3)>, size: f64) -> Self {
        let geometries: Vec<Geometry> = parts.iter().map(|(part, _)| fine(part, size)).collect();
        let instance = |(number, (part, placement)): (usize, &(Part, DAffine3))| Instance {
            name: part.name.clone(),
            part: PartId::from_index(number),
            placement: *placement,
            emission_scale: 1.0,
            repainted: vec![],
            texels: TexelChoice::default(),
        };
        let world = World::new(
            geometries.iter().zip(&parts).map(|(geometry, (_, placement))| (geometry, *placement)),
        );
        Self { geometries, instances: parts.iter().enumerate().map(instance).collect(), world }
    }

    fn inside(&self) -> ElementsInside {
        elements_inside(&self.world, &self.instances, &self.geometries.iter().collect::<Vec<_>>())
    }
}

fn named(name: &str, part: Part) -> Part {
    Part { name: name.into(), ..part }
}

fn block(name: &str, low: DVec3, high: DVec3) -> Part {
    named(name, solid(paint([0.5; 3]), low, high))
}

fn hall() -> Part {
    named("hall", room(paint([0.5; 3]), DVec3::splat(-4.0), DVec3::splat(4.0)))
}

/// A wall of 2 × 2 m, 0.5 m thick, with a doorway: what merging leaves of its sides meets along parts of edges.
fn wall_with_door() -> Part {
    let pier = |x: f64| solid(paint([0.5; 3]), dvec3(x, 0.0, 0.0), dvec3(x + 0.5, 2.0, 0.5));
    let mut wall =
        joined([pier(0.0), pier(1.5), solid(paint([0.5; 3]), dvec3(0.5, 1.5, 0.0), dvec3(1.5, 2.0, 0.5))]);
    // Where the lintel meets the piers there is no surface; the piers' sides go on below it.
    wall.surfaces.retain(|surface| {
        let inner = |x: f64| surface.corners.as_slice().iter().all(|p| p.x == x);
        !inner(0.5) && !inner(1.5)
    });
    let below = rectangle(part(paint([0.5; 3])), dvec3(0.5, 0.0, 0.0), DVec3::Y * 1.5, DVec3::Z * 0.5);
    let other = rectangle(part(paint([0.5; 3])), dvec3(1.5, 0.0, 0.0), DVec3::Z * 0.5, DVec3::Y * 1.5);
    named("wall", joined([wall, below, other]))
}

fn turn() -> impl Strategy<Value = DQuat> {
    (-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.25..1.0_f64)
        .prop_map(|(x, y, z, w)| DQuat::from_xyzw(x, y, z, w).normalize())
}

proptest! {
    // A few thousand elements each.
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_is_pushed_into_a_wall_is_found_element_by_element(
        wall_turn in turn(), crate_turn in turn(), scale in 0.5..1.0_f64, x in 0.0..2.0_f64, y in 0.0..2.0_f64, z in -0.5..1.0_f64,
    ) {
        let wall_at = DAffine3::from_scale_rotation_translation(DVec3::splat(scale), wall_turn, DVec3::ZERO);
        let crate_at = wall_at * DAffine3::from_rotation_translation(crate_turn, dvec3(x, y, z));
        let parts = vec![
            (hall(), DAffine3::IDENTITY),
            (wall_with_door(), wall_at),
            (block("crate", DVec3::splat(-0.375), DVec3::splat(0.375)), crate_at),
        ];
        let placed = Placed::new(parts, 0.25);
        let in_wall = |p: DVec3, margin: f64| {
            let within = |low: DVec3, high: DVec3| (p + margin).cmpgt(low).all() && (p - margin).cmplt(high).all();
            within(DVec3::ZERO, dvec3(2.0, 2.0, 0.5)) && !(p.x > 0.5 + margin && p.x < 1.5 - margin && p.y < 1.5 - margin)
        };
        let found = placed.inside();
        let crates = found.get(&[2, 1]).cloned().unwrap_or_default();
        for number in placed.world.elements_of(2) {
            let at = wall_at.inverse().transform_point3(placed.world.elements[number].centroid);
            // Elements are a quarter of a metre at most, in the crate's coordinates; a hundredth of one is too little to tell.
            let (sure, possible) = (in_wall(at, -0.003), in_wall(at, 0.003));
            prop_assert!(crates.contains(&number) || !sure, "element {} at {} in the wall is not found", number, at);
            prop_assert!(possible || !crates.contains(&number), "element {} at {} is not in the wall", number, at);
        }
        prop_assert!(found.keys().all(|pair| *pair == [2, 1] || *pair == [1, 2]), "{:?}", found.keys());
    }
}

fn found(parts: Vec<(Part, DAffine3)>) -> BTreeMap<[usize; 2], usize> {
    Placed::new(parts, 0.5).inside().into_iter().map(|(pair, elements)| (pair, elements.len())).collect()
}

fn here(part: Part) -> (Part, DAffine3) {
    (part, DAffine3::IDENTITY)
}

#[test]
fn what_touches_is_not_inside() {
    let slab = block("floor", dvec3(-2.0, -0.5, -2.0), dvec3(2.0, 0.0, 2.0));
    let wall = block("wall", dvec3(-2.0, 0.0, -2.0), dvec3(2.0, 2.0, -1.0));
    // In a corner of hall, floor and wall, and so far into the floor as f32 rounds there.
    let stands = block("crate", dvec3(1.0, -1e-7, -1.0), dvec3(2.0, 1.0, 0.0));
    assert_eq!(found(vec![here(hall()), here(slab), here(wall), here(stands)]), BTreeMap::new());
}

#[test]
fn rooms_inside_a_buildings_shell_are_not_lost_in_it() {
    let shell = || block("shell", DVec3::splat(-5.0), DVec3::splat(5.0));
    let crate_ = || block("crate", DVec3::splat(-0.5), DVec3::splat(0.5));
    assert_eq!(
        found(vec![here(shell()), here(hall()), here(crate_())]),
        BTreeMap::new(),
        "parts of their own"
    );
    assert_eq!(found(vec![here(joined([shell(), hall(), crate_()]))]), BTreeMap::new(), "one part");
    // Without the hall the crate is lost, in the same part as in another.
    assert_eq!(found(vec![here(shell()), here(crate_())]), BTreeMap::from([([1, 0], 24)]));
    assert_eq!(found(vec![here(joined([shell(), crate_()]))]), BTreeMap::from([([0, 0], 24)]));
}

#[test]
fn open_and_two_sided_boxes_hold_nothing() {
    let crate_ = || block("crate", DVec3::splat(-0.5), DVec3::splat(0.5));
    let mut open = block("open", DVec3::splat(-1.0), DVec3::splat(1.0));
    open.surfaces.pop();
    assert_eq!(found(vec![here(hall()), here(open), here(crate_())]), BTreeMap::new());
    let mut tent = block("tent", DVec3::splat(-1.0), DVec3::splat(1.0));
    tent.materials[0].double_sided = true;
    assert_eq!(found(vec![here(hall()), here(tent), here(crate_())]), BTreeMap::new());
}

#[test]
fn the_note_names_who_is_in_whom_and_the_first_elements() {
    let wall = block("wall", DVec3::ZERO, dvec3(2.0, 2.0, 1.0));
    let crate_ = block("crate", dvec3(0.5, 0.5, 0.25), dvec3(1.5, 1.5, 2.0));
    let placed = Placed::new(vec![here(hall()), here(wall), here(crate_)], 0.5);
    let inside = placed.inside();
    let said = sentences(&inside, &placed.instances);
    assert_eq!(said.len(), 2, "the crate is in the wall and the wall in the crate: {said:?}");
    let (note, lost) = (&said[1], &inside[&[2, 1]]);
    let whose = format!("{} elements of `crate` lie inside a solid of `wall`: {}, ", lost.len(), lost[0]);
    assert!(note.contains(&whose) && note.contains(", …; "), "{note}");
}
