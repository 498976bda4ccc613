//! Small closed rooms: a few hundred elements; every row of the whole matrix sums to one.

use crate::model::Node;
use crate::shapes::{joined, part, rectangle, room, solid};
use equilux_formats::texture::Textures;
use equilux_formats::{Material, Part, Rgb};
use glam::{DVec3, dvec3};

/// A material of this reflectance, channel by channel, without emission.
pub fn paint(reflectance: [f64; 3]) -> Material {
    Material {
        name: "paint".into(),
        reflectance: Rgb(reflectance),
        emission: Rgb::BLACK,
        double_sided: false,
        textures: Textures::default(),
    }
}

/// A dark lamp of this emission, W/m².
pub fn lamp(emission: [f64; 3]) -> Material {
    Material { name: "lamp".into(), emission: Rgb(emission), ..paint([0.1; 3]) }
}

/// A room of 4 × 3 × 3 m with a lamp, a table on legs and a crate, each a part of its own. The table's parts hide each
/// other, and everything in the room hides some of the room's walls from each other.
pub fn furnished() -> Vec<Node> {
    let walls = joined([
        room(paint([0.7, 0.6, 0.5]), DVec3::ZERO, dvec3(4.0, 3.0, 3.0)),
        // A picture before the wall, so that the part has a second material.
        solid(paint([0.1, 0.2, 0.8]), dvec3(1.0, 1.0, 0.25), dvec3(2.0, 2.0, 0.375)),
    ]);
    let leg = |x: f64, z: f64| solid(paint([0.4; 3]), dvec3(x, 0.125, z), dvec3(x + 0.25, 0.75, z + 0.25));
    let table = joined([
        solid(paint([0.5, 0.3, 0.2]), dvec3(1.5, 0.8125, 1.0), dvec3(3.0, 0.875, 2.0)),
        leg(1.625, 1.125),
        leg(2.625, 1.625),
    ]);
    let light = solid(lamp([20.0, 18.0, 15.0]), dvec3(1.0, 2.5, 1.0), dvec3(1.5, 2.75, 1.5));
    let crate_ = solid(paint([0.9, 0.2, 0.2]), dvec3(0.25, 0.25, 1.5), dvec3(1.0, 1.0, 2.25));
    vec![
        Node::new("walls", walls).solved_by("direct"),
        Node::new("table", table).solved_by("gauss-seidel"),
        Node::new("light", light).solved_by("progressive"),
        Node::new("crate", crate_).solved_by("iterative"),
    ]
}

/// A white room cut open at x = 2 m: two open boxes that only absorb what `absorbed` leaves.
pub fn echoing(absorbed: f64) -> Vec<Node> {
    let white = paint([1.0 - absorbed; 3]);
    let light = Material { emission: Rgb([3.0; 3]), ..white.clone() };
    let lit = joined([half(white.clone(), 0.0), solid(light, dvec3(0.5, 1.0, 0.5), dvec3(0.75, 1.25, 0.75))]);
    vec![Node::new("lit half", lit), Node::new("dark half", half(white, 2.0))]
}

/// Half of a room of 4 × 2 × 2 m, open at x = 2 m; `from` is 0 or 2.
pub fn half(material: Material, from: f64) -> Part {
    let mut half = room(material, dvec3(from, 0.0, 0.0), dvec3(from + 2.0, 2.0, 2.0));
    half.surfaces.retain(|surface| surface.corners.as_slice().iter().any(|corner| corner.x != 2.0));
    half
}

/// A lit square alone in the dark.
pub fn square() -> Vec<Node> {
    let light = rectangle(part(lamp([1.0; 3])), DVec3::ZERO, DVec3::X, DVec3::Z);
    vec![Node::new("square", light)]
}
