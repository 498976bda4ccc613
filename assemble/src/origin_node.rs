//! The node of a glTF file that moves a scene back to where its own file has it.

use glam::DVec3;
use serde_json::{Value, json};

/// Puts all `nodes` under one that moves them to `origin`, where that is elsewhere, and returns the roots of the scene.
pub fn under_origin(nodes: &mut Vec<Value>, origin: DVec3) -> Vec<usize> {
    let all: Vec<usize> = (0..nodes.len()).collect();
    if origin == DVec3::ZERO {
        return all;
    }
    nodes.push(json!({ "name": "origin", "translation": origin.to_array(), "children": all }));
    vec![nodes.len() - 1]
}
