//! Parts made of quads and boxes.

use equilux_bake::elements::{ElementSize, subdivide};
use equilux_bake::monitor::Monitor;
use equilux_bake::treecode::{Audience, EXACT, Request, Resolution, block};
use equilux_bake::world::World;
use equilux_formats::texture::Textures;
use equilux_formats::{
    Corners, Geometry, Instance, Material, MaterialId, Part, PartId, Rgb, Rows, Scene, Surface, TexelChoice,
};
use glam::{DAffine3, DVec3, dvec3};

/// A grey material: reflectance and emission the same in all channels.
pub fn grey(reflectance: f64, emission: f64) -> Material {
    Material {
        name: String::new(),
        reflectance: Rgb([reflectance; 3]),
        emission: Rgb([emission; 3]),
        double_sided: false,
        textures: Textures::default(),
    }
}

/// A part without surfaces, of one material.
pub fn part(material: Material) -> Part {
    Part {
        name: "part".into(),
        surfaces: vec![],
        materials: vec![material],
        textured: vec![],
        element_size: None,
        local_solver: None,
    }
}

/// Merges parts into one.
pub fn joined(parts: impl IntoIterator<Item = Part>) -> Part {
    let mut all = Part { materials: vec![], ..part(grey(0.0, 0.0)) };
    for part in parts {
        let first = all.materials.len() as u32;
        all.materials.extend(part.materials);
        all.surfaces.extend(
            part.surfaces.iter().map(|s| Surface { material: MaterialId(s.material.0 + first), ..*s }),
        );
    }
    all
}

/// Adds a quad to the part's first material, counter-clockwise from the front.
pub fn quad(mut part: Part, corners: [DVec3; 4]) -> Part {
    part.surfaces.push(Surface::new(Corners::quad(corners), MaterialId(0)));
    part
}

/// Adds a triangle to the part's first material, counter-clockwise from the front.
pub fn triangle(mut part: Part, corners: [DVec3; 3]) -> Part {
    part.surfaces.push(Surface::new(Corners::triangle(corners), MaterialId(0)));
    part
}

/// The rectangle spanned by `u` and `v` from `origin`; its front faces along u × v.
pub fn rectangle(part: Part, origin: DVec3, u: DVec3, v: DVec3) -> Part {
    quad(part, [origin, origin + u, origin + u + v, origin + v])
}

/// A box seen from outside.
pub fn solid(material: Material, low: DVec3, high: DVec3) -> Part {
    box_part(material, low, high, false)
}

/// A box seen from inside.
pub fn room(material: Material, low: DVec3, high: DVec3) -> Part {
    box_part(material, low, high, true)
}

fn box_part(material: Material, low: DVec3, high: DVec3, inwards: bool) -> Part {
    let corner = |x: usize, y: usize, z: usize| dvec3([low, high][x].x, [low, high][y].y, [low, high][z].z);
    let sides = [
        [corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0)],
        [corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)],
        [corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)],
        [corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1), corner(1, 1, 0)],
        [corner(0, 0, 0), corner(0, 1, 0), corner(1, 1, 0), corner(1, 0, 0)],
        [corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)],
    ];
    sides.into_iter().fold(part(material), |part, mut side| {
        if inwards {
            side.reverse();
        }
        quad(part, side)
    })
}

/// The part moved by `placement`; mirrored surfaces keep their front.
pub fn moved(mut part: Part, placement: DAffine3) -> Part {
    for surface in &mut part.surfaces {
        surface.corners = surface.corners.map(|p| placement.transform_point3(p));
        if placement.matrix3.determinant() < 0.0 {
            surface.corners = surface.corners.flipped();
        }
    }
    part
}

/// The part's geometry with the elements of its own mesh.
pub fn mesh(part: &Part) -> Geometry {
    subdivide(part, ElementSize::Mesh)
}

/// The part's geometry in elements of at most `size` metres.
pub fn fine(part: &Part, size: f64) -> Geometry {
    subdivide(part, ElementSize::Metres(size))
}

/// A world of that geometry alone.
pub fn alone(geometry: &Geometry) -> World {
    World::new([(geometry, DAffine3::IDENTITY)])
}

/// The block from one instance to others of a world; with a column for each node of the world.
pub fn coupling(world: &World, receivers: usize, senders: &[usize], resolution: Resolution) -> Rows {
    let receivers = Audience::Instance(receivers);
    let request = Request::new(world, receivers, senders, resolution);
    block(&request, &Monitor::default()).expect("not stopped").block
}

/// The exact block of a geometry alone.
pub fn self_block(geometry: &Geometry) -> Rows {
    coupling(&alone(geometry), 0, &[0], EXACT)
}

/// A scene of these parts, each where it is.
pub fn scene_of(parts: Vec<Part>) -> Scene {
    let instance = |(number, part): (usize, &Part)| Instance {
        name: format!("{} {number}", part.name),
        part: PartId::from_index(number),
        placement: DAffine3::IDENTITY,
        emission_scale: 1.0,
        repainted: vec![],
        texels: TexelChoice::default(),
    };
    Scene {
        name: "level".into(),
        file: "level".into(),
        sources: vec![],
        instances: parts.iter().enumerate().map(instance).collect(),
        parts,
        cameras: vec![],
        lights: vec![],
        origin: DVec3::ZERO,
        coordinate_step: 0.0,
        hidden_shells: 0,
        notes: vec![],
    }
}
