//! Scenes that light crosses slowly: rooms in a row behind openings, and furnished rooms cut by planes.

use crate::assembled::Assembled;
use crate::levels::furnished;
use crate::shapes::{grey, joined, part, rectangle, solid};
use equilux_bake::elements::bisect::bisect;
use equilux_bake::elements::{ElementSize, optics, subdivide};
use equilux_bake::treecode::Resolution;
use equilux_formats::{Geometry, Optics, Part, Tints};
use glam::{DVec3, dvec3};

/// Width along the row, height and depth of a room, metres.
const ROOM: DVec3 = dvec3(4.0, 3.0, 4.0);

/// Rooms in a row, one part each, with a lamp in the first. Between two of them, `open` of the wall's width is open from
/// floor to ceiling; 1 for a plane through open space.
pub fn corridor(rooms: usize, open: f64, size: f64, resolution: Resolution) -> Assembled {
    let parts: Vec<Part> = (0..rooms).map(|k| room(k, rooms, open)).collect();
    let geometry = |part: &Part| subdivide(part, ElementSize::Metres(size));
    let geometries: Vec<Geometry> = parts.iter().map(geometry).collect();
    let optics = parts.iter().zip(&geometries).map(|(part, geometry)| plain(geometry, part));
    let optics = optics.collect();
    Assembled::new(geometries, optics, resolution, None)
}

/// Furnished rooms with lamps and doors, one part each.
pub fn level(rooms: usize, size: f64, resolution: Resolution) -> Assembled {
    let parts = furnished(rooms);
    let geometries: Vec<Geometry> =
        parts.iter().map(|part| subdivide(part, ElementSize::Metres(size))).collect();
    let optics = parts.iter().zip(&geometries).map(|(part, geometry)| plain(geometry, part));
    let optics = optics.collect();
    Assembled::new(geometries, optics, resolution, None)
}

/// Furnished rooms with lamps, cut by planes into cells.
pub fn cells(rooms: usize, count: usize, size: f64, resolution: Resolution) -> Assembled {
    let whole = joined(furnished(rooms));
    let cells = bisect(subdivide(&whole, ElementSize::Metres(size)), count);
    let optics = cells.iter().map(|cell| plain(cell, &whole)).collect();
    Assembled::new(cells, optics, resolution, None)
}

/// Reflectance and emission of a part without textures.
fn plain(geometry: &Geometry, part: &Part) -> Optics {
    optics(geometry, &part.materials, &Tints::plain(geometry.elements.len()))
}

fn room(number: usize, rooms: usize, open: f64) -> Part {
    let (origin, paint) = (DVec3::X * ROOM.x * number as f64, grey(0.5, 0.0));
    let (x, y, z) = (DVec3::X * ROOM.x, DVec3::Y * ROOM.y, DVec3::Z * ROOM.z);
    let sides = [(origin, z, x), (origin + y, x, z), (origin, x, y), (origin + z, y, x)];
    let mut room = part(paint);
    for (corner, u, v) in sides {
        room = rectangle(room, corner, u, v);
    }
    let pillar = ROOM.z * (1.0 - open) / 2.0;
    let to = |room: Part, closed: bool, at: DVec3, looks_back: bool| {
        let strip = |room: Part, from: f64, width: f64| {
            let (corner, along) = (at + DVec3::Z * from, DVec3::Z * width);
            if looks_back { rectangle(room, corner, along, y) } else { rectangle(room, corner, y, along) }
        };
        match (closed, open < 1.0) {
            (true, _) => strip(room, 0.0, ROOM.z),
            (false, true) => strip(strip(room, 0.0, pillar), ROOM.z - pillar, pillar),
            (false, false) => room,
        }
    };
    room = to(room, number == 0, origin, false);
    room = to(room, number + 1 == rooms, origin + x, true);
    if number > 0 {
        return room;
    }
    let lamp = solid(grey(0.5, 20.0), dvec3(1.5, 2.6, 1.5), dvec3(2.5, 2.8, 2.5));
    joined([room, lamp])
}
