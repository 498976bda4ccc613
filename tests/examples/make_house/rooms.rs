//! The parts that enclose: a room with a door and a window, half a hall with two doors, and what fills a window.

use crate::furniture::block;
use equilux_formats::texture::Textures;
use equilux_formats::{Material, Part, Rgb};
use equilux_tests::shapes::{joined, part, rectangle};
use glam::{DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::PI;

/// Walls from side to side, metres.
pub const WALL: f64 = 0.25;
/// A room from its door to its window.
pub const DEPTH: f64 = 4.0;
/// Lower edge of the windows.
pub const SILL: f64 = 0.875;
const HEIGHT: f64 = 2.75;
/// Half a room from side to side.
const HALF: f64 = 2.0;
/// Half the hall from one row of rooms to the other.
const HALF_HALL: f64 = 1.0;
const DOOR: Opening = Opening { low: DVec2::new(0.5, 0.0), high: DVec2::new(1.5, 2.125) };
const WINDOW: Opening = Opening { low: DVec2::new(-0.75, SILL), high: DVec2::new(0.75, 2.0) };

/// A rectangle left out of a wall: metres along the wall and up.
#[derive(Clone, Copy)]
struct Opening {
    low: DVec2,
    high: DVec2,
}

/// The room: its door is at z = 0 and leads through a wall to +z, its window at z = −4 to −z.
pub fn room() -> Part {
    let x_to = |x: f64| dvec3(x, 0.0, 0.0);
    let plaster = [
        wall(
            part(paint(0.8, 0.77, 0.71)),
            x_to(HALF),
            -DVec3::X,
            2.0 * HALF,
            Some(DOOR.seen_from_the_other_end(HALF)),
        ),
        wall(
            part(paint(0.8, 0.77, 0.71)),
            dvec3(-HALF, 0.0, -DEPTH),
            DVec3::X,
            2.0 * HALF,
            Some(WINDOW.moved(HALF)),
        ),
        wall(part(paint(0.8, 0.77, 0.71)), dvec3(HALF, 0.0, -DEPTH), DVec3::Z, DEPTH, None),
    ];
    let accent = wall(part(paint(0.32, 0.5, 0.5)), x_to(-HALF), -DVec3::Z, DEPTH, None);
    let slabs = slabs(paint(0.58, 0.4, 0.25), dvec3(-HALF, 0.0, -DEPTH), dvec3(HALF, HEIGHT, 0.0));
    let frames = [
        reveal(part(paint(0.7, 0.66, 0.6)), DOOR, 0.0),
        reveal(part(paint(0.7, 0.66, 0.6)), WINDOW, -DEPTH - WALL),
    ];
    named("room", joined(plaster.into_iter().chain([accent, slabs]).chain(frames)), None)
}

/// Half of the hall, from its middle at x = 0 to its end, with a door on either side.
pub fn hall() -> Part {
    let length = 2.0 * HALF + WALL / 2.0;
    // Where the doors of rooms are whose middle is half a wall and half a room from the hall's.
    let door = Opening { low: dvec2(0.625, 0.0), high: dvec2(1.625, DOOR.high.y) };
    let plaster = || part(paint(0.8, 0.77, 0.71));
    let north = wall(plaster(), dvec3(0.0, 0.0, -HALF_HALL), DVec3::X, length, Some(door));
    let south_door = door.seen_from_the_other_end(length);
    let south = wall(plaster(), dvec3(length, 0.0, HALF_HALL), -DVec3::X, length, Some(south_door));
    let end =
        wall(part(paint(0.7, 0.42, 0.3)), dvec3(length, 0.0, -HALF_HALL), DVec3::Z, 2.0 * HALF_HALL, None);
    let low = dvec3(0.0, 0.0, -HALF_HALL);
    let slabs = slabs(paint(0.45, 0.43, 0.42), low, dvec3(length, HEIGHT, HALF_HALL));
    named("hall", joined([north, south, end, slabs]), None)
}

/// A pane as bright as an overcast sky, and the cross of bars before it. Stands at the middle of the pane's lower edge.
pub fn window() -> Part {
    let size = WINDOW.high - WINDOW.low;
    let sky = Material { emission: Rgb([0.6, 0.8, 1.0].map(|l| PI * 2.5 * l)), ..paint(0.1, 0.1, 0.1) };
    let pane = rectangle(part(sky), dvec3(-size.x / 2.0, 0.0, 0.0), DVec3::X * size.x, DVec3::Y * size.y);
    let wood = paint(0.6, 0.55, 0.5);
    let (thin, near) = (0.03, 0.06);
    let upright = block(&wood, dvec3(-thin, 0.0, near - thin), dvec3(thin, size.y, near));
    let middle = size.y / 2.0;
    let level = |low: f64, high: f64| {
        block(&wood, dvec3(low, middle - thin, near - thin), dvec3(high, middle + thin, near))
    };
    let half = size.x / 2.0;
    named("window", joined([pane, upright, level(-half, -thin), level(thin, half)]), Some(0.25))
}

impl Opening {
    fn moved(self, along: f64) -> Self {
        let by = dvec2(along, 0.0);
        Self { low: self.low + by, high: self.high + by }
    }

    /// The same opening in a wall measured from its other end, at `along`.
    fn seen_from_the_other_end(self, along: f64) -> Self {
        Self { low: dvec2(along - self.high.x, self.low.y), high: dvec2(along - self.low.x, self.high.y) }
    }
}

/// A wall from `start` along the unit vector `along`, which one sees going to the right, with at most one opening.
fn wall(wall: Part, start: DVec3, along: DVec3, length: f64, opening: Option<Opening>) -> Part {
    let piece = |wall: Part, low: DVec2, high: DVec2| match (high - low).min_element() > 0.0 {
        true => rectangle(
            wall,
            start + along * low.x + DVec3::Y * low.y,
            along * (high.x - low.x),
            DVec3::Y * (high.y - low.y),
        ),
        false => wall,
    };
    let whole = dvec2(length, HEIGHT);
    let Some(Opening { low, high }) = opening else { return piece(wall, DVec2::ZERO, whole) };
    let wall = piece(wall, DVec2::ZERO, dvec2(low.x, HEIGHT));
    let wall = piece(wall, dvec2(high.x, 0.0), whole);
    let wall = piece(wall, dvec2(low.x, 0.0), dvec2(high.x, low.y));
    piece(wall, dvec2(low.x, high.y), dvec2(high.x, HEIGHT))
}

/// The four sides of an opening through a wall that reaches from `z` to `z` + [`WALL`].
fn reveal(reveal: Part, Opening { low, high }: Opening, z: f64) -> Part {
    let (through, size) = (DVec3::Z * WALL, high - low);
    let reveal = rectangle(reveal, low.extend(z), through, DVec3::X * size.x);
    let reveal = rectangle(reveal, high.extend(z), through, -DVec3::X * size.x);
    let reveal = rectangle(reveal, low.extend(z), DVec3::Y * size.y, through);
    rectangle(reveal, high.extend(z), -DVec3::Y * size.y, through)
}

/// A floor at `low` and a white ceiling at `high`.
fn slabs(floor: Material, low: DVec3, high: DVec3) -> Part {
    let (x, z) = (DVec3::X * (high.x - low.x), DVec3::Z * (high.z - low.z));
    joined([rectangle(part(floor), low, z, x), rectangle(part(paint(0.85, 0.85, 0.85)), high, -x, -z)])
}

/// A material of that reflectance.
pub fn paint(red: f64, green: f64, blue: f64) -> Material {
    Material {
        name: String::new(),
        reflectance: Rgb([red, green, blue]),
        emission: Rgb::BLACK,
        double_sided: false,
        textures: Textures::default(),
    }
}

/// The part under its name, with elements of its own size or of the scene's.
pub fn named(name: &str, part: Part, element_size: Option<f64>) -> Part {
    Part { name: name.into(), element_size, ..part }
}
