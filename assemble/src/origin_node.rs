//! The glTF node that moves a scene from local coordinates back to those of its file.

use glam::DVec3;
use serde_json::{Value, json};

/// Put all `nodes` under a common parent at `origin`, unless that is zero, and return the root nodes of the scene.
pub fn under_origin(nodes: &mut Vec<Value>, origin: DVec3) -> Vec<usize> {
    let all: Vec<usize> = (0..nodes.len()).collect();
    if origin == DVec3::ZERO {
        return all;
    }
    nodes.push(json!({ "name": "origin", "translation": origin.to_array(), "children": all }));
    vec![nodes.len() - 1]
}
