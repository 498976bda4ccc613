//! Writes `scenes/house`: part files and the scene that places them. Run it by hand when the house is to change:
//! `cargo run -p equilux-tests --example make_house`. All sizes are multiples of 2⁻⁷ m wherever parts meet, so that
//! they meet exactly in f32 however they are turned.

mod furniture;
mod glb;
mod rooms;

use equilux_formats::Part;
use serde_json::{Value, json};
use std::io::Result;
use std::path::Path;

fn main() -> Result<()> {
    let house = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/house");
    let parts = house.join("parts");
    std::fs::create_dir_all(&parts)?;
    let write = |part: Part| glb::write(&parts.join(&part.name).with_extension("glb"), &part);
    [rooms::room(), rooms::hall(), rooms::window()].into_iter().try_for_each(write)?;
    [furniture::lamp(), furniture::table(), furniture::shelf(), furniture::crate_box()]
        .into_iter()
        .try_for_each(write)?;
    let text = serde_json::to_string_pretty(&scene()).expect("JSON values are always writable");
    std::fs::write(house.join("house.gltf"), text + "\n")
}

/// Two halves of a hall, two rooms on each side of it, and a camera that looks in from above.
fn scene() -> Value {
    let mut nodes = Nodes::default();
    for (name, scale) in [("hall east", [1, 1, 1]), ("hall west", [-1, 1, 1])] {
        let content = vec![part("hall", json!({})), lamp([2.0, 2.75, 0.0], 0.5)];
        nodes.group(json!({ "name": name, "scale": scale }), content);
    }
    let turned = [0, 1, 0, 0];
    let straight = [0, 0, 0, 1];
    nodes.group(
        json!({ "name": "dining room", "translation": [-2.125, 0, -1.25], "rotation": straight }),
        vec![
            room(),
            lamp([0.0, 2.75, -2.25], 1.0),
            window(1.0),
            at("table", [0.0, 0.0, -2.25], 90.0),
            shelf(),
        ],
    );
    nodes.group(
        json!({ "name": "store", "translation": [2.125, 0, -1.25], "rotation": straight, "scale": [-1, 1, 1] }),
        vec![
            room(),
            lamp([0.0, 2.75, -2.0], 0.0),
            window(1.0),
            at("crate", [-0.75, 0.0, -2.5], 20.0),
            at("crate", [0.5, 0.0, -3.0], -35.0),
            at("crate", [-0.75, 0.75, -2.5], 50.0),
            shelf(),
        ],
    );
    nodes.group(
        json!({ "name": "study", "translation": [-2.125, 0, 1.25], "rotation": turned, "scale": [-1, 1, 1] }),
        vec![
            room(),
            lamp([0.0, 2.75, -2.0], 0.25),
            window(0.5),
            at("table", [-0.25, 0.0, -3.25], 0.0),
            shelf(),
        ],
    );
    nodes.group(
        json!({ "name": "workshop", "translation": [2.125, 0, 1.25], "rotation": turned }),
        vec![
            room(),
            lamp([0.0, 2.75, -2.0], 0.75),
            window(0.5),
            at("table", [0.0, 0.0, -2.5], 15.0),
            at("crate", [1.2, 0.0, -3.2], 10.0),
        ],
    );
    nodes.root(camera());
    nodes.document()
}

fn room() -> Value {
    part("room", json!({}))
}

/// A pendant below a point of the ceiling, dimmed.
fn lamp(point: [f64; 3], scale: f64) -> Value {
    part("lamp", json!({ "translation": point, "extras": { "emission_scale": scale } }))
}

/// The window of a room, with more or less light behind it.
fn window(scale: f64) -> Value {
    let translation = [0.0, rooms::SILL, -rooms::DEPTH - rooms::WALL];
    part("window", json!({ "translation": translation, "extras": { "emission_scale": scale } }))
}

/// A shelf along the painted wall of a room, a hand's breadth off it.
fn shelf() -> Value {
    at("shelf", [-1.6875, 0.0, -2.0], 90.0)
}

/// Furniture on the floor or on other furniture, turned by so many degrees.
fn at(name: &str, translation: [f64; 3], degrees: f64) -> Value {
    let half = degrees.to_radians() / 2.0;
    part(name, json!({ "translation": translation, "rotation": [0.0, half.sin(), 0.0, half.cos()] }))
}

/// A node in whose place a part file stands.
fn part(name: &str, mut node: Value) -> Value {
    node["name"] = json!(name);
    node["extras"]["part"] = json!(format!("parts/{name}.glb"));
    node
}

fn camera() -> Value {
    let (across, down) = (glam::DQuat::from_rotation_y(0.45), glam::DQuat::from_rotation_x(-0.95));
    let turn = across * down;
    let target = glam::dvec3(0.0, 0.0, 0.5);
    let eye = target + turn * glam::dvec3(0.0, 0.0, 20.0);
    json!({ "name": "camera", "camera": 0, "translation": eye.to_array(), "rotation": turn.to_array() })
}

/// The nodes of a document, and which of them are roots.
#[derive(Default)]
struct Nodes {
    nodes: Vec<Value>,
    roots: Vec<usize>,
}

impl Nodes {
    fn root(&mut self, node: Value) {
        self.roots.push(self.nodes.len());
        self.nodes.push(node);
    }

    fn group(&mut self, mut node: Value, children: Vec<Value>) {
        let first = self.nodes.len() + 1;
        node["children"] = json!((first..first + children.len()).collect::<Vec<_>>());
        self.root(node);
        self.nodes.extend(children);
    }

    fn document(self) -> Value {
        json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "name": "house", "nodes": self.roots }],
            "nodes": self.nodes,
            "cameras": [{ "type": "perspective", "perspective": { "yfov": 0.65, "aspectRatio": 1.2, "znear": 0.1 } }],
        })
    }
}
