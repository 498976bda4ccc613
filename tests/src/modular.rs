//! A modular level: few part files, placed many times by a scene without other contents. Rooms in a row with
//! corridors between their doors, furnished with crates and pillars, each lit by a lamp.
//!
//! Sizes are multiples of 2⁻³ m, so that rooms and corridors meet exactly.

use crate::model::{Model, Node};
use crate::rooms::{lamp, paint};
use crate::shapes::{joined, part, rectangle, solid};
use equilux_formats::{Material, Part};
use glam::{DQuat, DVec3, dvec3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// From the middle of a room to that of the next: 4 m of room, 2 m of corridor.
const PITCH: f64 = 6.0;

/// Writes part files and a scene of this many rooms into `folder`, and returns the scene's file. Each room has three
/// crates and three pillars below a lamp; doors at the ends of the row are closed. `style` returns the furnishing of a
/// room by its number: rooms of one style are alike.
pub fn write(folder: &Path, rooms: usize, style: impl Fn(usize) -> usize) -> PathBuf {
    let parts = folder.join("parts");
    std::fs::create_dir_all(&parts).expect("a folder");
    for (name, part) in [
        ("room", room()),
        ("corridor", corridor()),
        ("door", door()),
        ("crate", solid(named("wood", [0.5, 0.375, 0.25]), dvec3(-0.5, 0.0, -0.5), dvec3(0.5, 1.0, 0.5))),
        ("pillar", solid(named("stone", [0.625; 3]), dvec3(-0.125, 0.0, -0.125), dvec3(0.125, 2.5, 0.125))),
        ("lamp", solid(lamp([24.0, 20.0, 16.0]), dvec3(-0.5, 0.0, -0.5), dvec3(0.5, 0.125, 0.5))),
    ] {
        Model::of(&[Node::new(name, part)]).write(&parts.join(name).with_extension("glb"));
    }
    let scene = json!({ "asset": { "version": "2.0" }, "scene": 0, "nodes": nodes(rooms, style),
        "scenes": [{ "nodes": (0..places(rooms)).collect::<Vec<_>>() }] });
    let file = folder.join("level.gltf");
    std::fs::write(&file, scene.to_string()).expect("a file");
    file
}

/// Number of part files.
pub const PARTS: usize = 6;

/// Number of instances of a level of so many rooms: eight a room, corridors between them, and two doors.
pub fn places(rooms: usize) -> usize {
    8 * rooms + (rooms - 1) + 2
}

fn nodes(rooms: usize, style: impl Fn(usize) -> usize) -> Vec<Value> {
    let half_turn = DQuat::from_rotation_y(std::f64::consts::PI);
    let mut nodes = vec![
        node("door", dvec3(-2.0, 0.0, 0.0), DQuat::IDENTITY, DVec3::ONE),
        node("door", dvec3(PITCH * (rooms - 1) as f64 + 2.0, 0.0, 0.0), half_turn, DVec3::ONE),
    ];
    for number in 0..rooms {
        let middle = DVec3::X * PITCH * number as f64;
        // Every other style is mirrored; crates and pillars stand about as they like.
        let style = style(number);
        let mirror = if style.is_multiple_of(2) { DVec3::ONE } else { dvec3(1.0, 1.0, -1.0) };
        nodes.push(node("room", middle, DQuat::IDENTITY, mirror));
        if number + 1 < rooms {
            nodes.push(node("corridor", middle + 3.0 * DVec3::X, DQuat::IDENTITY, DVec3::ONE));
        }
        let mut light = node("lamp", middle + 2.75 * DVec3::Y, DQuat::IDENTITY, DVec3::ONE);
        light["extras"]["emission_scale"] = json!([1.0, 0.25, 0.5][style % 3]);
        nodes.push(light);
        for k in 0..3 {
            let turn = DQuat::from_rotation_y(0.4 * (style + 2 * k) as f64);
            let at = middle + dvec3([-1.25, 1.0, 0.25][k], 0.0, [1.125, -1.25, 1.25][k]);
            let mut wooden = node("crate", at, turn, DVec3::splat([0.75, 1.0, 0.5][(style + k) % 3]));
            if k == 1 {
                wooden["extras"]["materials"] =
                    json!({ "wood": { "baseColorFactor": [0.125, 0.25, 0.5, 1] } });
            }
            nodes.push(wooden);
            let at = middle + dvec3([-1.5, 0.0, 1.5][k], 0.0, [-1.5, -1.0, 1.5][k]);
            nodes.push(node("pillar", at, turn.inverse(), DVec3::ONE));
        }
    }
    nodes
}

/// A node with a part file.
fn node(part: &str, at: DVec3, turn: DQuat, scale: DVec3) -> Value {
    json!({ "name": part, "translation": at.to_array(), "rotation": turn.to_array(), "scale": scale.to_array(),
        "extras": { "part": format!("parts/{part}.glb") } })
}

fn named(name: &str, reflectance: [f64; 3]) -> Material {
    Material { name: name.into(), ..paint(reflectance) }
}

/// 4 × 3 × 4 m with doorways of 1 × 2 m to both sides.
fn room() -> Part {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut room = part(named("plaster", [0.75, 0.75, 0.625]));
    let low = dvec3(-2.0, 0.0, -2.0);
    for (corner, u, v) in [
        (low, 4.0 * z, 4.0 * x),
        (low + 3.0 * y, 4.0 * x, 4.0 * z),
        (low, 4.0 * x, 3.0 * y),
        (low + 4.0 * z, 3.0 * y, 4.0 * x),
    ] {
        room = rectangle(room, corner, u, v);
    }
    for (from, high, low_edge, width) in [(-2.0, 3.0, 0.0, 1.5), (0.5, 3.0, 0.0, 1.5), (-0.5, 3.0, 2.0, 1.0)]
    {
        let (up, along) = ((high - low_edge) * y, width * z);
        room = rectangle(room, dvec3(-2.0, low_edge, from), up, along);
        room = rectangle(room, dvec3(2.0, low_edge, from), along, up);
    }
    room
}

/// 2 m long, 1 m wide, 2 m high, open at both ends.
fn corridor() -> Part {
    let (x, y, z) = (2.0 * DVec3::X, 2.0 * DVec3::Y, DVec3::Z);
    let low = dvec3(-1.0, 0.0, -0.5);
    let sides = [(low, z, x), (low + y, x, z), (low, x, y), (low + z, y, x)];
    sides
        .into_iter()
        .fold(part(named("brick", [0.5, 0.25, 0.25])), |part, (corner, u, v)| rectangle(part, corner, u, v))
}

/// What closes a doorway; it looks along x.
fn door() -> Part {
    let leaf = part(named("leaf", [0.25, 0.5, 0.25]));
    joined([rectangle(leaf, dvec3(0.0, 0.0, -0.5), 2.0 * DVec3::Y, DVec3::Z)])
}
