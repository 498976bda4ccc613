//! Furnished levels for measurements: a grid of rooms with doors, closed, the same every time.

use crate::shapes::{grey, joined, part, quad, rectangle, solid};
use equilux_formats::{Material, Part};
use glam::{DVec3, dvec3};

/// Inner width and depth of a room, its height, and the thickness of walls, metres.
const ROOM: (f64, f64, f64) = (4.0, 3.0, 0.2);

/// Width and height of a door, metres.
const DOOR: (f64, f64) = (0.9, 2.1);

/// Rooms in a nearly square grid, one part each, every two neighbours joined by a door.
pub fn furnished(rooms: usize) -> Vec<Part> {
    let columns = (rooms as f64).sqrt().ceil() as usize;
    grid(rooms, columns, 0.7)
}

/// Rooms in a row.
pub fn corridor(rooms: usize, reflectance: f64) -> Vec<Part> {
    grid(rooms, rooms, reflectance)
}

fn grid(rooms: usize, columns: usize, reflectance: f64) -> Vec<Part> {
    let exists = |x: i64, z: i64| {
        x >= 0 && z >= 0 && (x as usize) < columns && (z as usize) * columns + (x as usize) < rooms
    };
    (0..rooms)
        .map(|number| {
            let (x, z) = ((number % columns) as i64, (number / columns) as i64);
            let doors = [exists(x - 1, z), exists(x + 1, z), exists(x, z - 1), exists(x, z + 1)];
            let origin = dvec3(x as f64, 0.0, z as f64) * (ROOM.0 + ROOM.2);
            room(number, origin, doors, reflectance)
        })
        .collect()
}

/// Deterministic numbers in 0..1 that look random (Weyl sequence).
fn jitter(number: usize, salt: usize) -> f64 {
    ((number * 16 + salt) as f64 * 0.754_877_666_246_692_8).fract()
}

fn room(number: usize, origin: DVec3, doors: [bool; 4], reflectance: f64) -> Part {
    let (size, height, _) = ROOM;
    let (x, y, z) = (DVec3::X * size, DVec3::Y * height, DVec3::Z * size);
    let paint = grey(reflectance, 0.0);
    let mut shell = rectangle(part(paint.clone()), origin, z, x);
    shell = rectangle(shell, origin + y, x, z);
    // Each wall from its lower left corner as seen from inside, and the way to the right.
    let walls = [(origin + z, -z), (origin + x, z), (origin, x), (origin + x + z, -x)];
    for ((corner, along), door) in walls.into_iter().zip(doors) {
        shell = wall(shell, corner, along, y, door);
    }
    let mut pieces = vec![shell, lamp(origin + y + (x + z) * 0.5)];
    pieces.extend(furniture(number, origin, &paint));
    Part { name: format!("room {number}"), ..joined(pieces) }
}

/// A wall from its lower left corner as seen from inside; with half the way through a door if there is one.
fn wall(shell: Part, corner: DVec3, along: DVec3, up: DVec3, door: bool) -> Part {
    if !door {
        return rectangle(shell, corner, along, up);
    }
    let (right, top) = (along.normalize(), up.normalize());
    let left = (along.length() - DOOR.0) / 2.0;
    let (from, to, lintel) = (corner + right * left, corner + right * (left + DOOR.0), top * DOOR.1);
    let shell = rectangle(shell, corner, from - corner, up);
    let shell = rectangle(shell, to, corner + along - to, up);
    let shell = rectangle(shell, from + lintel, to - from, up - lintel);
    // Half of the wall's thickness belongs to each room.
    let out = -right.cross(top) * (ROOM.2 / 2.0);
    let shell = quad(shell, [from, to, to + out, from + out]);
    let shell = quad(shell, [from, from + out, from + out + lintel, from + lintel]);
    let shell = quad(shell, [to, to + lintel, to + out + lintel, to + out]);
    quad(shell, [from + lintel, from + out + lintel, to + out + lintel, to + lintel])
}

fn lamp(ceiling: DVec3) -> Part {
    let light: Material = grey(0.5, 20.0);
    let half = dvec3(0.4, 0.0, 0.4);
    solid(light, ceiling - half - DVec3::Y * 0.15, ceiling + half - DVec3::Y * 0.05)
}

/// A table with four legs, a cupboard, a shelf board and some crates.
fn furniture(number: usize, origin: DVec3, paint: &Material) -> Vec<Part> {
    let boxed = |low: DVec3, high: DVec3| solid(paint.clone(), origin + low, origin + high);
    let table = dvec3(1.0 + jitter(number, 0), 0.0, 1.2 + jitter(number, 1));
    let mut pieces = vec![boxed(table + DVec3::Y * 0.7, table + dvec3(1.2, 0.75, 0.8))];
    for (dx, dz) in [(0.05, 0.05), (1.05, 0.05), (0.05, 0.65), (1.05, 0.65)] {
        let leg = table + dvec3(dx, 0.005, dz);
        pieces.push(boxed(leg, leg + dvec3(0.1, 0.685, 0.1)));
    }
    pieces.push(boxed(dvec3(0.1, 0.02, 0.1), dvec3(1.0, 1.9, 0.6)));
    pieces.push(boxed(dvec3(3.0, 1.4, 0.05), dvec3(3.9, 1.45, 0.35)));
    for crate_number in 0..3 {
        let place =
            dvec3(2.7 + 0.4 * jitter(number, 2 + crate_number), 0.02 + 0.42 * crate_number as f64, 3.2);
        pieces.push(boxed(place, place + dvec3(0.45, 0.4, 0.45)));
    }
    pieces
}
