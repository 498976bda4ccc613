//! Irradiance averaged over given elements, as in texels of that size.

use crate::lit::{Lit, lit};
use crate::table::Table;
use crate::truth::{Errors, gathered};
use equilux_assemble::gather::Gather;
use equilux_assemble::gather::faces::{CoplanarFaces, Faces};
use equilux_assemble::gather::lights::Lights;
use equilux_assemble::gather::surface_piece::{SurfacePiece, centre};
use equilux_bake::elements::ElementSize;
use equilux_bake::gltf_import::import_scene;
use equilux_bake::oven::prepare::{Division, Preparation, RowMethod, prepare};
use equilux_bake::treecode::Resolution;
use equilux_bake::world::World;
use equilux_formats::{Element, Instance, Rgb};
use glam::DVec3;
use std::path::Path;

/// Texels as large as the truth's elements against the truth.
#[derive(Debug)]
pub struct Compared {
    /// One a channel.
    pub errors: [Errors; 3],
    /// Number of elements of the solution, and of texels.
    pub counts: [usize; 2],
    /// CPU seconds for the solution from nothing, and for the texels.
    pub seconds: [f64; 2],
}

/// The texels of one of our scenes, its level modelled coarsely and with elements of `size` metres, against the truth, which
/// is cut finely.
pub fn compared(name: &str, size: f64, tolerance: f64) -> Compared {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (folder, coarse) = (here.join("../scenes").join(name), here.join(format!("truth/{name}.coarse.glb")));
    let resolution = Resolution::for_tolerance(tolerance);
    let wanted = |element_size| Preparation {
        element_size: Some(element_size),
        division: Division::Authored,
        resolution,
        rows: RowMethod::Exact,
        rays: 256,
        local_solver: None,
    };
    let fine = import_scene(&folder.join(name).with_extension("glb")).expect("a scene");
    let fine = prepare(&fine, &wanted(ElementSize::Mesh)).expect("elements");
    let geometry = |i: &Instance| (&fine.parts[i.part.index()].geometry, i.placement);
    let elements = World::new(fine.instances.iter().map(geometry)).elements;
    let start = cpu_seconds();
    let lit = lit(&coarse, &wanted(ElementSize::Metres(size)));
    let solved = cpu_seconds();
    let light = averages(&lit, &elements, resolution);
    let seconds = [solved - start, cpu_seconds() - solved];

    let truth = Table::read(&folder.join("truth.csv"));
    let places = elements.iter().map(|e| (e.centroid, e.normal)).collect();
    let found = gathered(&truth, places, |row| (elements[row].area, light[row].0));
    let errors = [0, 1, 2].map(|channel: usize| {
        let colour = ["r", "g", "b"][channel];
        Errors::of(&truth, &found, ["Ha", "Ha_se"].map(|k| format!("{k}_{colour}")), channel)
    });
    Compared { errors, counts: [lit.placed.world.elements.len(), elements.len()], seconds }
}

/// CPU time of this process so far, if the system provides it; in hundredths of seconds.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or("").split_whitespace().collect();
    let ticks = |field: usize| fields.get(field).and_then(|t| t.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) / 100.0
}

/// The average irradiance of each element, W/m²: direct light exact over the element, reflected light at its centroid.
/// The elements lie in the faces of the scene that is lit, or, where they come from a finer mesh of it, near them: then
/// they count as if they lay there.
pub fn averages(lit: &Lit, elements: &[Element], resolution: Resolution) -> Vec<Rgb> {
    let (emission, radiosity) = (&lit.optics.emission, &lit.outcome.radiosity);
    let gather = Gather::new(&lit.placed, emission, radiosity, &Lights::default(), resolution);
    let mean = mean(&lit.outcome.irradiance);
    let projected: Vec<Projected> = elements.iter().map(|e| Projected::new(e, gather.faces(), lit)).collect();
    let pieces: Vec<SurfacePiece> = projected
        .iter()
        .map(|p| SurfacePiece { corners: &p.corners, normal: p.normal, plane: &p.plane })
        .collect();
    let direct = gather.direct(&pieces, mean);
    let reflected = gather.reflected_over(&pieces, mean);
    direct.iter().zip(reflected).map(|(&d, r)| d + r).collect()
}

/// An element in the plane of a face of the scene.
struct Projected<'a> {
    corners: Vec<DVec3>,
    normal: DVec3,
    plane: CoplanarFaces<'a>,
}

impl<'a> Projected<'a> {
    fn new(element: &Element, faces: &'a Faces, lit: &Lit) -> Self {
        let alike = lit.placed.world.elements.iter().filter(|e| e.normal.dot(element.normal) > 0.99);
        let distance = |e: &&Element| outside(e, element.centroid);
        let near =
            alike.min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a face that looks that way");
        let onto = |p: &DVec3| *p - near.normal * near.normal.dot(*p - near.centroid);
        let corners: Vec<DVec3> = element.corners.as_slice().iter().map(onto).collect();
        let (middle, _) = centre(&corners, near.normal);
        Self { corners, normal: near.normal, plane: faces.in_plane(middle, near.normal) }
    }
}

/// How far a point is from an element, at most.
fn outside(element: &Element, point: DVec3) -> f64 {
    let corners = element.corners.as_slice();
    let beyond = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % corners.len()]);
        (b - a).cross(element.normal).normalize_or_zero().dot(point - a)
    };
    let aside = (0..corners.len()).map(beyond).fold(0.0, f64::max);
    aside + element.normal.dot(point - element.centroid).abs()
}

/// The mean of values.
pub fn mean(values: &[Rgb]) -> Rgb {
    values.iter().copied().sum::<Rgb>() / values.len() as f64
}
