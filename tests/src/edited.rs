//! A room that is edited at random: things are moved, turned, replaced, painted, added, removed, and put in another order.

use crate::model::{Model, Node};
use crate::rooms::{half, paint};
use crate::shapes::{joined, moved, solid};
use equilux_formats::Rgb;
use glam::{DAffine3, DQuat, DVec3, dvec3};

/// Places for things to stand, a metre wide each.
const PLACES: usize = 8;

/// A crate, or two on each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Thing {
    name: usize,
    size: DVec3,
    angle: f64,
    twofold: bool,
    jitter: DVec3,
    place: usize,
    colour: f64,
    light: f64,
}

impl Thing {
    fn node(&self) -> Node {
        let mut material = paint([self.colour; 3]);
        material.emission = Rgb([self.light; 3]);
        let half = self.size / 2.0;
        let mut boxes = vec![solid(material.clone(), -half, half)];
        if self.twofold {
            let top = DVec3::Y * (self.size.y + 0.125);
            boxes.push(solid(material, top - half * 0.5, top + half * 0.5));
        }
        let turned = moved(joined(boxes), DAffine3::from_quat(DQuat::from_rotation_y(self.angle)));
        let at = dvec3(0.5 + (self.place % 4) as f64, 0.6, 0.5 + (self.place / 4) as f64) + self.jitter;
        Node { at, ..Node::new(&format!("thing {}", self.name), turned) }
    }
}

/// Numbers that look random and are the same every time (Knuth's multiplier).
#[derive(Debug)]
pub struct Dice(pub u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % sides
    }

    fn share(&mut self) -> f64 {
        self.roll(1024) as f64 / 1024.0
    }

    /// A thing of any size, shape and colour at a place.
    pub fn thing(&mut self, name: usize, place: usize) -> Thing {
        Thing {
            name,
            size: dvec3(0.25, 0.25, 0.25) + dvec3(self.share(), self.share(), self.share()) * 0.25,
            angle: if self.roll(2) == 0 { 0.0 } else { self.share() },
            twofold: self.roll(3) == 0,
            jitter: dvec3(self.share(), self.share(), self.share()) * 0.125,
            place,
            colour: self.share(),
            light: self.share(),
        }
    }
}

/// Changes one object of the scene, and returns a description.
pub fn edit(things: &mut Vec<Thing>, dice: &mut Dice, number: usize) -> String {
    let free: Vec<usize> =
        (0..PLACES).filter(|place| things.iter().all(|thing| thing.place != *place)).collect();
    let which = dice.roll(things.len());
    let anything = dice.thing(things[which].name, things[which].place);
    let thing = &mut things[which];
    let what = match dice.roll(7) {
        0 if !free.is_empty() => {
            thing.place = free[dice.roll(free.len())];
            "moved to another place"
        }
        0 | 1 => {
            thing.jitter = anything.jitter;
            "moved a little"
        }
        2 => {
            thing.angle = dice.share();
            "turned"
        }
        // The same number of elements in another shape.
        3 => {
            thing.size = anything.size;
            "replaced"
        }
        4 => {
            (thing.colour, thing.light) = (anything.colour, anything.light);
            "repainted and relit"
        }
        5 if things.len() > 2 => {
            things.remove(which);
            "removed"
        }
        _ if !free.is_empty() => {
            let place = free[dice.roll(free.len())];
            things.insert(which, dice.thing(100 + number, place));
            "added"
        }
        _ => {
            things.swap(0, which);
            "put first"
        }
    };
    format!("edit {number}, {which} of {}: {what}", things.len())
}

/// Two halves of a room with these things in it.
pub fn scene(things: &[Thing]) -> Model {
    let rooms = [("left", 0.0), ("right", 2.0)];
    let rooms = rooms.map(|(name, from)| Node::new(name, half(paint([0.5; 3]), from)));
    let nodes: Vec<Node> = rooms.into_iter().chain(things.iter().map(Thing::node)).collect();
    Model::of(&nodes)
}
